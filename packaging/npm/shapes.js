// ---- Things of the module that an object owns

const forgotten = typeof FinalizationRegistry === 'undefined' ? null
    : new FinalizationRegistry(({release, pointer}) => release(pointer));
const releaseShape = pointer => wasm.pdepth_shape_release(pointer);
const releasePair = pointer => wasm.pdepth_pair_destroy(pointer);

/** A pointer that the module has given. No caller can make one, so that none is read that the module did not give. */
class Handle {
  constructor(pointer) { this.pointer = pointer; }
}

class Owned {
  #pointer;
  #release;
  constructor(handle, release) {
    if (!(handle instanceof Handle)) refuse('bad_value', 'a shape is made as a Box, Sphere, Convex ...', '');
    this.#pointer = handle.pointer;
    this.#release = release;
    if (forgotten) forgotten.register(this, {release, pointer: this.#pointer}, this);
  }
  /** Gives the memory back. A second call does nothing. */
  free() {
    if (this.#pointer === 0) return;
    if (forgotten) forgotten.unregister(this);
    this.#release(this.#pointer);
    this.#pointer = 0;
  }
  get freed() { return this.#pointer === 0; }
  [kUse](place) {
    if (this.#pointer === 0) refuse('freed', 'was freed and cannot be used any more', place);
    return this.#pointer;
  }
}
const kDispose = Symbol.dispose ?? Symbol.for('Symbol.dispose');
Owned.prototype[kDispose] = Owned.prototype.free;

function shapePointer(shape, place) {
  if (!(shape instanceof Shape)) refuse('bad_value', 'must be a shape of this library', place);
  return shape[kUse](place);
}

/** Calls a function that makes a shape; `write` gives its arguments between the context and the result. */
function made(name, write) {
  return call(() => {
    const parameters = write();
    const out = room(8);
    check(wasm[name](context, ...parameters, out));
    return new Handle(words[out >> 2]);
  });
}

export class Shape extends Owned {
  constructor(handle) { super(handle, releaseShape); }
  /** The shape swept by a ball of this radius, in addition to its margin. */
  withMargin(margin) {
    return new Shape(made('pdepth_with_margin', () => [shapePointer(this, 'shape'), readNumber(margin, 'margin')]));
  }
  /** Tells what the shape is made of. */
  describe(part = 0) {
    return call(() => {
      const out = struct('shape_info');
      check(wasm.pdepth_shape_describe(context, shapePointer(this, 'shape'), partNumber(part), out));
      const word = name => words[(out + at.shape_info[name]) >> 2];
      return {isConvex: word('is_convex') === 1, parts: word('parts'), dimension: word('dimension'), vertices: word('vertices'),
              facets: word('facets'), margin: doubles[(out + at.shape_info.margin) >> 3]};
    });
  }
  /** Facets of a part's core as loops of vertices, for drawing. */
  surface(part = 0) {
    const {vertices, facets} = this.describe(part);
    return call(() => {
      const out = struct('surface');
      const corners = part === 'mesh' ? 3 * facets : facets > 0 ? 2 * (vertices + facets - 2) : 0;
      const rooms = [room(24 * vertices), room(4 * (facets + 1)), room(4 * corners)];
      see();
      ['points', 'offsets', 'corners'].forEach((name, i) => { words[(out + at.surface[name]) >> 2] = rooms[i]; });
      check(wasm.pdepth_shape_surface(context, shapePointer(this, 'shape'), partNumber(part), out));
      return {points: doubles.slice(rooms[0] >> 3, (rooms[0] >> 3) + 3 * vertices),
              offsets: words.slice(rooms[1] >> 2, (rooms[1] >> 2) + facets + 1),
              corners: words.slice(rooms[2] >> 2, (rooms[2] >> 2) + corners)};
    });
  }
  /** The points of a feature of an answer, as numbers of the rows that the shape was made from. */
  pointsOf(feature) {
    return call(() => {
      if (feature == null) refuse('bad_value', 'must be a feature of an answer', 'feature');
      const asked = room(at.feature.size), count = room(8);
      words[(asked + at.feature.kind) >> 2] = kFeatures.indexOf(feature.kind);
      words[(asked + at.feature.part) >> 2] = partNumber(feature.part);
      for (const key of ['first', 'second']) words[(asked + at.feature[key]) >> 2] = readNumber(feature[key] ?? 0, `feature.${key}`);
      check(wasm.pdepth_feature_points(context, shapePointer(this, 'shape'), asked, 0, count));
      const found = words[count >> 2], out = room(4 * found);
      check(wasm.pdepth_feature_points(context, shapePointer(this, 'shape'), asked, out, count));
      return Array.from(words.slice(out >> 2, (out >> 2) + found));
    });
  }
}

const kMesh = -1;
/** The number of a part, or pdepth.h's word for the mesh of a solid. */
function partNumber(part) {
  return part === 'mesh' ? kMesh : readWhole(part, 0, 'part');
}

const kAxes = new Map([['x', 0], ['y', 1], ['z', 2]]);
function axisNumber(axis) {
  return kAxes.get(axis) ?? refuse('bad_value', `"${String(axis)}" is none of x, y, z`, 'axis');
}
function roundShape(name, radius, halfHeight, axis) {
  return made(name, () => [readNumber(radius, 'radius'), readNumber(halfHeight, 'halfHeight'), axisNumber(axis)]);
}
function shapeOfRows(name, rows, place, length) {
  return made(name, () => {
    const [pointer, count] = writeNumbers(rows, place, length);
    return [pointer, BigInt(count / length)];
  });
}

/** Writes loops of point numbers, or triangles in a typed array, as a pdepth_faces. */
function writeFaces(points, faces) {
  const [pointer, count] = writeNumbers(points, 'points', 3);
  const triangles = ArrayBuffer.isView(faces);
  if (!triangles && !Array.isArray(faces)) refuse('bad_value', 'must be an array of loops, or a typed array of triangles', 'faces');
  if (triangles && faces.length % 3 !== 0) refuse('bad_value', `has ${faces.length} numbers, which is no multiple of 3`, 'faces');
  const number = triangles ? faces.length / 3 : faces.length;
  const loop = i => triangles ? faces.subarray(3 * i, 3 * i + 3)
      : typeof faces[i]?.length === 'number' && typeof faces[i] === 'object' ? faces[i] : refuse('bad_value', 'must be a loop of point numbers', `faces[${i}]`);
  let corners = 0;
  for (let i = 0; i < number; ++i) corners += loop(i).length;
  const offsets = room(4 * (number + 1)), vertices = room(4 * corners), out = struct('faces');
  let next = 0;
  for (let i = 0; i < number; ++i) {
    words[(offsets >> 2) + i] = next;
    for (const v of loop(i)) {
      // The module's integers would turn other values into numbers of other points.
      if (v !== (v | 0)) refuse('bad_value', `${String(v)} is no point number`, `faces[${i}]`);
      if (v < 0 || v >= count / 3) refuse('bad_faces', `point ${v} is not one of the ${count / 3}`, `faces[${i}]`);
      words[(vertices >> 2) + next++] = v;
    }
  }
  words[(offsets >> 2) + number] = next;
  words[(out + at.faces.points) >> 2] = pointer;
  longs[(out + at.faces.num_points) >> 3] = BigInt(count / 3);
  words[(out + at.faces.offsets) >> 2] = offsets;
  longs[(out + at.faces.num_faces) >> 3] = BigInt(number);
  words[(out + at.faces.vertices) >> 2] = vertices;
  return out;
}

export class Box extends Shape {
  constructor(halfExtents) { super(made('pdepth_box', () => [writeVector(halfExtents, 'halfExtents')])); }
}
export class Sphere extends Shape {
  constructor(radius) { super(made('pdepth_sphere', () => [readNumber(radius, 'radius')])); }
}
export class Ellipsoid extends Shape {
  constructor(radii) { super(made('pdepth_ellipsoid', () => [writeVector(radii, 'radii')])); }
}
export class Capsule extends Shape {
  constructor(radius, halfHeight, axis = 'y') { super(roundShape('pdepth_capsule', radius, halfHeight, axis)); }
}
export class Cylinder extends Shape {
  constructor(radius, halfHeight, axis = 'y') { super(roundShape('pdepth_cylinder', radius, halfHeight, axis)); }
}
export class Cone extends Shape {
  constructor(radius, halfHeight, axis = 'y') { super(roundShape('pdepth_cone', radius, halfHeight, axis)); }
}
export class Convex extends Shape {
  constructor(points, faces) {
    super(faces === undefined ? shapeOfRows('pdepth_convex_hull', points, 'points', 3) : made('pdepth_convex_faces', () => {
      return [writeFaces(points, faces)];
    }));
  }
}
/** The solid that a closed mesh bounds; loops of point numbers, or a typed array of triangles. */
export class Solid extends Shape {
  constructor(points, faces, options = {}) {
    super(made('pdepth_mesh_solid', () => {
      allowOnly(options, ['turnFaces'], 'options');
      return [writeFaces(points, faces), options?.turnFaces ? 1 : 0];
    }));
  }
}
export class Halfspaces extends Shape {
  constructor(planes) { super(shapeOfRows('pdepth_halfspaces', planes, 'planes', 4)); }
}
export class HullOfSpheres extends Shape {
  constructor(spheres) { super(shapeOfRows('pdepth_hull_of_spheres', spheres, 'spheres', 4)); }
}
export class Compound extends Shape {
  constructor(parts) {
    super(made('pdepth_compound', () => {
      if (!Array.isArray(parts)) refuse('bad_value', 'must be an array of {shape, pose}', 'parts');
      const rows = room(at.part.size * Math.max(parts.length, 1));
      parts.forEach((part, i) => {
        const row = rows + at.part.size * i;
        words[(row + at.part.shape) >> 2] = shapePointer(part?.shape, `parts[${i}].shape`);
        fillPose(row + at.part.pose, part.pose, `parts[${i}].pose`);
      });
      return [rows, BigInt(parts.length)];
    }));
  }
}

/** The memory of one pair of bodies from frame to frame. It makes the next answer quicker and changes none. */
export class Pair extends Owned {
  constructor() { super(made('pdepth_pair_create', () => []), releasePair); }
  /** Forgets everything. */
  clear() { call(() => check(wasm.pdepth_pair_clear(context, this[kUse]('pair')))); }
}

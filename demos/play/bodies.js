// Bodies as the protocol's JSON, and as shapes of the library.

const {PdepthError} = pdepth;
const refuse = (code, message, place) => { throw new PdepthError(code, message, place); };

/** Makes points on a sphere that are the same everywhere, of a fixed sequence of numbers. */
function gemPoints(count, seed) {
  let state = seed;
  const random = () => { state = Math.imul(state ^ state >>> 15, 0x2c1b3c6d) + 0x9e3779b9 | 0; return (state >>> 0) / 2 ** 32; };
  return Array.from({length: count}, () => {
    const z = 2 * random() - 1, turn = 2 * Math.PI * random(), r = Math.sqrt(1 - z * z);
    return [r * Math.cos(turn), r * Math.sin(turn), z].map(x => Math.round(x * 1000) / 1000);
  });
}
const rounded = x => Math.round(x * 1e6) / 1e6;
const ring = (count, radius, z, phase = 0) => Array.from({length: count}, (_, i) => {
  const turn = 2 * Math.PI * (i + phase) / count;
  return [rounded(radius * Math.cos(turn)), rounded(radius * Math.sin(turn)), z];
});
const box = (x, y, z) => ({type: 'box', half_extents: [x, y, z]});
const part = (shape, translation) => ({shape, pose: {translation}});
function gear() {
  const teeth = Array.from({length: 8}, (_, i) => {
    const turn = Math.PI * i / 4;
    return {shape: {type: 'convex', vertices: [-0.28, 0.28].flatMap(z => [[0.6, -0.24, z], [0.6, 0.24, z], [1, -0.13, z], [1, 0.13, z]])},
            pose: {quaternion_wxyz: [Math.cos(turn / 2), 0, 0, Math.sin(turn / 2)]}};
  });
  return {type: 'compound', parts: [{shape: {type: 'convex', vertices: [...ring(16, 0.72, -0.28), ...ring(16, 0.72, 0.28)]}}, ...teeth]};
}
const golden = (1 + Math.sqrt(5)) / 2, fit = 0.6;
const kShapes = {
  'Box': box(0.9, 0.7, 0.5),
  'Rounded box': {...box(0.7, 0.5, 0.35), margin: 0.2},
  'Tetrahedron': {type: 'convex', vertices: [[0.9, 0.9, 0.9], [0.9, -0.9, -0.9], [-0.9, 0.9, -0.9], [-0.9, -0.9, 0.9]]},
  'Octahedron': {type: 'convex', vertices: [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]]},
  'Icosahedron': {type: 'convex', vertices: [-1, 1].flatMap(s => [-1, 1].flatMap(t => {
    const u = rounded(fit * s), v = rounded(fit * t * golden);
    return [[0, u, v], [u, v, 0], [v, 0, u]];
  }))},
  'Prism': {type: 'convex', vertices: [...ring(6, 0.7, -0.8), ...ring(6, 0.7, 0.8)]},
  'Wedge': {type: 'convex', vertices: [[-1, -0.6, -0.5], [1, -0.6, -0.5], [-1, 0.6, -0.5], [1, 0.6, -0.5], [-1, -0.6, 0.7], [-1, 0.6, 0.7]]},
  'Gem of 40 points': {type: 'convex', vertices: gemPoints(40, 7)},
  'Sphere': {type: 'sphere', radius: 0.8},
  'Ellipsoid': {type: 'ellipsoid', radii: [1, 0.7, 0.45]},
  'Capsule': {type: 'capsule', radius: 0.4, half_height: 0.6, axis: 'z'},
  'Cylinder': {type: 'cylinder', radius: 0.7, half_height: 0.7, axis: 'z'},
  'Cone': {type: 'cone', radius: 0.8, half_height: 0.8, axis: 'z'},
  'Cross of boxes': {type: 'compound', parts: [{shape: box(1, 0.3, 0.3)}, {shape: box(0.3, 1, 0.3)}, {shape: box(0.3, 0.3, 1)}]},
  'Corner of boxes': {type: 'compound', parts: [part(box(1, 0.3, 0.4), [0, -0.5, 0]), part(box(0.3, 0.5, 0.4), [-0.7, 0.3, 0])]},
  'Gear': gear(),
};
const kStart = {a: {name: 'Prism', pose: {t: [0.35, -0.1, 1.0], q: product(aboutAxis([1, 0.3, 0], 0.5), [0, 0, 0, 1])}},
                b: {name: 'Box', pose: {t: [0, 0, 0], q: product(aboutAxis([0, 0, 1], 0.3), [0, 0, 0, 1])}}};

/** Refuses what is no object, and a key of it that is none of the names. */
function allowOnly(json, names, place) {
  if (json === null || typeof json !== 'object') refuse('bad_value', 'must be an object', place);
  for (const key of Object.keys(json)) if (!names.includes(key)) refuse('bad_value', `is none of ${names.join(', ')}`, `${place}.${key}`);
}
/** Reads a pose of the protocol as {t, q} or {t, m}. */
function readPose(json, place) {
  if (json === undefined || json === null) return {t: [0, 0, 0], q: [0, 0, 0, 1]};
  allowOnly(json, ['translation', 'quaternion_wxyz', 'rotation_row_major'], place);
  if (json.quaternion_wxyz !== undefined && json.rotation_row_major !== undefined) refuse('bad_value', 'give a quaternion or a matrix, not both', place);
  const numbers = (name, count) => {
    const found = json[name];
    if (!Array.isArray(found) || found.length !== count || !found.every(x => typeof x === 'number')) refuse('bad_value', `must be ${count} numbers`, `${place}.${name}`);
    return found;
  };
  const t = json.translation === undefined ? [0, 0, 0] : numbers('translation', 3);
  if (json.rotation_row_major !== undefined) return {t, m: numbers('rotation_row_major', 9)};
  if (json.quaternion_wxyz === undefined) return {t, q: [0, 0, 0, 1]};
  const [w, x, y, z] = numbers('quaternion_wxyz', 4);
  return {t, q: [x, y, z, w]};
}
function poseJson({t, q, m}) {
  return m ? {translation: t, rotation_row_major: m} : {translation: t, quaternion_wxyz: [q[3], q[0], q[1], q[2]]};
}
const libraryPose = ({t, q, m}) => m ? {position: t, matrix: m} : {position: t, quaternion: q};
const rotationOf = ({q, m}) => m ?? matrixOf(q);

const kFields = {box: ['half_extents'], sphere: ['radius'], ellipsoid: ['radii'], capsule: ['radius', 'half_height', 'axis'],
                 cylinder: ['radius', 'half_height', 'axis'], cone: ['radius', 'half_height', 'axis'], convex: ['vertices', 'faces'],
                 sphere_hull: ['spheres'], halfspaces: ['planes'], compound: ['parts'], mesh: ['path', 'as']};

/** Makes one convex shape of the protocol. */
function convexShape(json, place) {
  const make = {
    box: () => new pdepth.Box(json.half_extents), sphere: () => new pdepth.Sphere(json.radius), ellipsoid: () => new pdepth.Ellipsoid(json.radii),
    capsule: () => new pdepth.Capsule(json.radius, json.half_height, json.axis),
    cylinder: () => new pdepth.Cylinder(json.radius, json.half_height, json.axis),
    cone: () => new pdepth.Cone(json.radius, json.half_height, json.axis), convex: () => new pdepth.Convex(json.vertices, json.faces),
    sphere_hull: () => new pdepth.HullOfSpheres(json.spheres), halfspaces: () => new pdepth.Halfspaces(json.planes),
  };
  const core = located(place, make[json.type]);
  if (!json.margin) return core;
  const swept = located(place, () => core.withMargin(json.margin));
  core.free();
  return swept;
}
/** Runs a step, and puts the place in the line before the place that it names. */
function located(place, step) {
  try {
    return step();
  } catch (error) {
    if (!(error instanceof PdepthError)) throw error;
    const words = error.message.replace(/^\w+: /, '').replace(/ \([^()]*\)$/, '');
    const field = error.place.replace(/[A-Z]/g, letter => `_${letter.toLowerCase()}`);  // as the protocol writes it
    throw new PdepthError(error.code, words, field ? `${place}.${field}` : place);
  }
}
function checkFields(json, place) {
  if (json === null || typeof json !== 'object') refuse('bad_value', 'must be an object', place);
  if (json.type === 'star') refuse('unsupported', 'a star is asked by the command', `${place}.type`);
  const fields = Object.hasOwn(kFields, json.type) ? kFields[json.type] : refuse('bad_value', `"${json.type}" is none of ${Object.keys(kFields).join(', ')}`, `${place}.type`);
  allowOnly(json, ['type', 'margin', ...fields], place);
  for (const key of fields) if (json[key] === undefined && key !== 'faces' && key !== 'as') refuse('bad_value', 'is missing', `${place}.${key}`);
}
/**
 * Makes the solid of a mesh that was dropped. Its parts are for the pictures, since their corners may be rounded; where there are too many, the
 * pictures of the overlap and the difference are left out.
 */
function meshBody(json, name, place) {
  const mesh = droppedMeshes.get(json.path) ?? refuse('unreadable_file', `"${json.path}" was not dropped; a page reads no files by itself`, `${place}.path`);
  if (json.margin || (json.as ?? 'solid') !== 'solid') refuse('unsupported', 'a mesh is a solid without margin here', `${place}.${json.margin ? 'margin' : 'as'}`);
  const shape = located(json.path, () => new pdepth.Solid(Float64Array.from(mesh.points), mesh.faces));
  const still = {t: [0, 0, 0], q: [0, 0, 0, 1]}, parts = [];
  try {
    const count = shape.describe().parts;
    for (let i = 0; i < count; ++i) parts.push({shape: new pdepth.Convex(shape.surface(i).points), pose: still});
  } catch (error) {
    if (!(error instanceof PdepthError)) throw error;
  }
  return {json, name, shape, parts, skin: [welded(surfaceOf(shape, 'mesh'))]};
}
/** Makes a body: the whole shape, and its convex parts in the body's frame, all margins of compounds included but the body's own. */
function makeBody(json, name, place) {
  checkFields(json, place);
  if (json.type === 'mesh') return meshBody(json, name, place);
  if (json.type !== 'compound') {
    const shape = convexShape(json, place);
    return {json, name, shape, parts: [{shape, pose: {t: [0, 0, 0], q: [0, 0, 0, 1]}}]};
  }
  if (!Array.isArray(json.parts) || json.parts.length === 0) refuse('too_few_points', 'must hold parts', `${place}.parts`);
  const parts = json.parts.flatMap((each, i) => {
    const here = `${place}.parts[${i}]`;
    allowOnly(each, ['shape', 'pose'], here);
    if (each.shape?.type === 'mesh') refuse('unsupported', 'a mesh stands alone here; the command takes it as a part', `${here}.shape`);
    const inside = makeBody(each.shape, '', `${here}.shape`);
    const pose = readPose(each.pose, `${here}.pose`);
    const swept = shape => inside.margin ? shape.withMargin(inside.margin) : shape;
    return inside.parts.map(leaf => ({shape: swept(leaf.shape), pose: composed(pose, leaf.pose)}));
  });
  let shape = located(place, () => new pdepth.Compound(parts.map(leaf => ({shape: leaf.shape, pose: libraryPose(leaf.pose)}))));
  if (json.margin) shape = located(place, () => shape.withMargin(json.margin));
  return {json, name, shape, parts, margin: json.margin ?? 0};
}
function composed(outer, inner) {
  if (outer.t.every(x => x === 0) && !outer.m && outer.q[3] === 1) return inner;
  const m = rotationOf(outer);
  const isStill = inner.t.every(x => x === 0) && !inner.m && inner.q[3] === 1;
  return isStill ? outer : {t: add(turned(m, inner.t), outer.t), m: multiplied(m, rotationOf(inner))};
}
function freeBody(body) {
  for (const leaf of body.parts) leaf.shape.free();
  body.shape.free();
}

const lineOf = state => JSON.stringify({query: 'depth', a: state.a.body.json, b: state.b.body.json, pose_a: poseJson(state.a.pose), pose_b: poseJson(state.b.pose)});
/** Reads a pasted line as two bodies and poses. */
function readLine(text) {
  let line = text.trim();
  const quoted = line.match(/'(\{.*\})'/s);
  if (quoted) line = quoted[1];
  let json;
  try {
    json = JSON.parse(line);
  } catch (error) {
    refuse('bad_json', error.message, 'line');
  }
  if (json === null || typeof json !== 'object') refuse('bad_json', 'must be an object', 'line');
  const names = ['id', 'query', 'a', 'b', 'pose_a', 'pose_b'];
  const other = Object.keys(json).find(key => !names.includes(key));
  if (other !== undefined) refuse('unsupported', `the page asks with ${names.join(', ')} alone; give the line to the command`, `line.${other}`);
  if (json.query !== undefined && json.query !== 'depth' && json.query !== 'distance') refuse('unsupported', `"${json.query}" is neither depth nor distance`, 'line.query');
  return {a: {body: makeBody(json.a, 'Pasted', 'a'), pose: readPose(json.pose_a, 'pose_a')},
          b: {body: makeBody(json.b, 'Pasted', 'b'), pose: readPose(json.pose_b, 'pose_b')}};
}

// Reads meshes: OBJ, STL (both kinds), PLY (ascii and binary), glTF. The body is the solid that the faces bound, or their convex hull, in the
// numbers of the file.

const kLargestFile = 128e6;
/** Meshes that were dropped, by the names of their files, which lines of the protocol name. */
const droppedMeshes = new Map();

function finite(x, place) {
  return Number.isFinite(x) ? x : refuse('non_finite', 'is no finite number', place);
}
function objMesh(text) {
  const points = [], faces = [];
  text.split('\n').forEach((line, i) => {
    const words = line.trim().split(/\s+/), place = `line ${i + 1}`;
    if (words[0] === 'v') {
      if (words.length < 4) refuse('bad_file', 'a vertex has 3 numbers', place);
      for (let k = 1; k <= 3; ++k) points.push(finite(Number(words[k]), place));
    } else if (words[0] === 'f') {
      const count = points.length / 3;
      faces.push(words.slice(1).map(word => {
        const v = Number(word.split('/')[0]);
        return Number.isInteger(v) && v !== 0 ? v > 0 ? v - 1 : count + v : refuse('bad_file', `"${word}" is no vertex`, place);
      }));
    }
  });
  return {points, faces};
}
/** Every three points are a triangle; the library takes equal points as one. */
function triangleSoup(points) {
  return {points, faces: Array.from({length: Math.floor(points.length / 9)}, (_, i) => [3 * i, 3 * i + 1, 3 * i + 2])};
}
function stlMesh(buffer, text) {
  const view = new DataView(buffer);
  const points = [];
  const count = buffer.byteLength >= 84 ? view.getUint32(80, true) : -1;
  if (84 + 50 * count === buffer.byteLength) {
    for (let i = 0; i < count; ++i) {
      for (let k = 0; k < 9; ++k) points.push(finite(view.getFloat32(84 + 50 * i + 12 + 4 * k, true), `triangle ${i}`));
    }
    return triangleSoup(points);
  }
  if (!/^\s*solid/.test(text())) refuse('bad_file', 'is neither an ASCII nor a binary STL of this length', 'the file');
  for (const [, x, y, z] of text().matchAll(/vertex\s+(\S+)\s+(\S+)\s+(\S+)/g)) points.push(...[x, y, z].map(n => finite(Number(n), `vertex ${points.length / 3}`)));
  return triangleSoup(points);
}
function plyMesh(buffer, text) {
  const head = text().match(/^ply\r?\n[\s\S]*?end_header\r?\n/)?.[0] ?? refuse('bad_file', 'has no header of a PLY file', 'the file');
  const lines = head.split(/\r?\n/).map(line => line.split(/\s+/));
  const format = lines.find(words => words[0] === 'format')?.[1];
  const sizes = {char: 1, uchar: 1, int8: 1, uint8: 1, short: 2, ushort: 2, int16: 2, uint16: 2, int: 4, uint: 4, int32: 4, uint32: 4, float: 4, float32: 4, double: 8, float64: 8};
  const start = lines.findIndex(words => words[0] === 'element');
  if (start < 0 || lines[start][1] !== 'vertex') refuse('bad_file', 'must have its vertices first', 'the header');
  const count = Number(lines[start][2]);
  const fields = [];
  for (let i = start + 1; lines[i][0] === 'property'; ++i) fields.push({type: lines[i][1], name: lines[i][2]});
  const places = ['x', 'y', 'z'].map(name => fields.findIndex(field => field.name === name));
  if (places.includes(-1)) refuse('bad_file', 'has no x, y, z', 'the header');
  const points = [];
  if (format === 'ascii') {
    const rows = text().slice(head.length).split('\n');
    for (let i = 0; i < count; ++i) {
      const words = (rows[i] ?? '').trim().split(/\s+/);
      for (const k of places) points.push(finite(Number(words[k]), `vertex ${i}`));
    }
    const faces = faceProperty(lines) === null ? [] : rows.slice(count, count + faceCount(lines)).map((row, i) => {
      const [corners, ...loop] = row.trim().split(/\s+/).map(Number);
      return loop.length >= corners ? loop.slice(0, corners) : refuse('bad_file', 'ends too early', `face ${i}`);
    });
    return {points, faces};
  }
  if (places.some(k => !/^(float|double)/.test(fields[k].type))) refuse('bad_file', 'must have x, y, z as float or double', 'the header');
  const little = format === 'binary_little_endian';
  const offsets = fields.map((_, i) => fields.slice(0, i).reduce((sum, field) => sum + sizes[field.type], 0));
  const stride = fields.reduce((sum, field) => sum + (sizes[field.type] ?? refuse('bad_file', `${field.type} is no number`, 'the header')), 0);
  const view = new DataView(buffer, head.length);
  if (count * stride > view.byteLength) refuse('bad_file', `ends before its ${count} vertices`, 'the file');
  for (let i = 0; i < count; ++i) {
    for (const k of places) {
      const p = i * stride + offsets[k];
      points.push(finite(fields[k].type.endsWith('64') || fields[k].type === 'double' ? view.getFloat64(p, little) : view.getFloat32(p, little), `vertex ${i}`));
    }
  }
  return {points, faces: binaryFaces(lines, view, count * stride, little)};
}
const faceCount = lines => Number(lines.find(words => words[0] === 'element' && words[1] === 'face')?.[2] ?? 0);
/** Returns the types of the list that a PLY's faces begin with; null for none. Faces have to follow the vertices. */
function faceProperty(lines) {
  const elements = lines.filter(words => words[0] === 'element').map(words => words[1]);
  if (elements[1] !== 'face') return null;
  const at = lines.findIndex(words => words[0] === 'element' && words[1] === 'face'), list = lines[at + 1];
  if (list[0] !== 'property' || list[1] !== 'list') refuse('bad_file', 'must begin its faces with their list of vertices', 'the header');
  return {count: list[2], index: list[3], alone: lines[at + 2][0] !== 'property'};
}
function binaryFaces(lines, view, start, little) {
  const list = faceProperty(lines);
  if (list === null) return [];
  if (!list.alone) refuse('unsupported', 'faces with properties beside their list are read by the command', 'the header');
  const reader = type => ({char: 'Int8', uchar: 'Uint8', int8: 'Int8', uint8: 'Uint8', short: 'Int16', ushort: 'Uint16', int16: 'Int16', uint16: 'Uint16',
                           int: 'Int32', uint: 'Uint32', int32: 'Int32', uint32: 'Uint32'})[type] ?? refuse('bad_file', `${type} is no whole number`, 'the header');
  const kinds = [reader(list.count), reader(list.index)], sizes = kinds.map(kind => Number(kind.match(/\d+/)) / 8), faces = [];
  for (let i = 0, at = start; i < faceCount(lines); ++i) {
    if (at + sizes[0] > view.byteLength) refuse('bad_file', `ends before its ${faceCount(lines)} faces`, 'the file');
    const corners = view[`get${kinds[0]}`](at, little);
    at += sizes[0];
    if (at + corners * sizes[1] > view.byteLength) refuse('bad_file', `ends before its ${faceCount(lines)} faces`, 'the file');
    faces.push(Array.from({length: corners}, (_, k) => view[`get${kinds[1]}`](at + k * sizes[1], little)));
    at += corners * sizes[1];
  }
  return faces;
}

/** Makes the hull of points a body, of the hull's own points alone, so that its line is short. */
function hullBody(points, name) {
  const hull = new pdepth.Convex(Float64Array.from(points));
  const found = hull.surface().points;
  hull.free();
  const vertices = Array.from({length: found.length / 3}, (_, i) => Array.from(found.slice(3 * i, 3 * i + 3)));
  return makeBody({type: 'convex', vertices}, name, 'mesh');
}
/** Makes a file's mesh a body. A convex solid is its hull, whose line needs no file. @param as  'solid' or 'hull' */
async function bodyOfFile(file, as) {
  return locatedIn(file.name, async () => {
    if (file.size > kLargestFile) refuse('limit_exceeded', `has ${(file.size / 1e6).toFixed(0)} MB; the page takes up to ${kLargestFile / 1e6}`, 'the file');
    const buffer = await file.arrayBuffer();
    let decoded;
    const text = () => decoded ??= new TextDecoder('latin1').decode(buffer);
    const kind = file.name.toLowerCase().split('.').pop();
    const read = {obj: () => objMesh(text()), stl: () => stlMesh(buffer, text), ply: () => plyMesh(buffer, text), gltf: () => gltfMesh(buffer),
                  glb: () => gltfMesh(buffer)}[kind];
    if (!read) refuse('bad_file', `"${kind}" is none of obj, stl, ply, gltf, glb`, 'the file');
    const mesh = read();
    if (mesh.points.length === 0) refuse('too_few_points', 'has no vertices', 'the file');
    if (as === 'hull' || mesh.faces.length === 0) return hullBody(mesh.points, file.name);
    droppedMeshes.set(file.name, mesh);
    try {
      const body = makeBody({type: 'mesh', path: file.name, as: 'solid'}, file.name, 'mesh');
      if (body.parts.length !== 1) return body;
      freeBody(body);
      return hullBody(mesh.points, file.name);
    } catch (error) {
      if (!(error instanceof PdepthError) || error.code === 'non_finite') throw error;
      throw new PdepthError(error.code, `${error.message.replace(/^\w+: /, '')}. Choose "convex hulls" beside the file to take its hull`, error.place);
    }
  });
}
async function locatedIn(name, step) {
  try {
    return await step();
  } catch (error) {
    if (!(error instanceof PdepthError)) throw error;
    throw new PdepthError(error.code, error.message.replace(/^\w+: /, '').replace(/ \([^()]*\)$/, ''), `${name}, ${error.place}`);
  }
}

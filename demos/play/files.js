// Reads the points of meshes: OBJ, STL (both kinds), PLY (ascii and binary). The body is their convex hull, in the numbers of the file.

const kLargestFile = 128e6;

function finite(x, place) {
  return Number.isFinite(x) ? x : refuse('non_finite', 'is no finite number', place);
}
function objPoints(text) {
  const points = [];
  text.split('\n').forEach((line, i) => {
    const words = line.trim().split(/\s+/);
    if (words[0] !== 'v') return;
    if (words.length < 4) refuse('bad_file', 'a vertex has 3 numbers', `line ${i + 1}`);
    for (let k = 1; k <= 3; ++k) points.push(finite(Number(words[k]), `line ${i + 1}`));
  });
  return points;
}
function stlPoints(buffer, text) {
  const view = new DataView(buffer);
  const points = [];
  const count = buffer.byteLength >= 84 ? view.getUint32(80, true) : -1;
  if (84 + 50 * count === buffer.byteLength) {
    for (let i = 0; i < count; ++i) {
      for (let k = 0; k < 9; ++k) points.push(finite(view.getFloat32(84 + 50 * i + 12 + 4 * k, true), `triangle ${i}`));
    }
    return points;
  }
  if (!/^\s*solid/.test(text())) refuse('bad_file', 'is neither an ASCII nor a binary STL of this length', 'the file');
  for (const [, x, y, z] of text().matchAll(/vertex\s+(\S+)\s+(\S+)\s+(\S+)/g)) points.push(...[x, y, z].map(n => finite(Number(n), `vertex ${points.length / 3}`)));
  return points;
}
function plyPoints(buffer, text) {
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
    return points;
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
  return points;
}

/** Makes the hull of a file's points a body, of the hull's own points alone, so that its line is short. */
async function bodyOfFile(file) {
  return locatedIn(file.name, async () => {
    if (file.size > kLargestFile) refuse('limit_exceeded', `has ${(file.size / 1e6).toFixed(0)} MB; the page takes up to ${kLargestFile / 1e6}`, 'the file');
    const buffer = await file.arrayBuffer();
    let decoded;
    const text = () => decoded ??= new TextDecoder('latin1').decode(buffer);
    const kind = file.name.toLowerCase().split('.').pop();
    const read = {obj: () => objPoints(text()), stl: () => stlPoints(buffer, text), ply: () => plyPoints(buffer, text)}[kind];
    if (!read) refuse('bad_file', `"${kind}" is none of obj, stl, ply`, 'the file');
    const points = read();
    if (points.length === 0) refuse('too_few_points', 'has no vertices', 'the file');
    const hull = new pdepth.Convex(Float64Array.from(points));
    const found = hull.surface().points;
    hull.free();
    const vertices = Array.from({length: found.length / 3}, (_, i) => Array.from(found.slice(3 * i, 3 * i + 3)));
    return makeBody({type: 'convex', vertices}, file.name, 'mesh');
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

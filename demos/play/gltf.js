// Reads the triangles of a glTF 2 file: .glb, and .gltf with its buffers inside. Every mesh of the scene, once for every node that shows it.

const kComponents = {5120: ['getInt8', 1, 127], 5121: ['getUint8', 1, 255], 5122: ['getInt16', 2, 32767], 5123: ['getUint16', 2, 65535],
                     5125: ['getUint32', 4, 1], 5126: ['getFloat32', 4, 1]};
const kUnread = ['KHR_draco_mesh_compression', 'EXT_meshopt_compression', 'KHR_meshopt_compression', 'EXT_mesh_gpu_instancing'];
const kLevels = 1000;

/** Returns JSON and binary chunk. A GLB is known by its first four bytes. */
function gltfParts(buffer) {
  const view = new DataView(buffer), text = (from, size) => new TextDecoder().decode(new Uint8Array(buffer, from, size));
  if (buffer.byteLength < 4 || text(0, 4) !== 'glTF') return {json: text(0, buffer.byteLength), chunk: null};
  if (buffer.byteLength < 20) refuse('bad_file', 'ends in the header of its GLB', 'the file');
  if (view.getUint32(4, true) !== 2) refuse('unsupported', `has version ${view.getUint32(4, true)}; 2 is read`, 'the header');
  const parts = {json: '', chunk: null};
  for (let at = 12; at + 8 <= buffer.byteLength;) {
    const size = view.getUint32(at, true), kind = text(at + 4, 4);
    at += 8;
    if (size > buffer.byteLength - at) refuse('bad_file', `ends before a chunk of ${size} bytes does`, 'the file');
    if (kind === 'JSON') parts.json ||= text(at, size);
    if (kind === 'BIN\0') parts.chunk ??= new DataView(buffer, at, size);
    at += size;
  }
  return parts;
}
function gltfBuffer({uri}, chunk, place) {
  if (uri === undefined) return chunk ?? refuse('bad_file', 'has no bytes', place);
  const inside = String(uri).match(/^data:[^,]*;base64,(.*)$/s);
  if (!inside) refuse('unsupported', `"${String(uri).slice(0, 60)}" is a file of its own; drop a .glb, which holds its buffers`, place);
  try {
    return new DataView(Uint8Array.from(atob(inside[1]), c => c.charCodeAt(0)).buffer);
  } catch {
    return refuse('bad_file', 'is no base64', place);
  }
}

/** Reads accessors of the file; each refusal names its place in the JSON. */
class GltfValues {
  constructor(json, chunk) {
    this.json = json;
    this.chunk = chunk;
    this.buffers = new Map();
  }
  element(list, index, place) {
    const found = Array.isArray(this.json[list]) && Number.isInteger(index) ? this.json[list][index] : undefined;
    return found && typeof found === 'object' ? found : refuse('bad_file', `there is no ${list}[${index}]`, place);
  }
  buffer(index, place) {
    if (!this.buffers.has(index)) this.buffers.set(index, gltfBuffer(this.element('buffers', index, place), index === 0 ? this.chunk : null, `buffers[${index}]`));
    return this.buffers.get(index);
  }
  /** Returns the numbers of an accessor as one array. */
  numbers(index, width, place) {
    const accessor = this.element('accessors', index, place), here = `accessors[${index}]`;
    if (accessor.sparse) refuse('unsupported', 'sparse accessors are read by the command', here);
    if (accessor.type !== (width === 3 ? 'VEC3' : 'SCALAR')) refuse('bad_file', `has the type ${accessor.type}`, here);
    const [read, size, most] = kComponents[accessor.componentType] ?? refuse('bad_file', `${accessor.componentType} is no type of a component`, here);
    const {count} = accessor;
    if (!Number.isInteger(count) || count < 0) refuse('bad_file', 'has no count', here);
    if (accessor.bufferView === undefined) refuse('unsupported', 'has no buffer view', here);
    const lies = this.element('bufferViews', accessor.bufferView, here), view = this.buffer(lies.buffer, `bufferViews[${accessor.bufferView}]`);
    const stride = lies.byteStride ?? width * size, start = (lies.byteOffset ?? 0) + (accessor.byteOffset ?? 0);
    if (count > 0 && !(start >= 0 && stride >= width * size && start + (count - 1) * stride + width * size <= view.byteLength)) refuse('bad_file', 'reaches beyond its buffer', here);
    const out = new Float64Array(width * count), share = accessor.normalized ? 1 / most : 1;
    for (let i = 0; i < count; ++i) for (let k = 0; k < width; ++k) out[width * i + k] = share * view[read](start + i * stride + k * size, true);
    return out;
  }
}

/** Returns a node's own placement as 9 numbers by rows and a position. */
function gltfPlacement(node, place) {
  const numbers = (name, count, otherwise) => {
    const found = node[name] ?? otherwise;
    if (!Array.isArray(found) || found.length !== count || !found.every(Number.isFinite)) refuse('bad_file', `must be ${count} numbers`, `${place}.${name}`);
    return found;
  };
  if (node.matrix !== undefined) {
    const c = numbers('matrix', 16);
    return {m: [c[0], c[4], c[8], c[1], c[5], c[9], c[2], c[6], c[10]], t: [c[12], c[13], c[14]]};
  }
  const turn = matrixOf(product(numbers('rotation', 4, [0, 0, 0, 1]), [0, 0, 0, 1])), scale = numbers('scale', 3, [1, 1, 1]);
  return {m: turn.map((x, i) => x * scale[i % 3]), t: numbers('translation', 3, [0, 0, 0])};
}
const determinant = m => dot([m[0], m[1], m[2]], cross([m[3], m[4], m[5]], [m[6], m[7], m[8]]));

function gltfMesh(buffer) {
  const {json: text, chunk} = gltfParts(buffer);
  let json;
  try {
    json = JSON.parse(text);
  } catch (error) {
    refuse('bad_file', error.message, 'the JSON');
  }
  if (json === null || typeof json !== 'object' || !String(json.asset?.version).startsWith('2.')) refuse('unsupported', 'only glTF 2 is read', 'asset.version');
  for (const name of json.extensionsRequired ?? []) if (kUnread.includes(name)) refuse('unsupported', `${name} is not read`, 'extensionsRequired');
  const values = new GltfValues(json, chunk), points = [], faces = [], seen = new Set();
  const show = (index, parent, level) => {
    const place = `nodes[${index}]`, node = values.element('nodes', index, place);
    if (seen.has(index)) refuse('bad_file', 'has two parents; nodes must be a tree', place);
    if (level > kLevels) refuse('limit_exceeded', `stands deeper than ${kLevels} levels`, place);
    seen.add(index);
    const own = gltfPlacement(node, place);
    const at = {m: multiplied(parent.m, own.m), t: add(turned(parent.m, own.t), parent.t)};
    if (node.mesh !== undefined) addGltfMesh(values, node.mesh, at, points, faces);
    for (const child of node.children ?? []) show(child, at, level + 1);
  };
  const children = new Set((json.nodes ?? []).flatMap(node => node?.children ?? []));
  const roots = json.scenes ? values.element('scenes', json.scene ?? 0, 'scene').nodes ?? [] : (json.nodes ?? []).map((_, i) => i).filter(i => !children.has(i));
  for (const root of roots) show(root, {m: [1, 0, 0, 0, 1, 0, 0, 0, 1], t: [0, 0, 0]}, 1);
  return {points, faces};
}
function addGltfMesh(values, index, at, points, faces) {
  const mirrored = determinant(at.m) < 0, {primitives} = values.element('meshes', index, `meshes[${index}]`);
  for (const [i, primitive] of (primitives ?? []).entries()) {
    const place = `meshes[${index}].primitives[${i}]`, first = points.length / 3;
    if (primitive?.attributes?.POSITION === undefined) continue;
    const own = values.numbers(primitive.attributes.POSITION, 3, place);
    for (let k = 0; k < own.length; k += 3) points.push(...add(turned(at.m, [own[k], own[k + 1], own[k + 2]]), at.t).map((x, j) => finite(x, `${place}, vertex ${k / 3}, number ${j}`)));
    const order = primitive.indices === undefined ? Array.from({length: own.length / 3}, (_, k) => k) : values.numbers(primitive.indices, 1, place);
    const triangle = (...corners) => {
      for (const k of corners) if (!(order[k] < own.length / 3)) refuse('bad_file', 'a face names a vertex that is not there', place);
      const face = corners.map(k => first + order[k]);
      faces.push(mirrored ? face.reverse() : face);
    };
    const mode = primitive.mode ?? 4, n = order.length;
    if (mode === 4) for (let k = 0; k + 2 < n; k += 3) triangle(k, k + 1, k + 2);
    if (mode === 5) for (let k = 0; k + 2 < n; ++k) triangle(k, k + 1 + k % 2, k + 2 - k % 2);
    if (mode === 6) for (let k = 1; k + 1 < n; ++k) triangle(0, k, k + 1);
  }
}

// Exact, certified penetration depth of bodies: objects around the functions of pdepth.h.
//
// Every answer has the bits of the C and C++ libraries. A moves by `translation`, B stays; `normal` is the way on which A leaves B.
// The types and their comments stand in index.d.ts.

/** A refusal holds the code of pdepth.h ("non_finite") and the place of the fault ("points[3]"). */
export class PdepthError extends Error {
  constructor(code, message, place) {
    super(place ? `${code}: ${message} (${place})` : `${code}: ${message}`);
    this.name = 'PdepthError';
    this.code = code;
    this.place = place;
  }
}

const refuse = (code, message, place) => { throw new PdepthError(code, message, place); };

const kContacts = ['separated', 'touching', 'overlapping'];
const kMethods = ['automatic', 'expansion', 'overlay', 'decomposition', 'shallow', 'grid'];
const kBrackets = ['tightest', 'certified', 'contact'];
const kFeatures = ['none', 'vertex', 'edge', 'facet'];
const kTranslation = 0, kXyzw = 2, kMatrix = 3;
const kFormOfLength = {3: kTranslation, 7: kXyzw, 12: kMatrix};
const kUse = Symbol('handle');

// ---- The module and its memory

let wasm = null;  // exports of the module
let at = null;    // places of fields: at.answer.depth
let context = 0;
let loadLines = null;
let bytes, words, doubles, longs;  // views of the memory, which grows

function see() {
  if (words && words.buffer === wasm.memory.buffer) return;
  const buffer = wasm.memory.buffer;
  bytes = new Uint8Array(buffer);
  words = new Int32Array(buffer);
  doubles = new Float64Array(buffer);
  longs = new BigInt64Array(buffer);
}

function textAt(pointer) {
  see();
  let end = pointer;
  while (bytes[end] !== 0) ++end;
  return new TextDecoder().decode(bytes.slice(pointer, end));
}

/** Makes an instance from bytes, a WebAssembly.Module or a Response, and returns its exports. */
async function instantiated(source) {
  let instance;
  const given = {
    emscripten_notify_memory_growth: () => {},
    // Answers to lines tell how long they took.
    clock_time_get: (clock, precision, out) => {
      new DataView(instance.exports.memory.buffer).setBigUint64(out, BigInt(Math.round(1e6 * performance.now())), true);
      return 0;
    },
  };
  // The modules read no file: what their C library could ask of a system is refused, by "function not supported".
  const imports = new Proxy({}, {get: () => new Proxy({}, {get: (_, name) => given[name] ?? (() => 52), has: () => true})});
  if (typeof Response !== 'undefined' && source instanceof Response) source = await source.arrayBuffer();
  if (source instanceof WebAssembly.Module) instance = await WebAssembly.instantiate(source, imports);
  else ({instance} = await WebAssembly.instantiate(source, imports));
  if (instance.exports._initialize) instance.exports._initialize();
  return instance.exports;
}

/**
 * Starts the library around a compiled or instantiated module; for hosts that load it in a way of their own.
 * @param source  bytes of pdepth.wasm, a WebAssembly.Module, or a Response.
 * @param lines  a function that returns such a source of pdepth-lines.wasm, or a promise of it. The first `query` calls it.
 */
export async function start(source, lines) {
  if (lines) loadLines = lines;
  if (wasm) return;
  wasm = await instantiated(source);
  at = {};
  see();
  for (let row = wasm.pdepth_web_layout() >> 2; words[row] !== 0; row += 2) {
    const [type, field = 'size'] = textAt(words[row]).split('.');
    (at[type] ??= {})[field] = words[row + 1];
  }
  const out = room(8);
  if (wasm.pdepth_context_create(0, out) !== 0) refuse('out_of_memory', 'no memory for a context', '');
  see();
  context = words[out >> 2];
}

// Arguments of one call lie in a block that is used again and again.
let block = 0, blockSize = 0, used = 0;

/** Makes room for arguments, zeroed, until the next public call. */
function room(size) {
  // Bit operations would wrap a larger size around, and the module's memory ends here.
  if (!(size <= 2 ** 31 - 65536)) refuse('out_of_memory', `no memory for ${size} bytes of arguments`, '');
  size = (size + 15) & ~15;
  if (used + size > blockSize) {
    // Rooms that were given away stay where they are until the call has ended.
    if (block) extra.push(block);
    blockSize = Math.max(2 * blockSize, used + size, 4096);
    block = wasm.malloc(blockSize);
    if (block === 0) { blockSize = used = 0; refuse('out_of_memory', `no memory for ${size} bytes of arguments`, ''); }
    used = 0;
  }
  see();
  const place = block + used;
  used += size;
  bytes.fill(0, place, place + size);
  return place;
}
const extra = [];

/** Runs one public call, whose rooms are given back at its end. */
function call(body) {
  if (!wasm) refuse('not_ready', 'the library has not been started: await pdepth.ready', '');
  used = 0;
  try {
    return body();
  } finally {
    while (extra.length) wasm.free(extra.pop());
    if (blockSize > 1 << 22) { wasm.free(block); block = blockSize = 0; }
    used = 0;
  }
}

function struct(type) {
  const place = room(at[type].size);
  words[place >> 2] = at[type].size;
  return place;
}

/** The error of the call that has just failed. */
function lastError() {
  const out = room(at.error.size);
  wasm.pdepth_last_error(context, out);
  see();
  const status = words[(out + at.error.status) >> 2];
  return new PdepthError(textAt(wasm.pdepth_status_name(status)), textAt(words[(out + at.error.message) >> 2]),
                         placeOf(textAt(words[(out + at.error.where) >> 2])));
}
/** A place in the words of C as one of this package: "question.pose_b.translation[1]" is poseB.position[1], "mesh.points[1]" is points[1]. */
function placeOf(where) {
  return where.replace(/^question\./, '').replace(/^(?:mesh|faces)\.(points|faces)/, '$1').replace(/^mesh$/, 'points')
      .replace(/(\bpose\w*)\.translation/, '$1.position').replace(/_([a-z])/g, (_, letter) => letter.toUpperCase());
}
function check(status) {
  see();
  if (status !== 0) throw lastError();
}

// ---- Reading arguments

/** Writes numbers of an array, a typed array or an array of rows as doubles. Returns [pointer, count of numbers]. */
function writeNumbers(values, place, rowLength) {
  if (values == null || typeof values !== 'object' || typeof values.length !== 'number') {
    refuse('bad_value', 'must be an array of numbers or a typed array', place);
  }
  const nested = rowLength > 0 && values.length > 0 && typeof values[0] === 'object';
  const count = nested ? rowLength * values.length : values.length;
  if (rowLength > 0 && count % rowLength !== 0) {
    refuse('bad_value', `has ${count} numbers, which is no multiple of ${rowLength}`, place);
  }
  const pointer = room(8 * Math.max(count, 1));
  const first = pointer >> 3;
  if (!nested && ArrayBuffer.isView(values) && typeof values[0] !== 'bigint') {
    doubles.set(values, first);
    return [pointer, count];
  }
  for (let i = 0, k = 0; i < values.length; ++i) {
    if (nested && (values[i] == null || values[i].length !== rowLength)) {
      refuse('bad_value', `must have ${rowLength} numbers`, `${place}[${i}]`);
    }
    for (let j = 0; j < (nested ? rowLength : 1); ++j, ++k) {
      const x = nested ? values[i][j] : values[i];
      if (typeof x !== 'number') refuse('bad_value', `${String(x)} is no number`, nested ? `${place}[${i}][${j}]` : `${place}[${i}]`);
      doubles[first + k] = x;
    }
  }
  return [pointer, count];
}

function writeVector(values, place) {
  const [pointer, count] = writeNumbers(values, place, 0);
  if (count !== 3) refuse('bad_value', `must have 3 numbers, and has ${count}`, place);
  return pointer;
}

function readNumber(x, place) {
  if (typeof x !== 'number') refuse('bad_value', `${String(x)} is no number`, place);
  return x;
}

function readWhole(x, least, place) {
  if (!Number.isSafeInteger(x) || x < least) refuse('bad_value', `${String(x)} is no whole number from ${least}`, place);
  return x;
}

/** Refuses what is no object, nullish values aside, and a key of the caller's object that is none of the names. */
function allowOnly(object, names, place) {
  if (object != null && typeof object !== 'object') refuse('bad_value', `must be an object of ${names.join(', ')}`, place);
  for (const key of Object.keys(object ?? {})) {
    if (!names.includes(key)) refuse('bad_value', `is none of ${names.join(', ')}`, `${place}.${key}`);
  }
}

/** Writes a pose of the caller into a pdepth_pose. */
function fillPose(into, pose, place) {
  if (pose == null) return;
  let numbers = pose;
  if (typeof pose.length !== 'number') {
    allowOnly(pose, ['position', 'quaternion', 'matrix'], place);
    const {quaternion, matrix} = pose, position = pose.position ?? [0, 0, 0];
    if (quaternion && matrix) refuse('bad_value', 'has a quaternion and a matrix', place);
    if (position.length !== 3) refuse('bad_value', 'must have 3 numbers', `${place}.position`);
    if (quaternion && quaternion.length !== 4) refuse('bad_value', 'must have the 4 numbers x, y, z, w', `${place}.quaternion`);
    if (matrix && matrix.length !== 9) refuse('bad_value', 'must have 9 numbers, by rows', `${place}.matrix`);
    numbers = [...position, ...(quaternion ?? matrix ?? [])];
  }
  const form = kFormOfLength[numbers.length];
  if (form === undefined) refuse('bad_value', `has ${numbers.length} numbers, instead of 3 (position), 7 (and x, y, z, w) or 12 (and a matrix by rows)`, place);
  words[(into + at.pose.form) >> 2] = form;
  const first = (into + at.pose.numbers) >> 3;
  for (let i = 0; i < numbers.length; ++i) doubles[first + i] = readNumber(numbers[i], `${place}[${i}]`);
}

const kSettings = ['method', 'bracket', 'beyond', 'delta', 'contactTolerance', 'seed', 'maxPoints'];

/** Writes settings of the caller as a pdepth_settings. Returns its place, or 0 for none. */
function writeSettings(settings) {
  if (settings == null) return 0;
  allowOnly(settings, kSettings, 'settings');
  const out = struct('settings');
  const choose = (names, value, place) => {
    const found = names.indexOf(value);
    if (found < 0) refuse('bad_value', `"${value}" is none of ${names.join(', ')}`, place);
    return found;
  };
  if (settings.method !== undefined) words[(out + at.settings.method) >> 2] = choose(kMethods, settings.method, 'settings.method');
  if (settings.bracket !== undefined) words[(out + at.settings.bracket) >> 2] = choose(kBrackets, settings.bracket, 'settings.bracket');
  if (settings.beyond !== undefined) {
    words[(out + at.settings.use_beyond) >> 2] = 1;
    doubles[(out + at.settings.beyond) >> 3] = readNumber(settings.beyond, 'settings.beyond');
  }
  if (settings.delta !== undefined) doubles[(out + at.settings.delta) >> 3] = readNumber(settings.delta, 'settings.delta');
  if (settings.contactTolerance !== undefined) {
    doubles[(out + at.settings.contact_tolerance) >> 3] = readNumber(settings.contactTolerance, 'settings.contactTolerance');
  }
  if (settings.seed !== undefined) {
    if (typeof settings.seed !== 'bigint') readWhole(settings.seed, 0, 'settings.seed');
    longs[(out + at.settings.seed) >> 3] = BigInt(settings.seed);
  }
  if (settings.maxPoints !== undefined) {
    longs[(out + at.settings.max_points) >> 3] = BigInt(readWhole(settings.maxPoints, 1, 'settings.maxPoints'));
  }
  return out;
}

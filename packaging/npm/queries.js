// ---- Queries

function pairPointer(pair, place) {
  if (!(pair instanceof Pair)) refuse('bad_value', 'must be a Pair of this library', place);
  return pair[kUse](place);
}

function writeQuestion(a, poseA, b, poseB, options) {
  const out = struct('question');
  words[(out + at.question.a) >> 2] = shapePointer(a, 'a');
  words[(out + at.question.b) >> 2] = shapePointer(b, 'b');
  fillPose(out + at.question.pose_a, poseA, 'poseA');
  fillPose(out + at.question.pose_b, poseB, 'poseB');
  if (options != null) {
    if (typeof options !== 'object') refuse('bad_value', 'must be an object of settings, with a pair or without', 'options');
    const {pair, ...settings} = options;
    const written = writeSettings(settings);
    words[(out + at.question.settings) >> 2] = written;
    if (pair != null) words[(out + at.question.pair) >> 2] = pairPointer(pair, 'pair');
  }
  return out;
}

const vector = place => [doubles[place >> 3], doubles[(place >> 3) + 1], doubles[(place >> 3) + 2]];
function readFeature(place) {
  const w = place >> 2;
  return {kind: kFeatures[words[w + (at.feature.kind >> 2)]], part: words[w + (at.feature.part >> 2)] === kMesh ? 'mesh' : words[w + (at.feature.part >> 2)],
          first: words[w + (at.feature.first >> 2)], second: words[w + (at.feature.second >> 2)]};
}
function readAnswer(p) {
  const word = name => words[(p + at.answer[name]) >> 2];
  const number = name => doubles[(p + at.answer[name]) >> 3];
  const count = name => Number(longs[(p + at.answer[name]) >> 3]);
  return {
    contact: kContacts[word('contact')], depth: number('depth'), lower: number('lower'), upper: number('upper'),
    distance: number('distance'), distanceLower: number('distance_lower'), distanceUpper: number('distance_upper'),
    translation: vector(p + at.answer.translation), normal: vector(p + at.answer.normal),
    witnessA: vector(p + at.answer.witness_a), witnessB: vector(p + at.answer.witness_b),
    featureA: readFeature(p + at.answer.feature_a), featureB: readFeature(p + at.answer.feature_b),
    method: kMethods[word('method')], warm: word('warm') === 1, bracketReached: word('bracket_reached') === 1,
    supportCalls: count('support_calls'), facetsVisited: count('facets_visited'), exactSigns: count('exact_signs'),
  };
}

/** Penetration depth of two bodies, or their distance when apart. */
export function depth(a, poseA, b, poseB, options) {
  return call(() => {
    const question = writeQuestion(a, poseA, b, poseB, options), out = struct('answer');
    check(wasm.pdepth_depth(context, question, out));
    return readAnswer(out);
  });
}

/** Tells if two bodies are apart by more than `distance`. */
export function apart(a, poseA, b, poseB, distance = 0, options) {
  return call(() => {
    const question = writeQuestion(a, poseA, b, poseB, options), out = room(8);
    check(wasm.pdepth_apart(context, question, readNumber(distance, 'distance'), out));
    return words[out >> 2] === 1;
  });
}

/** Depth along a direction of any length but zero. */
export function depthAlong(a, poseA, b, poseB, direction) {
  return call(() => {
    const question = writeQuestion(a, poseA, b, poseB), way = writeVector(direction, 'direction'), out = struct('directional');
    check(wasm.pdepth_depth_along(context, question, way, out));
    const number = name => doubles[(out + at.directional[name]) >> 3];
    return {contact: kContacts[words[(out + at.directional.contact) >> 2]], depth: number('depth'), lower: number('lower'),
            upper: number('upper'), normal: vector(out + at.directional.normal),
            featureA: readFeature(out + at.directional.feature_a), featureB: readFeature(out + at.directional.feature_b)};
  });
}

/** The contact of two convex bodies as at most four pairs of points. */
export function manifold(a, poseA, b, poseB, breakingThreshold = 0, options) {
  return call(() => {
    const question = writeQuestion(a, poseA, b, poseB, options), out = struct('manifold');
    check(wasm.pdepth_contact_manifold(context, question, readNumber(breakingThreshold, 'breakingThreshold'), out));
    const points = [];
    for (let i = 0; i < words[(out + at.manifold.count) >> 2]; ++i) {
      const p = out + at.manifold.points + i * at.contact_point.size;
      points.push({positionA: vector(p + at.contact_point.position_a), positionB: vector(p + at.contact_point.position_b),
                   depth: doubles[(p + at.contact_point.depth) >> 3], featureId: longs[(p + at.contact_point.feature_id) >> 3]});
    }
    return {contact: kContacts[words[(out + at.manifold.contact) >> 2]], normal: vector(out + at.manifold.normal), points};
  });
}

function fillMotion(into, motion, place) {
  const fields = {linearVelocity: 'linear_velocity', angularVelocity: 'angular_velocity', arm: 'arm'};
  allowOnly(motion, Object.keys(fields), place);
  for (const [key, value] of Object.entries(motion ?? {})) {
    const first = (into + at.motion[fields[key]]) >> 3;
    if (value?.length !== 3) refuse('bad_value', 'must have 3 numbers', `${place}.${key}`);
    for (let k = 0; k < 3; ++k) doubles[first + k] = readNumber(value[k], `${place}.${key}[${k}]`);
  }
}

/** Finds when two moving convex bodies first touch. */
export function timeOfImpact(a, poseA, b, poseB, movement, options) {
  return call(() => {
    const question = writeQuestion(a, poseA, b, poseB, options), moves = struct('movement');
    if (movement == null) refuse('bad_value', 'must be an object with a duration', 'movement');
    allowOnly(movement, ['a', 'b', 'duration', 'distanceTolerance', 'allowedDepth'], 'movement');
    fillMotion(moves + at.movement.a, movement.a, 'movement.a');
    fillMotion(moves + at.movement.b, movement.b, 'movement.b');
    doubles[(moves + at.movement.duration) >> 3] = readNumber(movement.duration, 'movement.duration');
    doubles[(moves + at.movement.distance_tolerance) >> 3] = readNumber(movement.distanceTolerance ?? 0, 'movement.distanceTolerance');
    doubles[(moves + at.movement.allowed_depth) >> 3] = readNumber(movement.allowedDepth ?? 0, 'movement.allowedDepth');
    const out = struct('impact'), contact = struct('answer');
    check(wasm.pdepth_time_of_impact(context, question, moves, out, contact));
    const word = name => words[(out + at.impact[name]) >> 2];
    return {hit: word('hit') === 1, reached: word('reached') === 1, queries: word('queries'),
            time: doubles[(out + at.impact.time) >> 3], certified: doubles[(out + at.impact.certified) >> 3],
            contact: readAnswer(contact)};
  });
}

/** Derivatives of the signed depth by the translations and rotations of the poses. What does not exist is NaN. */
export function derivatives(a, poseA, b, poseB) {
  return call(() => {
    const question = writeQuestion(a, poseA, b, poseB), out = struct('derivatives'), answer = struct('answer');
    check(wasm.pdepth_depth_derivatives(context, question, out, answer));
    const flag = name => words[(out + at.derivatives[name]) >> 2] === 1;
    const six = name => Array.from(doubles.slice((out + at.derivatives[name]) >> 3, ((out + at.derivatives[name]) >> 3) + 6));
    return {uniqueDirection: flag('unique_direction'), uniqueWitness: flag('unique_witness'), stableFeatures: flag('stable_features'),
            signedDepth: doubles[(out + at.derivatives.signed_depth) >> 3], byA: six('by_a'), byB: six('by_b'),
            answer: readAnswer(answer)};
  });
}

/** The least distance of two parallel planes that hold a convex body between them. */
export function width(shape, pose) {
  return call(() => {
    const place = room(at.pose.size), out = struct('width_answer');
    fillPose(place, pose, 'pose');
    check(wasm.pdepth_width(context, shapePointer(shape, 'shape'), place, 0, out));
    const number = name => doubles[(out + at.width_answer[name]) >> 3];
    return {width: number('width'), lower: number('lower'), upper: number('upper'), normal: vector(out + at.width_answer.normal)};
  });
}

/** The point of a body that is farthest along a direction. */
export function support(shape, pose, direction) {
  return call(() => {
    const place = room(at.pose.size), out = struct('support_answer');
    fillPose(place, pose, 'pose');
    check(wasm.pdepth_support(context, shapePointer(shape, 'shape'), place, writeVector(direction, 'direction'), out));
    const word = name => words[(out + at.support_answer[name]) >> 2];
    return {part: word('part'), vertex: word('vertex'), value: doubles[(out + at.support_answer.value) >> 3],
            point: vector(out + at.support_answer.point)};
  });
}

// ---- Batches

/** Writes one shape, or one for each row, as an array of pointers. Returns [pointer, stride, rows or -1]. */
function writeShapes(shapes, place) {
  const many = Array.isArray(shapes);
  const row = room(4 * Math.max(many ? shapes.length : 1, 1));
  if (many) shapes.forEach((shape, i) => { words[(row >> 2) + i] = shapePointer(shape, `${place}[${i}]`); });
  else words[row >> 2] = shapePointer(shapes, place);
  return [row, many ? 4 : 0, many ? shapes.length : -1];
}

const kLengths = new Map([['position', 3], ['quaternion', 7], ['matrix', 12]]);
/** Writes the poses of all rows into a pdepth_pose_array; one pose of the row's length stands for all. Returns the rows, or -1. */
function fillPoses(into, poses, form, place) {
  if (poses == null) return -1;
  const length = kLengths.get(form) ?? refuse('bad_value', `"${String(form)}" is none of position, quaternion, matrix`, place.replace('poses', 'form'));
  const [pointer, count] = writeNumbers(poses, place, length);
  words[(into + at.pose_array.form) >> 2] = kFormOfLength[length];
  words[(into + at.pose_array.numbers) >> 2] = pointer;
  words[(into + at.pose_array.stride) >> 2] = count === length ? 0 : 8 * length;
  return count === length ? -1 : count / length;
}

const kColumns = {depth: 1, lower: 1, upper: 1, distance: 1, distance_lower: 1, distance_upper: 1, translation: 3, normal: 3,
                  witness_a: 3, witness_b: 3};
const camel = name => name.replace(/_(.)/g, (_, letter) => letter.toUpperCase());

/** Depths of many rows in one call, as columns. */
export function depthBatch(batch) {
  return call(() => {
    allowOnly(batch, ['a', 'posesA', 'formA', 'b', 'posesB', 'formB', 'settings', 'count'], 'batch');
    const {a, posesA, formA = 'quaternion', b, posesB, formB = 'quaternion', settings, count} = batch ?? {};
    if (count !== undefined) readWhole(count, 0, 'count');
    const question = struct('batch');
    const written = writeSettings(settings);
    const [pointerA, strideA, rowsA] = writeShapes(a, 'a');
    const [pointerB, strideB, rowsB] = writeShapes(b, 'b');
    const rows = [rowsA, rowsB, fillPoses(question + at.batch.poses_a, posesA, formA, 'posesA'),
                  fillPoses(question + at.batch.poses_b, posesB, formB, 'posesB'), count ?? -1].filter(n => n >= 0);
    const n = rows.length ? rows[0] : 1;
    if (rows.some(m => m !== n)) refuse('bad_value', `arrays have rows for ${rows.join(', ')} pairs`, 'count');
    words[(question + at.batch.a) >> 2] = pointerA;
    words[(question + at.batch.stride_a) >> 2] = strideA;
    words[(question + at.batch.b) >> 2] = pointerB;
    words[(question + at.batch.stride_b) >> 2] = strideB;
    words[(question + at.batch.settings) >> 2] = written;
    longs[(question + at.batch.count) >> 3] = BigInt(n);
    const answers = room(at.answer.size * Math.max(n, 1));
    words[answers >> 2] = at.answer.size;
    const status = wasm.pdepth_depth_batch(context, question, answers, at.answer.size);
    see();
    const out = {count: n, status: new Uint8Array(n), contact: new Uint8Array(n), error: status === 0 ? null : lastError()};
    const integers = ['status', 'contact'].map(name => [out[name], at.answer[name] >> 2]);
    const columns = Object.entries(kColumns).map(([name, length]) => {
      const column = out[camel(name)] = new Float64Array(length * n);
      return [column, at.answer[name] >> 3, length];
    });
    if (n > 0 && words[answers >> 2] !== at.answer.size) throw out.error;
    for (let row = 0; row < n; ++row) {
      const p = answers + row * at.answer.size;
      for (const [column, offset] of integers) column[row] = words[(p >> 2) + offset];
      if (out.status[row] !== 0) { for (const [column, , length] of columns) column.fill(NaN, length * row, length * (row + 1)); continue; }
      for (const [column, offset, length] of columns) {
        for (let k = 0; k < length; ++k) column[length * row + k] = doubles[(p >> 3) + offset + k];
      }
    }
    return out;
  });
}

// ---- The line protocol, in a module of its own

let lineModule = null;  // a promise of its exports

/** Answers a line of the protocol by the command's own reader, without files. The first call loads the module. */
export async function query(line) {
  if (typeof line !== 'string') refuse('bad_value', 'must be a line of the protocol', 'line');
  if (!loadLines) refuse('unsupported', 'no module of the line protocol was given to start()', 'line');
  lineModule ??= Promise.resolve(loadLines()).then(instantiated);
  try {
    const lines = await lineModule, text = new TextEncoder().encode(line);
    const place = lines.malloc(text.length + 16);
    if (place === 0) refuse('out_of_memory', `no memory for a line of ${text.length} bytes`, 'line');
    // The length of the answer stands before the line.
    new Uint8Array(lines.memory.buffer).set(text, place + 8);
    const answer = lines.pdepth_web_answer_line(place + 8, text.length, place);
    const size = new DataView(lines.memory.buffer).getInt32(place, true);
    lines.free(place);
    return new TextDecoder().decode(new Uint8Array(lines.memory.buffer, answer, size));
  } catch (error) {
    if (error instanceof PdepthError) throw error;
    lineModule = null;  // an instance that has trapped is not asked again
    throw new PdepthError('internal', `the module of the line protocol failed: ${error.message}`, 'line');
  }
}

/** The version of the library, "0.1.0". */
export function version() {
  return call(() => {
    const number = wasm.pdepth_version();
    return `${Math.floor(number / 10000)}.${Math.floor(number / 100) % 100}.${number % 100}`;
  });
}

// The npm package as its users have it: installed from the tarball in a folder of its own.
import assert from 'node:assert/strict';
import {readFileSync} from 'node:fs';
import {createRequire} from 'node:module';
import {test} from 'node:test';
import {pathToFileURL} from 'node:url';
import {Worker} from 'node:worker_threads';
import * as pdepth from 'pdepth';

const {Box, Capsule, Compound, Cone, Convex, Halfspaces, HullOfSpheres, Pair, PdepthError, Shape, Solid, Sphere} = pdepth;
const cube = new Box([0.5, 0.5, 0.5]);

function refused(step, code, place) {
  assert.throws(step, error => {
    assert.ok(error instanceof PdepthError, String(error));
    assert.deepEqual([error.code, error.place], [code, place]);
    assert.ok(error.message.startsWith(`${code}: `));
    return true;
  });
}

test('a depth, a distance and a touch', () => {
  const found = pdepth.depth(cube, null, cube, [0.75, 0, 0]);
  assert.equal(found.contact, 'overlapping');
  assert.deepEqual([found.depth, found.lower, found.upper], [0.25, 0.25, 0.25]);
  assert.deepEqual(found.translation, [-0.25, 0, 0]);
  assert.deepEqual(found.witnessB.map((x, i) => x - found.witnessA[i]), found.translation);
  assert.equal(pdepth.depth(cube, null, cube, [1, 0, 0]).contact, 'touching');
  const apart = pdepth.depth(cube, null, cube, [3, 0, 0]);
  assert.deepEqual([apart.contact, apart.distance, apart.depth], ['separated', 2, 0]);
  assert.equal(pdepth.version(), JSON.parse(readFileSync('node_modules/pdepth/package.json', 'utf8')).version);
});

test('poses in every form mean the same', () => {
  const half = Math.SQRT1_2;
  const forms = [{position: [1, 2, 3], quaternion: [0, 0, half, half]}, [1, 2, 3, 0, 0, half, half], Float64Array.of(1, 2, 3, 0, 0, half, half),
                 {position: [1, 2, 3], matrix: [0, -1, 0, 1, 0, 0, 0, 0, 1]}, [1, 2, 3, 0, -1, 0, 1, 0, 0, 0, 0, 1]];
  for (const pose of forms) {
    const {point} = pdepth.support(new Box([1, 2, 3]), pose, [1, 0, 0]);
    assert.ok(Math.abs(point[0] - 3) < 1e-15, String(point));
  }
  refused(() => pdepth.depth(cube, [1, 2], cube, null), 'bad_value', 'poseA');
  refused(() => pdepth.depth(cube, null, cube, {quaternion: [0, 0, 0, 2]}), 'not_a_rotation', 'poseB.quaternion');
  refused(() => pdepth.depth(cube, {position: [0, NaN, 0]}, cube, null), 'non_finite', 'poseA.position[1]');
});

test('shapes, and what they are made of', () => {
  assert.deepEqual(cube.describe(), {isConvex: true, parts: 1, dimension: 3, vertices: 8, facets: 6, margin: 0});
  const hull = new Convex(Float32Array.of(0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0.1, 0.1, 0.1));
  assert.equal(hull.describe().vertices, 4);
  const faced = new Convex([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]);
  assert.equal(faced.describe().facets, 4);
  const {points, offsets, corners} = cube.surface();
  assert.deepEqual([points.length, offsets.length, corners.length], [24, 7, 24]);
  const swept = new Convex([[0, 0, 0], [0, 0, 2]]).withMargin(0.5);
  const capsule = new Capsule(0.5, 1, 'z');
  assert.equal(pdepth.depth(swept, null, cube, [1, 0, 1]).distance, 0);
  assert.equal(pdepth.depth(capsule, [0, 0, 1], cube, [0.75, 0, 1]).depth, pdepth.depth(swept, null, cube, [0.75, 0, 1]).depth);
  const tall = new Compound([{shape: cube}, {shape: cube, pose: [0, 0, 1]}]);
  assert.equal(tall.describe(1).parts, 2);
  assert.equal(pdepth.depth(tall, null, cube, [0, 0, 1.75]).depth, 0.25);
  assert.equal(new Halfspaces([1, 0, 0, 1, -1, 0, 0, 1, 0, 1, 0, 1, 0, -1, 0, 1, 0, 0, 1, 1, 0, 0, -1, 1]).describe().vertices, 8);
  assert.equal(new HullOfSpheres([[0, 0, 0, 1]]).describe().isConvex, true);
});

/** The surface of unit cells at whole numbers, as squares. */
function cellMesh(cells) {
  const points = [], faces = [], ids = new Map(), has = new Set(cells.map(String));
  const vertex = at => { if (!ids.has(String(at))) ids.set(String(at), points.push(at) - 1); return ids.get(String(at)); };
  for (const cell of cells) {
    for (const axis of [0, 1, 2]) {
      for (const side of [0, 1]) {
        if (has.has(String(cell.map((x, k) => k === axis ? x + 2 * side - 1 : x)))) continue;
        const loop = [[0, 0], [1, 0], [1, 1], [0, 1]].map(([u, v]) => vertex(cell.map((x, k) => x + (k === axis ? side : k === (axis + 1) % 3 ? u : v))));
        faces.push(side === 1 ? loop : loop.reverse());
      }
    }
  }
  return {points, faces};
}
const ring = cellMesh([[0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 1, 0], [2, 1, 0], [0, 2, 0], [1, 2, 0], [2, 2, 0]]);

test('solids of meshes', () => {
  const solid = new Solid(ring.points, ring.faces), peg = new Box([0.25, 0.25, 2]);
  assert.deepEqual([pdepth.depth(solid, null, peg, [1.5, 1.5, 0]).contact, pdepth.depth(solid, null, peg, [1.5, 1.5, 0]).distance], ['separated', 0.25]);
  const deep = pdepth.depth(solid, null, peg, [1.125, 1.5, 0]);
  assert.ok(deep.lower <= 0.125 && deep.upper >= 0.125 && deep.upper - deep.lower < 0.002, JSON.stringify(deep));
  const stands = pdepth.depth(solid, null, cube, [0.5, 0.5, 1.5]);
  assert.deepEqual([stands.contact, stands.featureA.kind, stands.featureA.part], ['touching', 'facet', 'mesh']);
  assert.ok(solid.pointsOf(stands.featureA).length === 4 && solid.pointsOf(stands.featureA).every(v => ring.points[v][2] === 1));
  const mesh = solid.surface('mesh');
  assert.deepEqual([mesh.points.length, mesh.corners.length, solid.describe('mesh').facets], [3 * ring.points.length, 6 * ring.faces.length, 2 * ring.faces.length]);
  assert.ok(solid.describe().parts > 1 && !solid.describe().isConvex);
  assert.equal(pdepth.depth(solid, null, new Sphere(0.5), [1.5, 1.5, 0.5]).contact, 'touching');  // asked by its parts
  assert.ok(Math.abs(pdepth.depth(solid.withMargin(0.125), null, peg, [1.5, 1.5, 0]).distance - 0.125) < 1e-12);
  assert.equal(pdepth.depth(new Compound([{shape: solid, pose: [0, 0, 5]}]), null, cube, [0.5, 0.5, 4.75]).depth, 0.25);
  assert.equal(pdepth.depthBatch({a: solid, b: [cube, peg], posesB: [[0.5, 0.5, 1.5], [1.5, 1.5, 0]], formB: 'position'}).distance[1], 0.25);
  const triangles = new Uint32Array(ring.faces.flatMap(([a, b, c, d]) => [a, b, c, a, c, d]));
  assert.equal(pdepth.depth(new Solid(ring.points, triangles), null, peg, [1.5, 1.5, 0]).distance, 0.25);
  assert.throws(() => new Solid(ring.points, ring.faces.slice(1)), {code: 'not_closed', message: /open_edge/});
  const inside = ring.faces.map(loop => [...loop].reverse());
  assert.throws(() => new Solid(ring.points, inside), {code: 'bad_faces', message: /inside_out/});
  assert.equal(new Solid(ring.points, inside, {turnFaces: true}).describe('mesh').vertices, ring.points.length);
  refused(() => new Solid(ring.points, inside, {turn: true}), 'bad_value', 'options.turn');
  refused(() => new Solid(ring.points.map((p, i) => i === 4 ? [0, NaN, 0] : p), ring.faces), 'non_finite', 'points[4]');
  refused(() => new Solid(ring.points, [[0, 1, 0.5]]), 'bad_value', 'faces[0]');
  refused(() => new Solid(ring.points, [[0, 1, 2], [0, 1, 99]]), 'bad_faces', 'faces[1]');
  refused(() => new Solid([], [[0, 1, 2]]), 'bad_faces', 'faces[0]');
  refused(() => new Solid([], []), 'too_few_points', 'points');
  refused(() => new Convex([[0, NaN, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]), 'non_finite', 'points[0]');
  refused(() => new Compound([{shape: cube, pose: [NaN, 0, 0]}]), 'non_finite', 'parts[0].pose.position[0]');
  refused(() => new Solid(ring.points, new Uint16Array(4)), 'bad_value', 'faces');
  refused(() => pdepth.manifold(solid, null, cube, null), 'unsupported', 'a');
  refused(() => cube.describe('mesh'), 'out_of_range', 'part');
  solid.free();
  refused(() => pdepth.depth(solid, null, cube, null), 'freed', 'a');
});
test('lines of the protocol', async () => {
  const ask = async line => JSON.parse(await pdepth.query(typeof line === 'string' ? line : JSON.stringify(line)));
  const box = {type: 'box', half_extents: [0.5, 0.5, 0.5]};
  const line = {id: 7, query: 'depth', a: box, b: box, pose_b: {translation: [0.75, 0, 0]}};
  const found = await ask(line);
  assert.deepEqual([found.id, found.class, found.depth, found.translation], [7, 'overlapping', 0.25, [-0.25, 0, 0]]);
  const square = {outer: [[0, 0], [1, 0], [1, 1], [0, 1]]};
  assert.equal((await ask({query: 'polygon_depth', p: square, q: square})).depth, 1);
  assert.equal((await ask({query: 'width', a: box})).width, 1);
  assert.equal((await ask('{"query":')).error.code, 'bad_json');
  assert.equal((await ask({query: 'depth', a: {type: 'mesh', path: '/etc/passwd'}, b: box})).error.code, 'unreadable_file');
  assert.equal((await ask({query: 'depth', a: {type: 'box', half_extents: [1, null, 1]}, b: box})).error.where, 'a.half_extents[1]');
  assert.equal((await ask('['.repeat(100000))).error.code, 'limit_exceeded');
  await assert.rejects(pdepth.query(7), {code: 'bad_value', place: 'line'});
  assert.equal((await ask(line)).depth, 0.25);
});

test('wrong input is refused by name and place', () => {
  refused(() => new Convex(Float64Array.of(0, 0, 0, 1, NaN, 0)), 'non_finite', 'points[1]');
  refused(() => new Convex([[0, 0, 0], [1, 0]]), 'bad_value', 'points[1]');
  refused(() => new Convex([0, 1]), 'bad_value', 'points');
  refused(() => new Convex([[0, 0, 'x']]), 'bad_value', 'points[0][2]');
  refused(() => new Convex([]), 'too_few_points', 'points');
  refused(() => new Convex([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 1, 2]]), 'not_closed', 'faces[0]');
  refused(() => new Box([1, -1, 1]), 'bad_value', 'halfExtents[1]');
  refused(() => new Sphere(undefined), 'bad_value', 'radius');
  refused(() => new Capsule(1, 1, 'w'), 'bad_value', 'axis');
  refused(() => new Shape(), 'bad_value', '');
  refused(() => pdepth.depth({}, null, cube, null), 'bad_value', 'a');
  refused(() => pdepth.depth(cube, null, cube, null, {brackets: 1}), 'bad_value', 'settings.brackets');
  refused(() => pdepth.depth(cube, null, cube, null, {bracket: 'wide'}), 'bad_value', 'settings.bracket');
  refused(() => pdepth.depth(cube, null, cube, null, {delta: 2}), 'bad_value', 'settings.delta');
  refused(() => pdepth.depthAlong(cube, null, cube, null, [0, 0, 0]), 'zero_direction', 'direction');
  refused(() => new Cone(1, 1).surface(), 'unsupported', 'part');
  const corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]];
  refused(() => new Convex(corners, [[0, 2, 1.5]]), 'bad_value', 'faces[0]');
  refused(() => new Convex(corners, null), 'bad_value', 'faces');
  refused(() => new Convex(BigInt64Array.of(0n, 0n, 0n)), 'bad_value', 'points[0]');
  refused(() => pdepth.depth(cube, {translation: [9, 0, 0]}, cube, null), 'bad_value', 'poseA.translation');
  refused(() => pdepth.depth(cube, null, cube, null, {seed: 0.5}), 'bad_value', 'settings.seed');
  refused(() => pdepth.depthBatch({a: cube, b: cube, count: -1}), 'bad_value', 'count');
  refused(() => pdepth.depthBatch({a: cube, b: cube, count: 2 ** 28}), 'out_of_memory', '');
  assert.equal(pdepth.depth(cube, null, cube, null).depth, 1);  // the library lives on
});

test('no number and no other object is taken for a shape, a pair or settings', () => {
  refused(() => new Shape(12345), 'bad_value', '');
  refused(() => new (class extends Shape { constructor() { super(16); } })(), 'bad_value', '');
  for (const pair of [cube, {}, 'x', 0]) refused(() => pdepth.depth(cube, null, cube, null, {pair}), 'bad_value', 'pair');
  for (const options of ['contact', 3, true]) refused(() => pdepth.depth(cube, null, cube, null, options), 'bad_value', 'options');
  refused(() => pdepth.timeOfImpact(cube, null, cube, [5, 0, 0]), 'bad_value', 'movement');
  refused(() => pdepth.timeOfImpact(cube, null, cube, [5, 0, 0], {a: 3, duration: 1}), 'bad_value', 'movement.a');
  refused(() => pdepth.depthBatch({a: cube, b: cube, poseA: [5, 0, 0]}), 'bad_value', 'batch.poseA');
  refused(() => pdepth.depthBatch(), 'bad_value', 'a');
  refused(() => pdepth.depthBatch({a: cube, b: cube, posesA: [1, 2, 3], formA: 'constructor'}), 'bad_value', 'formA');
  refused(() => new Cone(1, 1, 'constructor'), 'bad_value', 'axis');
  refused(() => cube.pointsOf(), 'bad_value', 'feature');
  refused(() => cube.pointsOf({kind: 'vertex', part: 0, first: 'a'}), 'bad_value', 'feature.first');
});

test('use after free is an error, and a second free is none', () => {
  const box = new Box([1, 1, 1]), pair = new Pair();
  const compound = new Compound([{shape: box}]);
  box.free();
  box[Symbol.dispose ?? Symbol.for('Symbol.dispose')]();
  assert.equal(box.freed, true);
  refused(() => pdepth.depth(cube, null, box, null), 'freed', 'b');
  refused(() => box.describe(), 'freed', 'shape');
  refused(() => pdepth.depthBatch({a: [cube, box], b: cube}), 'freed', 'a[1]');
  assert.equal(pdepth.depth(compound, null, cube, [1, 0, 0]).depth, 0.5);  // it owns its parts
  pair.free();
  refused(() => pdepth.depth(cube, null, cube, null, {pair}), 'freed', 'pair');
});

test('the other queries', () => {
  assert.equal(pdepth.apart(cube, null, cube, [3, 0, 0], 1.5), true);
  assert.equal(pdepth.apart(cube, null, cube, [3, 0, 0], 2.5), false);
  assert.equal(pdepth.depthAlong(cube, null, cube, null, [0, 2, 0]).depth, 1);
  const {points, normal} = pdepth.manifold(cube, [0, 0, 0.75], cube, null);
  assert.deepEqual([points.length, normal], [4, [0, 0, 1]]);
  assert.ok(points.every(point => point.depth === 0.25 && typeof point.featureId === 'bigint'));
  const impact = pdepth.timeOfImpact(cube, null, cube, [3, 0, 0], {a: {linearVelocity: [1, 0, 0]}, duration: 5});
  assert.ok(impact.hit && Math.abs(impact.time - 2) < 1e-8 && impact.certified <= 2);
  assert.equal(pdepth.width(new Box([1, 2, 3])).width, 2);
  const slope = pdepth.derivatives(cube, null, cube, [0.75, 0, 0]);
  assert.deepEqual(slope.byA.slice(0, 3).map(x => x + 0), [1, 0, 0]);
  const found = pdepth.depth(cube, [0, 0, 1.25], new Convex([[0, 0, 1], [1, 0, 0], [0, 1, 0], [-1, -1, 0]]), null);
  assert.equal(found.featureB.kind, 'vertex');
  assert.deepEqual(new Convex([[0, 0, 1], [1, 0, 0], [0, 1, 0], [-1, -1, 0]]).pointsOf(found.featureB), [0]);
});

test('a memory of a pair changes no answer', () => {
  const pair = new Pair(), gem = new Convex(Array.from({length: 60}, (_, i) => [Math.sin(i * i), Math.cos(3 * i * i), Math.sin(7 * i)]));
  for (let i = 0; i < 20; ++i) {
    const pose = [0.3 + 0.01 * i, 0.2, 0.1];
    const warm = pdepth.depth(gem, null, gem, pose, {pair}), cold = pdepth.depth(gem, null, gem, pose);
    assert.deepEqual([warm.depth, warm.lower, warm.upper, warm.contact], [cold.depth, cold.lower, cold.upper, cold.contact]);
  }
  pair.clear();
});

test('batches are the single answers, in columns', () => {
  const n = 1000, poses = new Float64Array(3 * n);
  for (let i = 0; i < n; ++i) poses[3 * i] = 0.002 * i;
  const found = pdepth.depthBatch({a: cube, b: cube, posesB: poses, formB: 'position'});
  assert.equal(found.count, n);
  assert.equal(found.error, null);
  for (const i of [0, 1, 250, 500, 501, 999]) {
    const single = pdepth.depth(cube, null, cube, poses.subarray(3 * i, 3 * i + 3));
    assert.deepEqual([found.depth[i], found.distance[i]], [single.depth, single.distance]);
    assert.deepEqual(Array.from(found.translation.subarray(3 * i, 3 * i + 3)), single.translation);
  }
  poses[3 * 17 + 1] = NaN;
  const partly = pdepth.depthBatch({a: cube, b: cube, posesB: poses, formB: 'position'});
  assert.deepEqual([partly.error.code, partly.error.place], ['non_finite', 'rows[17].poseB.position[1]']);
  assert.ok(partly.status[17] !== 0 && Number.isNaN(partly.depth[17]) && partly.depth[18] === found.depth[18]);
  assert.equal(pdepth.depthBatch({a: [cube, cube], b: [cube, cube]}).count, 2);
  assert.equal(pdepth.depthBatch({a: [], b: cube}).count, 0);
  refused(() => pdepth.depthBatch({a: [cube, cube], b: [cube]}), 'bad_value', 'count');
  refused(() => pdepth.depthBatch({a: cube, b: cube, posesB: [1, 2, 3, 4]}), 'bad_value', 'posesB');
});

test('memory grows and comes back', () => {
  const hulls = Array.from({length: 100}, (_, k) => new Convex(Float64Array.from({length: 900}, (_, i) => Math.sin(1 + i * (k + 1)))));
  for (const hull of hulls) assert.ok(pdepth.depth(hull, null, cube, [0.5, 0, 0]).depth > 0);
  for (const hull of hulls) hull.free();
  const rows = 80000, poses = new Float64Array(3 * rows).fill(0.25);
  assert.equal(pdepth.depthBatch({a: cube, b: cube, posesA: poses, formA: 'position'}).depth[rows - 1], 0.75);
});

test('the same in a worker', async () => {
  const answer = await new Promise((resolve, reject) => {
    const worker = new Worker(new URL('worker.mjs', import.meta.url));
    worker.once('message', resolve);
    worker.once('error', reject);
  });
  assert.deepEqual(answer, {depth: pdepth.depth(cube, null, cube, [0.75, 0, 0]), refusal: null});
});

test('the smaller module answers for convex bodies with the same bits, and refuses compounds by name', async () => {
  const answers = await new Promise((resolve, reject) => {
    const worker = new Worker(new URL('worker.mjs', import.meta.url), {workerData: 'pdepth/convex'});
    worker.once('message', resolve);
    worker.once('error', reject);
  });
  assert.deepEqual(answers.depth, pdepth.depth(cube, null, cube, [0.75, 0, 0]));
  assert.deepEqual(answers.refusal, ['unsupported', 'parts']);
});

test('the single file, and the module without a loader', async () => {
  const single = await import('pdepth/single');
  assert.equal(single.depth(new single.Box([1, 1, 1]), null, new single.Sphere(1), [1.5, 0, 0]).depth, 0.5);
  assert.equal(typeof globalThis.pdepth.depth, 'function');
  await assert.rejects(single.query('{}'), {code: 'unsupported', place: 'line'});
  const core = await import(`${pathToFileURL(createRequire(import.meta.url).resolve('pdepth/core'))}?again`);
  assert.throws(() => new core.Sphere(1), {code: 'not_ready'});
});

test('the types name what the module exports', () => {
  const types = readFileSync('node_modules/pdepth/index.d.ts', 'utf8');
  const declared = new Set([...types.matchAll(/^export (?:abstract )?(?:class|function|const) (\w+)/gm)].map(found => found[1]));
  assert.deepEqual([...declared].sort(), Object.keys(pdepth).sort());
  // Compilers that resolve modules as Node 10 did look for the types of a folder's modules here.
  const {exports, typesVersions} = JSON.parse(readFileSync('node_modules/pdepth/package.json', 'utf8'));
  const typed = Object.keys(exports).filter(name => exports[name].types && name !== '.').map(name => name.slice(2));
  assert.deepEqual(Object.keys(typesVersions['*']).sort(), typed.sort());
});

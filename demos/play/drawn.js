// Bodies and their difference become triangles and edges here, for drawing alone. No answer uses them.

/** Makes directions of a sphere with their triangles: an icosahedron, each triangle cut into four `level` times. */
function sphereMesh(level) {
  const points = [], triangles = [];
  for (const s of [-1, 1]) for (const t of [-1, 1]) points.push([0, s, t * golden], [s, t * golden, 0], [t * golden, 0, s]);
  const near = (i, j) => i !== j && length(minus(points[i], points[j])) < 2.1;
  for (let i = 0; i < 12; ++i) for (let j = 0; j < 12; ++j) for (let k = 0; k < 12; ++k) {
    const outside = dot(points[i], cross(points[j], points[k])) > 0;
    if (i < j && i < k && outside && near(i, j) && near(j, k) && near(k, i)) triangles.push([i, j, k]);
  }
  let current = triangles;
  for (let step = 0; step < level; ++step) {
    const middles = new Map();
    const middle = (i, j) => {
      const key = i < j ? `${i},${j}` : `${j},${i}`;
      if (!middles.has(key)) middles.set(key, points.push(add(points[i], points[j])) - 1);
      return middles.get(key);
    };
    current = current.flatMap(([i, j, k]) => {
      const a = middle(i, j), b = middle(j, k), c = middle(k, i);
      return [[i, a, c], [j, b, a], [k, c, b], [a, b, c]];
    });
  }
  return {directions: points.map(p => times(1 / length(p), p)), triangles: current};
}
const kFine = sphereMesh(4), kCoarse = sphereMesh(3);

/** Returns facets as points and loops; `exact` is true if they are the body's own. */
function surfaceOf(shape, part = 0) {
  const {points, offsets, corners} = shape.surface(part);
  const rows = Array.from({length: points.length / 3}, (_, i) => [points[3 * i], points[3 * i + 1], points[3 * i + 2]]);
  const loops = Array.from({length: offsets.length - 1}, (_, f) => Array.from(corners.slice(offsets[f], offsets[f + 1])));
  return {points: rows, loops, exact: true};
}
/** Makes equal points one, so that edges find both of their facets. */
function welded({points, loops}) {
  const first = new Map(), number = points.map((p, i) => {
    const key = p.join();
    if (!first.has(key)) first.set(key, i);
    return first.get(key);
  });
  return {points, loops: loops.map(loop => loop.map(v => number[v])), exact: true};
}
function leafSurface(shape) {
  const about = shape.describe();
  if (about.facets > 0 && about.margin === 0) return surfaceOf(shape);
  return {points: kFine.directions.map(d => pdepth.support(shape, null, d).point), loops: kFine.triangles, exact: false};
}
/** Makes the surfaces of a body's parts, in the body's frame. */
function eyeOf(body) {
  return body.parts.map(leaf => {
    const swept = body.margin ? leaf.shape.withMargin(body.margin) : leaf.shape;
    const found = leafSurface(swept);
    if (swept !== leaf.shape) swept.free();
    const m = rotationOf(leaf.pose);
    return {...found, points: found.points.map(p => add(turned(m, p), leaf.pose.t))};
  });
}
/**
 * Finds the edges between facets that meet at an angle. Points of a difference and of an overlap are rounded, so that a facet falls into several
 * that are nearly coplanar, with slivers between them; these are no edges for the eye.
 */
function edgesOf({points, loops}) {
  const beside = new Map(), size = greatestLength(points);
  for (const loop of loops) {
    const n = cross(minus(points[loop[1]], points[loop[0]]), minus(points[loop[loop.length - 1]], points[loop[0]]));
    if (length(n) < 1e-9 * size * size) continue;
    const unitNormal = times(1 / length(n), n);
    loop.forEach((v, i) => {
      const w = loop[(i + 1) % loop.length], key = v < w ? `${v},${w}` : `${w},${v}`;
      if (!beside.has(key)) beside.set(key, {ends: [points[v], points[w]], normals: []});
      beside.get(key).normals.push(unitNormal);
    });
  }
  const ends = [];
  for (const {ends: pair, normals} of beside.values()) {
    if (normals.length < 2 || dot(normals[0], normals[1]) < 1 - 1e-6) ends.push(...pair);
  }
  return ends;
}
function normalOf(points, loop) {
  const n = cross(minus(points[loop[1]], points[loop[0]]), minus(points[loop[2]], points[loop[0]]));
  return times(1 / (length(n) || 1), n);
}

/** Makes the pieces of B + (-A) for bodies that are turned and not moved: one for each pair of parts. */
function differenceOf(a, b, turnA, turnB) {
  const pieces = [];
  for (const [i, eyeA] of a.eye.entries()) {
    for (const [j, eyeB] of b.eye.entries()) {
      if (pieces.length >= 120) return pieces;
      const exact = eyeA.exact && eyeB.exact && eyeA.points.length * eyeB.points.length <= 3000;
      const parts = [a.body.parts[i], b.body.parts[j]], spread = (a.body.margin ?? 0) + (b.body.margin ?? 0);
      pieces.push(exact ? exactPiece(eyeA, eyeB, turnA, turnB) : sampledPiece(parts, [turnA, turnB], spread));
    }
  }
  return pieces;
}
function exactPiece(eyeA, eyeB, turnA, turnB) {
  const ofA = eyeA.points.map(p => turned(turnA, p)), ofB = eyeB.points.map(p => turned(turnB, p));
  const rows = new Float64Array(3 * ofA.length * ofB.length);
  let k = 0;
  for (const p of ofA) for (const q of ofB) { rows[k++] = q[0] - p[0]; rows[k++] = q[1] - p[1]; rows[k++] = q[2] - p[2]; }
  const hull = new pdepth.Convex(rows);
  const piece = surfaceOf(hull);
  hull.free();
  const facing = (eye, turn, sign) => eye.loops.map(loop => times(sign, turned(turn, normalOf(eye.points, loop))));
  const normalsA = facing(eyeA, turnA, -1), normalsB = facing(eyeB, turnB, 1);
  const among = (normals, n) => normals.some(m => dot(m, n) > 1 - 1e-9);
  piece.kinds = piece.loops.map(loop => {
    const n = normalOf(piece.points, loop);
    return among(normalsB, n) ? 1 : among(normalsA, n) ? 0 : 2;
  });
  return piece;
}
function sampledPiece(parts, turns, spread) {
  const far = (k, d) => turned(turns[k], pdepth.support(parts[k].shape, libraryPose(parts[k].pose), turnedBack(turns[k], d)).point);
  const points = kCoarse.directions.map(d => add(minus(far(1, d), far(0, times(-1, d))), times(spread, d)));
  return {points, loops: kCoarse.triangles, exact: false, kinds: kCoarse.triangles.map(() => 3)};
}

/** Finds the solids that two bodies share, for pairs of polytopes up to a size that is quick. */
function overlapOf(a, b) {
  const solids = [];
  const planes = (eye, turn, t) => eye.loops.map(loop => {
    const n = turned(turn, normalOf(eye.points, loop));
    return [...n, dot(n, add(turned(turn, eye.points[loop[0]]), t))];
  });
  const turnA = rotationOf(a.pose), turnB = rotationOf(b.pose);
  for (const eyeA of a.eye) {
    for (const eyeB of b.eye) {
      if (!eyeA.exact || !eyeB.exact || eyeA.loops.length + eyeB.loops.length > 150 || solids.length > 30) continue;
      try {
        const solid = new pdepth.Halfspaces([...planes(eyeA, turnA, a.pose.t), ...planes(eyeB, turnB, b.pose.t)]);
        solids.push(surfaceOf(solid));
        solid.free();
      } catch (error) {
        if (!(error instanceof PdepthError)) throw error;  // parts that share nothing
      }
    }
  }
  return solids;
}

/** Returns the distance of the nearest triangle that a ray meets; Infinity for none. */
function rayMeets(origin, way, {skin, pose}) {
  const m = rotationOf(pose), o = turnedBack(m, minus(origin, pose.t)), d = turnedBack(m, way);
  let nearest = Infinity;
  for (const {points, loops} of skin) {
    for (const loop of loops) {
      for (let i = 2; i < loop.length; ++i) {
        const p = points[loop[0]], u = minus(points[loop[i - 1]], p), v = minus(points[loop[i]], p);
        const h = cross(d, v), det = dot(u, h);
        if (Math.abs(det) < 1e-300) continue;
        const s = minus(o, p), x = dot(s, h) / det, q = cross(s, u), y = dot(d, q) / det, t = dot(v, q) / det;
        if (x >= 0 && y >= 0 && x + y <= 1 && t > 0) nearest = Math.min(nearest, t);
      }
    }
  }
  return nearest;
}

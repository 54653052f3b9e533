// Polygons of the plane: outlines are checked, thinned and cut into convex pieces. The pieces become prisms so tall that the shortest way
// out lies in the plane.

const turnOf = (p, q, r) => (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
const areaOf = ring => ring.reduce((sum, p, i) => { const q = ring[(i + 1) % ring.length]; return sum + p[0] * q[1] - p[1] * q[0]; }, 0) / 2;

/** Tells if two edges of a ring that are not neighbours meet. */
function crossesItself(ring) {
  const n = ring.length;
  const between = (p, q, r) => Math.min(p[0], q[0]) <= r[0] && r[0] <= Math.max(p[0], q[0]) && Math.min(p[1], q[1]) <= r[1] && r[1] <= Math.max(p[1], q[1]);
  for (let i = 0; i < n; ++i) {
    for (let k = i + 2; k < n; ++k) {
      if (i === 0 && k === n - 1) continue;
      const [p, q, r, s] = [ring[i], ring[i + 1], ring[k], ring[(k + 1) % n]];
      const [a, b, c, d] = [turnOf(p, q, r), turnOf(p, q, s), turnOf(r, s, p), turnOf(r, s, q)];
      if (a * b < 0 && c * d < 0) return true;
      if ((a === 0 && between(p, q, r)) || (b === 0 && between(p, q, s)) || (c === 0 && between(r, s, p)) || (d === 0 && between(r, s, q))) return true;
    }
  }
  return false;
}

/** Returns the ring with its points against the clock, without repeated points and points on straight edges. */
function cleanRing(points, place) {
  let ring = points.filter((p, i) => { const q = points[(i + 1) % points.length]; return p[0] !== q[0] || p[1] !== q[1]; });
  ring = ring.filter((p, i) => turnOf(ring[(i + ring.length - 1) % ring.length], p, ring[(i + 1) % ring.length]) !== 0);
  if (ring.length < 3) refuse('too_few_points', 'a polygon has at least 3 corners', place);
  if (ring.length > kMostCorners) refuse('limit_exceeded', `a polygon has at most ${kMostCorners} corners here; give it to pdepth polygon`, place);
  if (crossesItself(ring)) refuse('bad_faces', 'the outline crosses itself', place);
  return areaOf(ring) < 0 ? ring.reverse() : ring;
}
const kMostCorners = 60;

/** Cuts a ring into triangles by cutting off ears, and joins them to convex pieces across the edges that they share. */
function convexPieces(ring) {
  const left = ring.map((_, i) => i), pieces = [];
  while (left.length > 3) {
    const n = left.length;
    const ear = left.findIndex((j, at) => {
      const i = left[(at + n - 1) % n], k = left[(at + 1) % n];
      if (turnOf(ring[i], ring[j], ring[k]) <= 0) return false;
      return !left.some(v => v !== i && v !== j && v !== k && turnOf(ring[i], ring[j], ring[v]) >= 0 && turnOf(ring[j], ring[k], ring[v]) >= 0 && turnOf(ring[k], ring[i], ring[v]) >= 0);
    });
    if (ear < 0) refuse('bad_faces', 'the outline touches itself', 'polygon');
    pieces.push([left[(ear + n - 1) % n], left[ear], left[(ear + 1) % n]]);
    left.splice(ear, 1);
  }
  pieces.push(left);
  for (let i = 0; i < pieces.length; ++i) {
    for (let k = i + 1; k < pieces.length; ++k) {
      const joined = joinedPiece(ring, pieces[i], pieces[k]);
      if (!joined) continue;
      pieces[i] = joined;
      pieces.splice(k, 1);
      k = i;  // the larger piece may take others that it could not take before
    }
  }
  return pieces.map(piece => piece.map(v => ring[v]));
}
function joinedPiece(ring, a, b) {
  for (let i = 0; i < a.length; ++i) {
    const k = b.indexOf(a[(i + 1) % a.length]);
    if (k < 0 || b[(k + 1) % b.length] !== a[i]) continue;
    const rest = Array.from({length: b.length - 2}, (_, j) => b[(k + 2 + j) % b.length]);
    const whole = [...a.slice(0, i + 1), ...rest, ...a.slice(i + 1)], n = whole.length;
    return whole.every((v, j) => turnOf(ring[whole[(j + n - 1) % n]], ring[v], ring[whole[(j + 1) % n]]) > 0) ? whole : null;
  }
  return null;
}

/** Leaves out points of a drawn line that lie within `reach` of the line through those that stay. */
function simplified(points, reach) {
  if (points.length < 3) return points;
  const [p, q] = [points[0], points[points.length - 1]];
  const long = Math.hypot(q[0] - p[0], q[1] - p[1]);
  let farthest = 0, most = -1;
  for (let i = 1; i + 1 < points.length; ++i) {
    const off = long > 0 ? Math.abs(turnOf(p, q, points[i])) / long : Math.hypot(points[i][0] - p[0], points[i][1] - p[1]);
    if (off > most) [farthest, most] = [i, off];
  }
  if (most <= reach) return [p, q];
  return [...simplified(points.slice(0, farthest + 1), reach).slice(0, -1), ...simplified(points.slice(farthest), reach)];
}

// Rotations as quaternions x, y, z, w, and vectors as arrays.
const add = (u, v) => [u[0] + v[0], u[1] + v[1], u[2] + v[2]];
const minus = (u, v) => [u[0] - v[0], u[1] - v[1], u[2] - v[2]];
const times = (s, v) => [s * v[0], s * v[1], s * v[2]];
const dot = (u, v) => u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
const cross = (u, v) => [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
const length = v => Math.hypot(...v);
const greatestLength = points => points.reduce((most, p) => Math.max(most, length(p)), 0);  // a call takes too few arguments for a large hull

function product(p, q) {
  const [a, b, c, d] = p, [x, y, z, w] = q;
  const r = [d * x + a * w + b * z - c * y, d * y - a * z + b * w + c * x, d * z + a * y - b * x + c * w, d * w - a * x - b * y - c * z];
  const n = Math.hypot(...r);
  return r.map(t => t / n);
}
function aboutAxis(axis, angle) {
  const n = length(axis);
  if (!(n > 0)) return [0, 0, 0, 1];
  const s = Math.sin(angle / 2) / n;
  return [axis[0] * s, axis[1] * s, axis[2] * s, Math.cos(angle / 2)];
}
/** The matrix of a quaternion, by rows. */
function matrixOf([x, y, z, w]) {
  return [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w), 2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w),
          2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)];
}
function quaternionOf(m) {
  const squares = [1 + m[0] - m[4] - m[8], 1 - m[0] + m[4] - m[8], 1 - m[0] - m[4] + m[8], 1 + m[0] + m[4] + m[8]];
  const xy = m[1] + m[3], xz = m[2] + m[6], yz = m[5] + m[7], xw = m[7] - m[5], yw = m[2] - m[6], zw = m[3] - m[1];
  // Row k is 4 q_k times the quaternion q; the row of the largest q_k is never zero, whatever the turn.
  const rows = [[squares[0], xy, xz, xw], [xy, squares[1], yz, yw], [xz, yz, squares[2], zw], [xw, yw, zw, squares[3]]];
  return product(rows[squares.indexOf(Math.max(...squares))], [0, 0, 0, 1]);
}
const turned = (m, v) => [m[0] * v[0] + m[1] * v[1] + m[2] * v[2], m[3] * v[0] + m[4] * v[1] + m[5] * v[2], m[6] * v[0] + m[7] * v[1] + m[8] * v[2]];
const turnedBack = (m, v) => [m[0] * v[0] + m[3] * v[1] + m[6] * v[2], m[1] * v[0] + m[4] * v[1] + m[7] * v[2], m[2] * v[0] + m[5] * v[1] + m[8] * v[2]];
const multiplied = (m, n) => {
  const columns = [0, 1, 2].map(k => turned(m, [n[k], n[k + 3], n[k + 6]]));
  return [0, 1, 2].flatMap(i => columns.map(c => c[i]));
};

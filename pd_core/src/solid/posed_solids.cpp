#include "solid/posed_solids.hpp"

#include <algorithm>
#include <cmath>

#include "numeric/double_double.hpp"
#include "numeric/unit_roundoff.hpp"
#include "pd/numeric/predicates.hpp"

namespace pd::detail {

namespace {

int sign_of(double value) { return (value > 0) - (value < 0); }

/// Entries 0 and +-1, one in each row.
bool exchanges_axes(const Pose& pose) {
  if (pose.is_quaternion()) {
    const auto& q = pose.quaternion_wxyz();
    if (std::count(q.begin(), q.end(), 0.0) != 3) return false;
  }
  for (int i = 0; i < 3; ++i) {
    int ones = 0;
    for (int j = 0; j < 3; ++j) {
      const double entry = std::abs(pose.rotation()(i, j));
      if (entry != 0 && entry != 1) return false;
      ones += entry == 1;
    }
    if (ones != 1) return false;
  }
  return true;
}

double largest_coordinate(const MeshSolid& solid) {
  const TriangleNode& root = solid.nodes().front();
  return std::max(root.low.cwiseAbs().maxCoeff(), root.high.cwiseAbs().maxCoeff());
}

}  // namespace

Pose placed_at(const Pose& pose, const Vec3& translation) {
  return pose.is_quaternion() ? *Pose::from_quaternion(pose.quaternion_wxyz(), translation)
                              : Pose::from_trusted_matrix(pose.rotation(), translation);
}

void rotation_numerators(const Pose& pose, std::array<Dyadic, 9>& rotation, Dyadic& denominator) {
  if (!pose.is_quaternion()) {
    for (int i = 0; i < 9; ++i) rotation[static_cast<std::size_t>(i)] = Dyadic(pose.rotation()(i / 3, i % 3));
    denominator = Dyadic(1.0);
    return;
  }
  const auto& q = pose.quaternion_wxyz();
  const Dyadic w(q[0]), x(q[1]), y(q[2]), z(q[3]), two(2.0);
  const Dyadic ww = w * w, xx = x * x, yy = y * y, zz = z * z;
  const Dyadic xy = x * y, xz = x * z, yz = y * z, wx = w * x, wy = w * y, wz = w * z;
  rotation = {ww + xx - yy - zz, two * (xy - wz), two * (xz + wy), two * (xy + wz),  ww - xx + yy - zz,
              two * (yz - wx),   two * (xz - wy), two * (yz + wx), ww - xx - yy + zz};
  denominator = ww + xx + yy + zz;
}

PosedSolids::PosedSolids(const MeshSolid& a, const Pose& pose_a, const MeshSolid& b, const Pose& pose_b,
                         const Vec3& way)
    : a_{&a, &pose_a, pose_a.rotation(), pose_a.rotation().cwiseAbs(), Vec3::Zero(), exchanges_axes(pose_a)},
      b_{&b, &pose_b, pose_b.rotation(), pose_b.rotation().cwiseAbs(), Vec3::Zero(), exchanges_axes(pose_b)},
      way_(way) {
  const Vec3 apart = 0.5 * pose_b.translation() - 0.5 * pose_a.translation() - 0.5 * way;
  const double size =
      std::max({largest_coordinate(a), largest_coordinate(b), 2 * std::min(apart.cwiseAbs().maxCoeff(), 0x1p1022)});
  scale_exponent_ = size > 0 ? std::ilogb(size) : 0;
  if (scale_exponent_ < -1000) lift_ = 0x1p100;
  scale_ = std::ldexp(1.0 / lift_, -scale_exponent_);
  for (int k = 0; k < 3; ++k) {
    const DoubleDouble offset = two_sum(std::ldexp(pose_b.translation()[k], -scale_exponent_),
                                        -std::ldexp(pose_a.translation()[k], -scale_exponent_));
    const DoubleDouble moved = two_sum(offset.hi, -std::ldexp(way[k], -scale_exponent_));
    b_.offset[k] = moved.hi;
    b_.exact = b_.exact && offset.lo == 0 && moved.lo == 0;
  }
  const double largest = 3 * inside(largest_coordinate(a) + largest_coordinate(b)) + b_.offset.cwiseAbs().maxCoeff();
  error_ = 32 * kUnitRoundoff * largest;
}

PosedPoint PosedSolids::point(Body body, std::int32_t vertex) const {
  const Placing& p = placing(body);
  PosedPoint out;
  out.body = body;
  out.vertices[0] = vertex;
  const Vec3 turned = p.rotation * inside(p.solid->vertex(vertex));
  out.x = turned + p.offset;
  out.exact = p.exact;
  for (int k = 0; k < 3 && out.exact; ++k) {
    // Scaling takes digits from numbers that become subnormal.
    out.exact = turned[k] == 0 || std::abs(turned[k]) > 0x1p-960;
    if (body == Body::b) out.exact = out.exact && two_sum(turned[k], p.offset[k]).lo == 0;
  }
  return out;
}

PosedPoint PosedSolids::mean(Body body, const std::array<std::int32_t, 3>& vertices,
                             const std::array<std::int32_t, 3>& weights, int shift) const {
  PosedPoint out;
  out.body = body;
  out.vertices = vertices;
  out.weights = weights;
  out.shift = shift;
  out.x = Vec3::Zero();
  for (std::size_t k = 0; k < 3; ++k) {
    if (weights[k] != 0) out.x += std::ldexp(static_cast<double>(weights[k]), -shift) * point(body, vertices[k]).x;
  }
  return out;
}

PosedTriangle PosedSolids::corners(Body body, std::int32_t triangle) const {
  const auto& v = solid(body).triangle(triangle).vertices;
  return {point(body, v[0]), point(body, v[1]), point(body, v[2])};
}

TriangleBox PosedSolids::box(Body body, const TriangleNode& node) const {
  const Placing& p = placing(body);
  const Vec3 low = inside(node.low), high = inside(node.high);
  const Vec3 centre = p.rotation * (0.5 * (low + high)) + p.offset;
  const Vec3 half = (p.absolute * (0.5 * (high - low))).array() + error_;
  return {centre - half, centre + half};
}

Vec3 PosedSolids::in_own_frame(Body body, const Vec3& x) const {
  const Placing& p = placing(body);
  const Vec3 own = p.rotation.inverse() * (x - p.offset);
  return {std::ldexp(own.x(), scale_exponent_), std::ldexp(own.y(), scale_exponent_),
          std::ldexp(own.z(), scale_exponent_)};
}

Vec3 PosedSolids::outside(const Vec3& x) const {
  Vec3 out;
  for (int k = 0; k < 3; ++k) out[k] = std::ldexp(x[k], scale_exponent_) + (pose(Body::a).translation()[k] + way_[k]);
  return out;
}

Dyadic3 PosedSolids::exact_vertex(Body body, std::int32_t vertex) const {
  if (!exact_) {
    ExactPlacing& made = exact_.emplace();
    Dyadic denominator[2];
    rotation_numerators(*a_.pose, made.rotation[0], denominator[0]);
    rotation_numerators(*b_.pose, made.rotation[1], denominator[1]);
    for (Dyadic& x : made.rotation[0]) x = x * denominator[1];
    for (Dyadic& x : made.rotation[1]) x = x * denominator[0];
    made.offset_b = (to_dyadic(b_.pose->translation()) - to_dyadic(a_.pose->translation()) - to_dyadic(way_)) *
                    (denominator[0] * denominator[1]);
  }
  const Dyadic3 v = to_dyadic(solid(body).vertex(vertex));
  const auto& r = exact_->rotation[body == Body::a ? 0 : 1];
  Dyadic3 out{r[0] * v.x + r[1] * v.y + r[2] * v.z, r[3] * v.x + r[4] * v.y + r[5] * v.z,
              r[6] * v.x + r[7] * v.y + r[8] * v.z};
  return body == Body::a ? out : out + exact_->offset_b;
}

Dyadic3 PosedSolids::exact(const PosedPoint& p) const {
  if (p.vertices[0] < 0) {
    const Dyadic3 x = to_dyadic(p.x);
    return {x.x.scaled(scale_exponent_), x.y.scaled(scale_exponent_), x.z.scaled(scale_exponent_)};
  }
  if (p.shift == 0) return exact_vertex(p.body, p.vertices[0]);
  Dyadic3 sum;
  for (std::size_t k = 0; k < 3; ++k) {
    if (p.weights[k] == 0) continue;
    sum = sum + exact_vertex(p.body, p.vertices[k]) * Dyadic(static_cast<double>(p.weights[k]));
  }
  return {sum.x.scaled(-p.shift), sum.y.scaled(-p.shift), sum.z.scaled(-p.shift)};
}

int PosedSolids::orient3d(const PosedPoint& p, const PosedPoint& q, const PosedPoint& r, const PosedPoint& s) const {
  if (p.exact && q.exact && r.exact && s.exact) return pd::orient3d(p.x, q.x, r.x, s.x);
  const Vec3 u = q.x - p.x, v = r.x - p.x, w = s.x - p.x;
  const double value = u.cross(v).dot(w);
  // Each coordinate of a difference errs by at most `off`, and a determinant is linear in each vector.
  const double off = 3 * error_;
  const double a = u.lpNorm<1>() + 3 * off, b = v.lpNorm<1>() + 3 * off, c = w.lpNorm<1>() + 3 * off;
  if (std::abs(value) > 4 * off * (a * b + b * c + c * a) + 16 * kUnitRoundoff * a * b * c) return sign_of(value);
  ++exact_signs_;
  const Dyadic3 origin = exact(p);
  return determinant(exact(q) - origin, exact(r) - origin, exact(s) - origin).sign();
}

int PosedSolids::orient2d(int axis, const PosedPoint& p, const PosedPoint& q, const PosedPoint& r) const {
  const int i = (axis + 1) % 3, j = (axis + 2) % 3;
  if (p.exact && q.exact && r.exact) return pd::orient2d({p.x[i], p.x[j]}, {q.x[i], q.x[j]}, {r.x[i], r.x[j]});
  const double ux = q.x[i] - p.x[i], uy = q.x[j] - p.x[j], vx = r.x[i] - p.x[i], vy = r.x[j] - p.x[j];
  const double value = ux * vy - uy * vx;
  const double off = 3 * error_;
  const double a = std::abs(ux) + std::abs(uy) + 2 * off, b = std::abs(vx) + std::abs(vy) + 2 * off;
  if (std::abs(value) > 2 * off * (a + b) + 8 * kUnitRoundoff * a * b) return sign_of(value);
  ++exact_signs_;
  const auto coordinate = [](const Dyadic3& x, int k) -> const Dyadic& { return k == 0 ? x.x : k == 1 ? x.y : x.z; };
  const Dyadic3 origin = exact(p), u = exact(q) - origin, v = exact(r) - origin;
  return (coordinate(u, i) * coordinate(v, j) - coordinate(u, j) * coordinate(v, i)).sign();
}

Dyadic3 PosedSolids::exact_way(const PosedPoint& p, const PosedPoint& q) const {
  const Dyadic3 way = exact(q) - exact(p);
  return {way.x.scaled(-scale_exponent_), way.y.scaled(-scale_exponent_), way.z.scaled(-scale_exponent_)};
}

int PosedSolids::compare(int k, const PosedPoint& p, const PosedPoint& q) const {
  const double value = p.x[k] - q.x[k];
  if (p.exact && q.exact) return sign_of(value);
  if (std::abs(value) > 3 * error_) return sign_of(value);
  ++exact_signs_;
  const Dyadic3 difference = exact(p) - exact(q);
  return (k == 0 ? difference.x : k == 1 ? difference.y : difference.z).sign();
}

}  // namespace pd::detail

#include "depth/certificate/rounded_ray_crossing.hpp"

#include <cmath>

#include "numeric/vector_double_double.hpp"

namespace pd::detail {

namespace {

/// Sums, products, quotients and roots of double-doubles err by a few 2^-104 of what they add up, which the factors
/// below count as products of 1-norms.
constexpr double kRelative = 32 * 0x1p-104;
/// Beyond these, squares could leave the range of doubles.
constexpr double kLeast = 0x1p-400;
constexpr double kMost = 0x1p400;

/// A number with its absolute error.
struct Bounded {
  DoubleDouble value;
  double error;
  [[nodiscard]] bool in_range() const { return value.hi > kLeast && value.hi < kMost && error < 0x1p-70 * value.hi; }
};

/// <w, n>, where the coordinates of w err by `error_w`, those of n by `error_n`.
Bounded product(const Vec3DD& w, double error_w, const Vec3DD& n, double error_n) {
  const double a = norm1(w) + 3 * error_w, b = norm1(n) + 3 * error_n;
  return {dot(w, n), (kRelative * a * b + error_n * a + error_w * b) * (1 + 0x1p-40) + 0x1p-900};
}

/// The nearest double; nothing where the error leaves it, or the sign, open.
std::optional<double> nearest(const DoubleDouble& x, double error) {
  if (!(std::abs(x.hi) > error)) return std::nullopt;
  const double next = std::nextafter(x.hi, x.lo > 0 ? HUGE_VAL : -HUGE_VAL);
  if (!(std::abs(next - x.hi) / 2 - std::abs(x.lo) > error)) return std::nullopt;
  return x.hi;
}

/// The neighbours of a positive number, and the nearer one.
bool round(const DoubleDouble& x, double error, RoundedRayCrossing& r) {
  if (!(x.hi > 0x1p-1000 && x.hi < 0x1p1000) || !(std::abs(x.lo) > error)) return false;
  r.depth = x.hi;
  r.lower = x.lo > 0 ? x.hi : std::nextafter(x.hi, 0.0);
  r.upper = x.lo > 0 ? std::nextafter(x.hi, HUGE_VAL) : x.hi;
  return std::abs((r.upper - r.lower) / 2 - std::abs(x.lo)) > error;
}

}  // namespace

std::optional<RoundedRayCrossing> rounded_ray_crossing(const DirectionSigns& ray,
                                                       const std::array<VertexPair, 3>& corners) {
  const PosedPair& pair = ray.pair();
  const VertexPair& p = corners[0];
  const auto to = [&](const VertexPair& q) { return pair.approximate_dd(PairVector::difference(p.a, p.b, q.a, q.b)); };
  const Vec3DD u = to(corners[1]), v = to(corners[2]);
  const double e = pair.vector_error_dd();
  const double a = norm1(u) + 3 * e, b = norm1(v) + 3 * e;
  const Vec3DD normal = cross(u, v);
  const double normal_error = (kRelative * a * b + e * (a + b)) * (1 + 0x1p-40) + 0x1p-900;

  RoundedRayCrossing r;
  const DoubleDouble length = sqrt(dot(normal, normal));
  if (!(length.hi > kLeast && length.hi < kMost)) return std::nullopt;
  r.plane.unit = {normal.x / length, normal.y / length, normal.z / length};
  r.plane.unit_error = 4 * normal_error / length.hi + 0x1p-98;
  r.plane.distance_error = 0;  // of a plane that is not asked for
  const auto x = nearest(r.plane.unit.x, r.plane.unit_error), y = nearest(r.plane.unit.y, r.plane.unit_error),
             z = nearest(r.plane.unit.z, r.plane.unit_error);
  if (!x || !y || !z) return std::nullopt;
  r.normal = Vec3(*x, *y, *z);

  const Vec3DD direction = widened(ray.scaled());
  const Bounded offset = product(pair.approximate_dd(PairVector::point(p.a, p.b)), e, normal, normal_error);
  const Bounded slope = product(direction, 0, normal, normal_error);
  if (!offset.in_range() || !slope.in_range()) return std::nullopt;
  const DoubleDouble along = offset.value / slope.value * sqrt(dot(direction, direction));
  const double relative = (offset.error / offset.value.hi + slope.error / slope.value.hi) * (1 + 0x1p-40) + 0x1p-96;
  const int exponent = pair.scale_exponent();
  const DoubleDouble scaled = {std::ldexp(along.hi, exponent), std::ldexp(along.lo, exponent)};
  if (!round(scaled, relative * scaled.hi, r)) return std::nullopt;
  return r;
}

}  // namespace pd::detail

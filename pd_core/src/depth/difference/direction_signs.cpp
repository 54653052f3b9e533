#include "depth/difference/direction_signs.hpp"

#include <array>
#include <cmath>

#include "numeric/unit_roundoff.hpp"

namespace pd::detail {

namespace {

double norm1(const Vec3& v) { return v.cwiseAbs().sum(); }

/// o1 and r1: in no simple ratio to anything; short, so that exact arithmetic stays short.
const Vec3 kGeneric(40503.0 / 65536, 52433.0 / 65536, 61169.0 / 65536);

std::array<Dyadic3, 3> perturbations() {
  return {to_dyadic(kGeneric), to_dyadic(Vec3::UnitY()), to_dyadic(Vec3::UnitZ())};
}

}  // namespace

DirectionSigns::DirectionSigns(const PosedPair& pair, const Vec3& direction)
    : pair_(&pair), exact_(to_dyadic(direction)) {
  const int exponent = std::ilogb(direction.cwiseAbs().maxCoeff());
  for (int i = 0; i < 3; ++i) scaled_[i] = std::ldexp(direction[i], -exponent);
}

int DirectionSigns::along(const PairVector& x) const {
  const Vec3 p = pair_->approximate(x);
  const double value = p.dot(scaled_);
  const double e = pair_->vector_error();
  // Coordinates of the direction that underflow in scaling lose less than 2^-1000 of its length.
  if (std::abs(value) > (4 * kUnitRoundoff * norm1(p) + 3 * e) * norm1(scaled_) * (1 + 16 * kUnitRoundoff) + 0x1p-900) {
    return value > 0 ? 1 : -1;
  }
  return dot(pair_->exact(x), exact_).sign();
}

int DirectionSigns::turn(const PairVector& x, const PairVector& y) const {
  const Vec3 p = pair_->approximate(x), q = pair_->approximate(y);
  const double value = p.cross(q).dot(scaled_);
  const double e = pair_->vector_error();
  const double a = norm1(p) + 3 * e, b = norm1(q) + 3 * e;
  if (std::abs(value) >
      (8 * kUnitRoundoff * a * b + e * (a + b)) * norm1(scaled_) * (1 + 16 * kUnitRoundoff) + 0x1p-900) {
    return value > 0 ? 1 : -1;
  }
  return determinant(pair_->exact(x), pair_->exact(y), exact_).sign();
}

int DirectionSigns::side(const VertexPair& x, const VertexPair& y) const {
  const PairVector p = PairVector::point(x.a, x.b), q = PairVector::point(y.a, y.b);
  if (const int sign = turn(p, q)) return sign;
  const std::array<Dyadic3, 3> basis = perturbations();
  const Dyadic3 step = pair_->exact(PairVector::difference(x.a, x.b, y.a, y.b));
  const Dyadic3 across = cross(step, exact_);
  for (const Dyadic3& o : basis) {
    if (const int sign = dot(o, across).sign()) return -sign;
  }
  // y - x = lambda d: the determinant is lambda det(x - o, d, r) for the moved origin o and the turn r of d.
  const int lambda = dot(step, exact_).sign();
  const Dyadic3 start = pair_->exact(p);
  for (const Dyadic3& r : basis) {
    if (const int sign = determinant(start, exact_, r).sign()) return lambda * sign;
    for (const Dyadic3& o : basis) {
      if (const int sign = determinant(o, exact_, r).sign()) return -lambda * sign;
    }
  }
  return 0;
}

int DirectionSigns::side_of_far(const Vec3& g, const VertexPair& y) const {
  const PairVector point = PairVector::point(y.a, y.b);
  const Vec3 p = pair_->approximate(point);
  const Vec3 across = scaled_.cross(g);  // <across, y> = det(d, g, y) = det(g, y, d)
  const double value = p.dot(across);
  const double size = norm1(scaled_) * norm1(g), e = pair_->vector_error();
  if (std::abs(value) > size * (8 * kUnitRoundoff * norm1(p) + 3 * e) * (1 + 16 * kUnitRoundoff) + 0x1p-900) {
    return value > 0 ? 1 : -1;
  }
  const Dyadic3 far = to_dyadic(g);
  if (const int sign = determinant(far, pair_->exact(point), exact_).sign()) return sign;
  for (const Dyadic3& o : perturbations()) {
    if (const int sign = determinant(far, o, exact_).sign()) return -sign;
  }
  return 0;
}

}  // namespace pd::detail

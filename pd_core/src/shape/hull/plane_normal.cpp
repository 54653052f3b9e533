#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "numeric/double_double.hpp"
#include "numeric/dyadic.hpp"
#include "shape/hull/polytope_storage.hpp"

namespace pd::detail {
namespace {

// Cross products of rounded differences are off by at most 4u times the magnitudes of their products; this ratio keeps
// that below 16u of the normal's length (u = 2^-53). Double-double keeps it below u down to a ratio of 2^45.
constexpr double kPlainRatio = 4;
constexpr double kDoubleDoubleRatio = 0x1p45;

// Well-conditioned products may still be small, where one edge is much longer than another in every coordinate that
// counts; below this they would lose bits to underflow.
constexpr double kSmallestProduct = 0x1p-900;

/// The power of two that brings the largest coordinate of v into [1/2, 1), as near as doubles allow. Normals then have
/// the same bits at every magnitude, and nothing that matters under- or overflows.
double unit_scale(const Vec3& v) {
  const double largest = v.cwiseAbs().maxCoeff();
  if (largest >= 0x1p-900 && largest <= 0x1p900) {
    // 2^(e - 1) <= largest < 2^e: its biased exponent b is e + 1022, that of 2^-e is 1023 - e = 2045 - b.
    const std::uint64_t biased = std::bit_cast<std::uint64_t>(largest) >> 52;
    return std::bit_cast<double>((2045 - biased) << 52);
  }
  int exponent = 0;
  std::frexp(largest, &exponent);
  return std::ldexp(1.0, -std::max(exponent, -1000));
}

Vec3 unit(const Vec3& v) {
  const Vec3 s = v * unit_scale(v);  // squares of it neither over- nor underflow
  return s / std::sqrt(s.x() * s.x() + s.y() * s.y() + s.z() * s.z());
}

Vec3DD exact_difference(const Vec3& to, const Vec3& from, double scale) {
  const auto coordinate = [&](int i) {
    const DoubleDouble d = two_sum(to[i], -from[i]);
    return DoubleDouble{d.hi * scale, d.lo * scale};
  };
  return {coordinate(0), coordinate(1), coordinate(2)};
}

/// Position of the highest bit.
int magnitude_exponent(const Dyadic& d) {
  if (d.sign() == 0) return std::numeric_limits<int>::min();
  return d.exponent() + static_cast<int>(msb(d.sign() < 0 ? Dyadic::Integer(-d.mantissa()) : d.mantissa()));
}

}  // namespace

Vec3 plane_normal(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double scale_u = unit_scale(b - a);
  const double scale_v = unit_scale(c - a);
  const Vec3 u = (b - a) * scale_u;
  const Vec3 v = (c - a) * scale_v;
  const Vec3 plain{u.y() * v.z() - u.z() * v.y(), u.z() * v.x() - u.x() * v.z(), u.x() * v.y() - u.y() * v.x()};
  const double products = std::abs(u.y() * v.z()) + std::abs(u.z() * v.y()) + std::abs(u.z() * v.x()) +
                          std::abs(u.x() * v.z()) + std::abs(u.x() * v.y()) + std::abs(u.y() * v.x());
  const double length = plain.cwiseAbs().maxCoeff();
  const bool in_range = products >= kSmallestProduct;
  if (in_range && products <= kPlainRatio * length) return unit(plain);
  if (in_range && products <= kDoubleDoubleRatio * length) {
    const Vec3DD n = cross(exact_difference(b, a, scale_u), exact_difference(c, a, scale_v));
    return unit({to_double(n.x), to_double(n.y), to_double(n.z)});
  }
  // The triangle is thinner than 106 bits can tell.
  const Dyadic3 origin = to_dyadic(a);
  const Dyadic3 n = cross(to_dyadic(b) - origin, to_dyadic(c) - origin);
  const int exponent = std::max({magnitude_exponent(n.x), magnitude_exponent(n.y), magnitude_exponent(n.z)});
  return unit(
      {n.x.scaled(-exponent).to_double(), n.y.scaled(-exponent).to_double(), n.z.scaled(-exponent).to_double()});
}

}  // namespace pd::detail

#include <algorithm>
#include <cmath>

#include "numeric/double_double.hpp"
#include "numeric/dyadic.hpp"
#include "shape/polytope_storage.hpp"

namespace pd::detail {
namespace {

// Cross products of rounded differences are off by at most 4u times the magnitudes of their products; this ratio keeps
// that below 16u of the normal's length (u = 2^-53). Double-double keeps it below u down to a ratio of 2^45.
constexpr double kPlainRatio = 4;
constexpr double kDoubleDoubleRatio = 0x1p45;
// Products of magnitudes in this range lose nothing to underflow that matters here and do not overflow when squared.
constexpr double kSmallestProduct = 0x1p-400;
constexpr double kLargestProduct = 0x1p400;

Vec3 unit(const Vec3& v) { return v / std::sqrt(v.x() * v.x() + v.y() * v.y() + v.z() * v.z()); }

/// Bits of the highest set bit above the point.
int magnitude_exponent(const Dyadic& d) {
  if (d.sign() == 0) return std::numeric_limits<int>::min();
  return d.exponent() + static_cast<int>(msb(d.sign() < 0 ? Dyadic::Integer(-d.mantissa()) : d.mantissa()));
}

}  // namespace

Vec3 plane_normal(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 u = b - a;
  const Vec3 v = c - a;
  const Vec3 plain{u.y() * v.z() - u.z() * v.y(), u.z() * v.x() - u.x() * v.z(), u.x() * v.y() - u.y() * v.x()};
  const double products = std::abs(u.y() * v.z()) + std::abs(u.z() * v.y()) + std::abs(u.z() * v.x()) +
                          std::abs(u.x() * v.z()) + std::abs(u.x() * v.y()) + std::abs(u.y() * v.x());
  const double length = plain.cwiseAbs().maxCoeff();
  if (products >= kSmallestProduct && products <= kLargestProduct) {
    if (products <= kPlainRatio * length) return unit(plain);
    if (products <= kDoubleDoubleRatio * length) {
      const Vec3DD ud{two_sum(b.x(), -a.x()), two_sum(b.y(), -a.y()), two_sum(b.z(), -a.z())};
      const Vec3DD vd{two_sum(c.x(), -a.x()), two_sum(c.y(), -a.y()), two_sum(c.z(), -a.z())};
      const Vec3DD n = cross(ud, vd);
      return unit({to_double(n.x), to_double(n.y), to_double(n.z)});
    }
  }
  const Dyadic3 origin = to_dyadic(a);
  const Dyadic3 n = cross(to_dyadic(b) - origin, to_dyadic(c) - origin);
  const int exponent = std::max({magnitude_exponent(n.x), magnitude_exponent(n.y), magnitude_exponent(n.z)});
  return unit(
      {n.x.scaled(-exponent).to_double(), n.y.scaled(-exponent).to_double(), n.z.scaled(-exponent).to_double()});
}

}  // namespace pd::detail

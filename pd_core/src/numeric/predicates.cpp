#include "pd/numeric/predicates.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>

#include "numeric/dyadic.hpp"
#include "numeric/expansion.hpp"
#include "numeric/unit_roundoff.hpp"

namespace pd {
namespace {

using detail::difference;
using detail::Dyadic;
using detail::Expansion;
using detail::product;
using detail::sum;

// Filter bounds: (3 + 16u)u and (7 + 56u)u times the permanent ([S] section 4.2 and 4.3, u = 2^-53), rounded up to
// cover the roundings of bound and permanent themselves. kUnderflow covers what underflows while every difference is at
// most kLargestFiltered: at most 2^-1074 for a product, times a third factor, and a few of them.
constexpr double kBound2d = 4 * detail::kUnitRoundoff;
constexpr double kBound3d = 8 * detail::kUnitRoundoff;
constexpr double kUnderflow = 0x1p-700;
// Differences are exact in double-double. Two levels of products (5u^2 each) and three of sums (3u^2 each) on
// magnitudes that the permanent bounds give 19u^2(1 + O(u)) of it; the bound leaves room for the permanent's own
// rounding.
constexpr double kBoundDoubleDouble = 32 * 0x1p-106;
// Expanded numbers are at least 2^-300 or 0, and their differences at least 2^-352: what underflows is below 2^-1074
// times differences below 2^322, a few times.
constexpr double kTinyDoubleDouble = 0x1p-740;
constexpr double kLargestFiltered = 0x1p330;

// Within these magnitudes (or zero) every bit of every product of three differences lies in 2^-1056 .. 2^1000, and
// Veltkamp's split does not overflow.
constexpr double kSmallestExpanded = 0x1p-300;
constexpr double kLargestExpanded = 0x1p320;

bool expandable(std::initializer_list<double> values) {
  return std::all_of(values.begin(), values.end(), [](double v) {
    const double magnitude = std::abs(v);
    return v == 0 || (magnitude >= kSmallestExpanded && magnitude <= kLargestExpanded);
  });
}

int sign_of(double value) { return (value > 0) - (value < 0); }

void count(std::int64_t PredicateStages::*stage, PredicateStages* stages) {
  if (stages != nullptr) ++(stages->*stage);
}

/// a * d - b * c on expansions.
Expansion<16> minor(const Expansion<2>& a, const Expansion<2>& b, const Expansion<2>& c, const Expansion<2>& d) {
  return sum(product(a, d), product(b, c), -1);
}

int orient2d_unfiltered(const std::array<double, 2>& a, const std::array<double, 2>& b, const std::array<double, 2>& c,
                        PredicateStages* stages) {
  if (expandable({a[0], a[1], b[0], b[1], c[0], c[1]})) {
    count(&PredicateStages::expansion, stages);
    return minor(difference(b[0], a[0]), difference(b[1], a[1]), difference(c[0], a[0]), difference(c[1], a[1])).sign();
  }
  count(&PredicateStages::dyadic, stages);
  const Dyadic ax(a[0]);
  const Dyadic ay(a[1]);
  return ((Dyadic(b[0]) - ax) * (Dyadic(c[1]) - ay) - (Dyadic(b[1]) - ay) * (Dyadic(c[0]) - ax)).sign();
}

/// The determinant of orient3d, its differences exact and its products and sums in double-double.
double determinant_in_double_double(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const auto from_a = [&](const Vec3& p) {
    return detail::Vec3DD{detail::two_sum(p.x(), -a.x()), detail::two_sum(p.y(), -a.y()),
                          detail::two_sum(p.z(), -a.z())};
  };
  return dot(from_a(d), cross(from_a(b), from_a(c))).hi;  // the sum is normalised: hi has its sign
}

int orient3d_unfiltered(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, double permanent,
                        PredicateStages* stages) {
  if (expandable({a.x(), a.y(), a.z(), b.x(), b.y(), b.z(), c.x(), c.y(), c.z(), d.x(), d.y(), d.z()})) {
    const double determinant = determinant_in_double_double(a, b, c, d);
    if (std::abs(determinant) > kBoundDoubleDouble * permanent + kTinyDoubleDouble) {
      count(&PredicateStages::double_double, stages);
      return sign_of(determinant);
    }
    count(&PredicateStages::expansion, stages);
    const Expansion<2> bx = difference(b.x(), a.x());
    const Expansion<2> by = difference(b.y(), a.y());
    const Expansion<2> bz = difference(b.z(), a.z());
    const Expansion<2> cx = difference(c.x(), a.x());
    const Expansion<2> cy = difference(c.y(), a.y());
    const Expansion<2> cz = difference(c.z(), a.z());
    const auto along_x = product(minor(by, bz, cy, cz), difference(d.x(), a.x()));
    const auto along_y = product(minor(bz, bx, cz, cx), difference(d.y(), a.y()));
    const auto along_z = product(minor(bx, by, cx, cy), difference(d.z(), a.z()));
    return sum(sum(along_x, along_y), along_z).sign();
  }
  count(&PredicateStages::dyadic, stages);
  const detail::Dyadic3 origin = detail::to_dyadic(a);
  return detail::determinant(detail::to_dyadic(b) - origin, detail::to_dyadic(c) - origin,
                             detail::to_dyadic(d) - origin)
      .sign();
}

}  // namespace

int orient2d(const std::array<double, 2>& a, const std::array<double, 2>& b, const std::array<double, 2>& c,
             PredicateStages* stages) {
  const double bx = b[0] - a[0];
  const double by = b[1] - a[1];
  const double cx = c[0] - a[0];
  const double cy = c[1] - a[1];
  const double left = bx * cy;
  const double right = by * cx;
  const double determinant = left - right;
  const double bound = kBound2d * (std::abs(left) + std::abs(right)) + kUnderflow;
  if (std::abs(determinant) > bound) {  // false for NaN, and where a product overflows the bound does too
    count(&PredicateStages::filtered, stages);
    return sign_of(determinant);
  }
  return orient2d_unfiltered(a, b, c, stages);
}

int orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, PredicateStages* stages) {
  const double bx = b.x() - a.x();
  const double by = b.y() - a.y();
  const double bz = b.z() - a.z();
  const double cx = c.x() - a.x();
  const double cy = c.y() - a.y();
  const double cz = c.z() - a.z();
  const double dx = d.x() - a.x();
  const double dy = d.y() - a.y();
  const double dz = d.z() - a.z();
  const double by_cz = by * cz;
  const double bz_cy = bz * cy;
  const double bz_cx = bz * cx;
  const double bx_cz = bx * cz;
  const double bx_cy = bx * cy;
  const double by_cx = by * cx;
  const double determinant = dx * (by_cz - bz_cy) + dy * (bz_cx - bx_cz) + dz * (bx_cy - by_cx);
  const double permanent = std::abs(dx) * (std::abs(by_cz) + std::abs(bz_cy)) +
                           std::abs(dy) * (std::abs(bz_cx) + std::abs(bx_cz)) +
                           std::abs(dz) * (std::abs(bx_cy) + std::abs(by_cx));
  const double largest = std::max(std::abs(dx), std::max(std::abs(dy), std::abs(dz)));
  if (std::abs(determinant) > kBound3d * permanent + kUnderflow && largest <= kLargestFiltered) {
    count(&PredicateStages::filtered, stages);
    return sign_of(determinant);
  }
  return orient3d_unfiltered(a, b, c, d, permanent, stages);
}

bool collinear(const Vec3& a, const Vec3& b, const Vec3& c, PredicateStages* stages) {
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    if (orient2d({a[i], a[j]}, {b[i], b[j]}, {c[i], c[j]}, stages) != 0) return false;
  }
  return true;
}

}  // namespace pd

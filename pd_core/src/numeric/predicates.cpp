#include "pd/numeric/predicates.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>

#include "numeric/dyadic.hpp"
#include "numeric/expansion.hpp"
#include "numeric/orientation_filter.hpp"

namespace pd {
namespace {

using detail::determinant2;
using detail::difference;
using detail::Dyadic;

bool expandable(std::initializer_list<double> values) {
  return std::all_of(values.begin(), values.end(), detail::fits_expansions);
}

int sign_of(double value) { return (value > 0) - (value < 0); }

void count(std::int64_t PredicateStages::*stage, PredicateStages* stages) {
  if (stages != nullptr) ++(stages->*stage);
}

int orient2d_unfiltered(const std::array<double, 2>& a, const std::array<double, 2>& b, const std::array<double, 2>& c,
                        PredicateStages* stages) {
  if (expandable({a[0], a[1], b[0], b[1], c[0], c[1]})) {
    count(&PredicateStages::expansion, stages);
    return determinant2(difference(b[0], a[0]), difference(b[1], a[1]), difference(c[0], a[0]), difference(c[1], a[1]))
        .sign();
  }
  count(&PredicateStages::dyadic, stages);
  const Dyadic ax(a[0]);
  const Dyadic ay(a[1]);
  return ((Dyadic(b[0]) - ax) * (Dyadic(c[1]) - ay) - (Dyadic(b[1]) - ay) * (Dyadic(c[0]) - ax)).sign();
}

int orient3d_unfiltered(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, double double_double_error,
                        PredicateStages* stages) {
  if (expandable({a.x(), a.y(), a.z(), b.x(), b.y(), b.z(), c.x(), c.y(), c.z(), d.x(), d.y(), d.z()})) {
    const double determinant = detail::double_double_orient3d(a, b, c, d).hi;
    if (std::abs(determinant) > double_double_error) {
      count(&PredicateStages::double_double, stages);
      return sign_of(determinant);
    }
    count(&PredicateStages::expansion, stages);
    const auto from_a = [&](const Vec3& p) {
      return detail::DifferenceVector{difference(p.x(), a.x()), difference(p.y(), a.y()), difference(p.z(), a.z())};
    };
    return detail::sign_of_determinant(from_a(d), from_a(b), from_a(c));
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
  const detail::RoundedOrient2d rounded = detail::rounded_orient2d(a, b, c);
  // False for NaN, and where a product overflows the bound does too.
  if (std::abs(rounded.determinant) > rounded.error) {
    count(&PredicateStages::filtered, stages);
    return sign_of(rounded.determinant);
  }
  return orient2d_unfiltered(a, b, c, stages);
}

int orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, PredicateStages* stages) {
  const detail::RoundedOrient3d rounded = detail::rounded_orient3d(a, b, c, d);
  if (std::abs(rounded.determinant) > rounded.error() && rounded.in_range()) {
    count(&PredicateStages::filtered, stages);
    return sign_of(rounded.determinant);
  }
  return orient3d_unfiltered(a, b, c, d, rounded.double_double_error(), stages);
}

bool collinear(const Vec3& a, const Vec3& b, const Vec3& c, PredicateStages* stages) {
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    if (orient2d({a[i], a[j]}, {b[i], b[j]}, {c[i], c[j]}, stages) != 0) return false;
  }
  return true;
}

}  // namespace pd

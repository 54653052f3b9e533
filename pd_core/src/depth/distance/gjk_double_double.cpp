#include "depth/distance/gjk_double_double.hpp"

#include <algorithm>
#include <limits>

#include "depth/distance/simplex_double_double.hpp"
#include "numeric/vector_double_double.hpp"

namespace pd::detail {

namespace {

Vec3 rounded(const Vec3DD& v) { return {to_double(v.x), to_double(v.y), to_double(v.z)}; }
}  // namespace

template <class Difference>
ClosestPointWithNormal closest_point_double_double(const Difference& difference, const DifferenceVertex& first,
                                                   double relative, const BracketWidth& width, int max_steps,
                                                   std::vector<std::int32_t>& stack, std::int64_t& support_calls) {
  const double rounding = 8 * kUnitRoundoff * difference.reach();
  const double upper_error = difference.point_error() + rounding;
  const double lower_error = difference.point_error() + difference.support_error() + rounding;
  const DifferenceVertex far = difference.support(difference.centre(), nullptr);
  ++support_calls;
  double largest = std::max(first.x.cwiseAbs().maxCoeff(), far.x.cwiseAbs().maxCoeff());
  SimplexDoubleDouble<DifferenceVertex> simplex(first, widened(first.x));
  ClosestPointWithNormal out;
  ClosestPoint& r = out.nearest;
  r.upper = std::numeric_limits<double>::infinity();
  r.lower = -r.upper;
  out.normal = Vec3::UnitX();
  for (int step = 0;; ++step) {
    const ClosestOfFace& closest = simplex.closest();
    const double length = to_double(sqrt(closest.squared));
    // Each closest is nearer than the last.
    r.upper = length + upper_error;
    r.point = rounded(closest.point);
    r.count = closest.count;
    double total = 0;
    for (int i = 0; i < closest.count; ++i) total += closest.weights[i];
    for (int i = 0; i < closest.count; ++i) {
      r.simplex[i] = simplex.vertex(i);
      r.weights[i] = closest.weights[i] / total;
    }
    if (!(length > lower_error)) return out;
    const Vec3 toward = -r.point.normalized();
    const DifferenceVertex s = difference.certified_support(toward, difference.support(toward, nullptr), stack);
    ++support_calls;
    largest = std::max(largest, s.x.cwiseAbs().maxCoeff());
    const double height = -s.x.dot(toward);
    if (height - lower_error > r.lower) {
      r.lower = height - lower_error;
      out.normal = toward;
    }
    r.certified =
        r.lower > 0 && (r.upper - r.lower <= width.limit(largest) || width.is_within(relative, r.lower, r.upper));
    // What the formula's own rounding makes of a support on the simplex is no progress.
    if (r.certified || length - height <= 0.5 * rounding || step >= max_steps || !simplex.add(s, widened(s.x))) {
      return out;
    }
  }
}

template ClosestPointWithNormal closest_point_double_double(const SmoothDifference&, const DifferenceVertex&, double,
                                                            const BracketWidth&, int, std::vector<std::int32_t>&,
                                                            std::int64_t&);
template ClosestPointWithNormal closest_point_double_double(const PolytopeDifference&, const DifferenceVertex&, double,
                                                            const BracketWidth&, int, std::vector<std::int32_t>&,
                                                            std::int64_t&);

}  // namespace pd::detail

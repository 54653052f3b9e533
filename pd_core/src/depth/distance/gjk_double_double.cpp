#include "depth/distance/gjk_double_double.hpp"

#include <algorithm>
#include <limits>

#include "depth/distance/closest_search.hpp"
#include "depth/distance/simplex_of_numbers.hpp"
#include "numeric/vector_double_double.hpp"

namespace pd::detail {

namespace {

using Simplex = SimplexOfNumbers<DoubleDouble, DifferenceVertex>;

Simplex::Corner corner(const DifferenceVertex& s) { return {s, widened(s.x)}; }

template <class Difference>
class BoundedSearch {
 public:
  static constexpr bool kIsOfPolytopes = std::is_same_v<Difference, PolytopeDifference>;

  BoundedSearch(const Difference& difference, double relative, const BracketWidth& width, int max_steps,
                std::vector<std::int32_t>& stack, std::int64_t& support_calls)
      : difference_(difference),
        error_(distance_errors(difference)),
        relative_(relative),
        width_(width),
        steps_left_(max_steps),
        stack_(stack),
        support_calls_(support_calls) {
    out.nearest.upper = std::numeric_limits<double>::infinity();
    out.nearest.lower = -out.nearest.upper;
    out.normal = Vec3::UnitX();
  }

  void see(const DifferenceVertex& s) {
    if constexpr (!kIsOfPolytopes) size_ = std::max(size_, s.x.cwiseAbs().maxCoeff());
  }

  /// Each nearest point is nearer than the last.
  bool has_reached(const Simplex& simplex) {
    const Simplex::Face& nearest = simplex.nearest();
    ClosestPoint& r = out.nearest;
    length_ = to_double(sqrt(nearest.squared / nearest.scale));
    r.upper = length_ + error_.upper;
    const Vec3DD point = scaled(nearest.point, DoubleDouble{1, 0} / nearest.scale);
    r.point = {to_double(point.x), to_double(point.y), to_double(point.z)};
    r.count = nearest.count;
    for (int i = 0; i < r.count; ++i) {
      r.simplex[i] = simplex.corner(i).vertex;
      r.weights[i] = to_double(nearest.weights[static_cast<std::size_t>(i)] / nearest.scale);
    }
    return !(length_ > error_.lower);
  }

  Simplex::Corner support(const Simplex& /*simplex*/) {
    toward_ = -out.nearest.point.normalized();
    ++support_calls_;
    return corner(difference_.certified_support(toward_, difference_.support(toward_, nullptr), stack_));
  }

  bool goes_on(const Simplex& /*simplex*/, const Simplex::Corner& s) {
    ClosestPoint& r = out.nearest;
    see(s.vertex);
    const double height = -s.vertex.x.dot(toward_);
    if (height - error_.lower > r.lower) {
      r.lower = height - error_.lower;
      out.normal = toward_;
    }
    r.certified =
        r.lower > 0 && (r.upper - r.lower <= width_.limit(size_) || width_.is_within(relative_, r.lower, r.upper));
    // What the formula's own rounding makes of a support on the simplex is no progress.
    return !r.certified && length_ - height > 4 * kUnitRoundoff * difference_.reach() && steps_left_-- > 0;
  }

  ClosestPointWithNormal out;

 private:
  const Difference& difference_;
  const DistanceErrors error_;
  const double relative_;
  const BracketWidth& width_;
  int steps_left_;
  std::vector<std::int32_t>& stack_;
  std::int64_t& support_calls_;
  double size_ = kIsOfPolytopes ? difference_.reach() : 0;  ///< what `BracketWidth` measures by
  double length_ = 0;
  Vec3 toward_;
};

}  // namespace

template <class Difference>
ClosestPointWithNormal closest_point_double_double(const Difference& difference, const DifferenceVertex& first,
                                                   double relative, const BracketWidth& width, int max_steps,
                                                   std::vector<std::int32_t>& stack, std::int64_t& support_calls) {
  BoundedSearch search(difference, relative, width, max_steps, stack, support_calls);
  if constexpr (!BoundedSearch<Difference>::kIsOfPolytopes) {
    search.see(first);
    search.see(difference.support(difference.centre(), nullptr));
    ++support_calls;
  }
  Simplex simplex(corner(first));
  search_closest_point(search, simplex);
  return search.out;
}

template ClosestPointWithNormal closest_point_double_double(const SmoothDifference&, const DifferenceVertex&, double,
                                                            const BracketWidth&, int, std::vector<std::int32_t>&,
                                                            std::int64_t&);
template ClosestPointWithNormal closest_point_double_double(const PolytopeDifference&, const DifferenceVertex&, double,
                                                            const BracketWidth&, int, std::vector<std::int32_t>&,
                                                            std::int64_t&);

}  // namespace pd::detail

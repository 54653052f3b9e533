#include "depth/distance/gjk.hpp"

#include <algorithm>
#include <type_traits>

#include "depth/distance/closest_search.hpp"
#include "depth/distance/lane_simplex.hpp"
#include "numeric/unit_roundoff.hpp"

namespace pd::detail {

namespace {

/// The share of the reach below which single precision, in which a search over many vertices looks for supports,
/// cannot tell.
constexpr double kSeenGap = 0x1p-20;

/// The direction to look for a support in: along the normal of the face that holds the nearest point.
///
/// The point errs by u times the reach, so that its direction errs by u reach / distance and the support there by
/// u reach^2 / distance: a body on a wide floor would never be certified. A face's own normal knows no distance; as
/// any unit direction gives a valid bound, it is taken wherever it is that direction but for the point's rounding.
/// @param noise  of the point's coordinates, with something to spare: witnesses along the normal keep to it.
Vec3 search_direction(const Vec3& normal, const Vec3& point, double length, double noise) {
  const Vec3 toward = -point / length;
  return (normal - toward).norm() <= std::min(0x1p-20, noise / length) ? normal : toward;
}

template <class Difference>
class DistanceSearch {
 public:
  DistanceSearch(const Difference& difference, double relative, const BracketWidth& width,
                 std::vector<std::int32_t>& stack, std::int64_t& support_calls, ClosestPoint& found)
      : r(found),
        difference_(difference),
        error_(distance_errors(difference)),
        relative_(relative),
        width_(width),
        stack_(stack),
        support_calls_(support_calls),
        size_(kIsOfPolytopes ? difference.reach() : 0) {}

  void see(const DifferenceVertex& s) {
    if constexpr (!kIsOfPolytopes) size_ = std::max(size_, s.x.cwiseAbs().maxCoeff());
  }

  bool has_reached(const LaneSimplex& simplex) {
    r.count = simplex.count();
    r.point = simplex.point();
    for (int i = 0; i < r.count; ++i) {
      r.simplex[i] = simplex.corner(i);
      r.weights[i] = simplex.weight(i);
    }
    length_ = r.point.norm();
    r.upper = length_ + error_.upper;
    if (!(length_ > 4 * error_.lower)) return true;
    r.normal = search_direction(simplex.toward(), r.point, length_, 6 * error_.upper);
    return false;
  }

  DifferenceVertex support(const LaneSimplex& /*simplex*/) {
    ++support_calls_;
    return difference_.search_support_along(r.normal);
  }

  bool goes_on(const LaneSimplex& simplex, DifferenceVertex& s) {
    see(s);
    double height = -s.x.dot(r.normal);
    see_far_side(height);
    bool known = simplex.has_corner(s);
    if (known || is_narrow(height, size_) || may_be_farther(height)) {
      s = difference_.certified_support(r.normal, s, stack_);
      height = -s.x.dot(r.normal);
      r.certified = is_narrow(height, size_);
      known = simplex.has_corner(s);
    }
    return !r.certified && !known && length_ - height > kSearchGap * difference_.reach();
  }

  ClosestPoint& r;

 private:
  static constexpr bool kIsOfPolytopes = std::is_same_v<Difference, PolytopeDifference>;

  bool is_narrow(double height, double size) {
    r.lower = height - error_.lower;
    return r.lower > 0 && (r.upper - r.lower <= width_.limit(size) || width_.is_within(relative_, r.lower, r.upper));
  }

  /// Points near the origin say little about the size of a curved P. Its centre says more, and its far side, which
  /// takes a support, says all.
  void see_far_side(double height) {
    if (kIsOfPolytopes || seen_far_side_ || is_narrow(height, size_) || !is_narrow(height, difference_.reach())) return;
    const Vec3 centre = difference_.centre();
    size_ = std::max(size_, centre.cwiseAbs().maxCoeff());
    if (is_narrow(height, size_)) return;
    see(difference_.support(centre, nullptr));
    ++support_calls_;
    seen_far_side_ = true;
  }

  [[nodiscard]] bool may_be_farther(double height) const {
    return kIsOfPolytopes && length_ - height <= kSeenGap * difference_.reach();
  }

  const Difference& difference_;
  const DistanceErrors error_;
  const double relative_;
  const BracketWidth& width_;
  std::vector<std::int32_t>& stack_;
  std::int64_t& support_calls_;
  double size_;  ///< what `BracketWidth` measures by
  double length_ = 0;
  bool seen_far_side_ = false;
};

}  // namespace

template <class Difference>
ClosestPoint closest_point(const Difference& difference, std::span<const DifferenceVertex> start, double relative,
                           const BracketWidth& width, std::vector<std::int32_t>& stack, std::int64_t& support_calls) {
  ClosestPoint found;
  DistanceSearch search(difference, relative, width, stack, support_calls, found);
  LaneSimplex simplex;
  for (const DifferenceVertex& s : start) {
    search.see(s);
    if (!simplex.encloses()) simplex.add(s);
  }
  if (simplex.encloses()) {
    search.has_reached(simplex);
  } else {
    search_closest_point(search, simplex);
  }
  return found;
}

template ClosestPoint closest_point(const SmoothDifference&, std::span<const DifferenceVertex>, double,
                                    const BracketWidth&, std::vector<std::int32_t>&, std::int64_t&);
template ClosestPoint closest_point(const PolytopeDifference&, std::span<const DifferenceVertex>, double,
                                    const BracketWidth&, std::vector<std::int32_t>&, std::int64_t&);

}  // namespace pd::detail

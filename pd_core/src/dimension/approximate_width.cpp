#include "pd/dimension/approximate_width.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "dimension/backends/width_structure.hpp"
#include "dimension/radial_hull.hpp"
#include "dimension/validate.hpp"
#include "numeric/floating_point_guard.hpp"
#include "pd/dimension/approximate_minkowski_sum.hpp"

namespace pd::dimension {

namespace {

using detail::AnyBody;
using detail::AnyMap;
using detail::AnySupport;
using detail::AnyVector;
using AnyWidth = ApproximateWidth<kAnyDimension>;

/// What rounding may take from the bounds in a frame where the body is about a unit ball.
constexpr double kWidthRoom = 1e-10;
/// Of epsilon, for the structure; the search takes the rest. The kernel's hull is much dearer than the search, which
/// finds its last digits fast: measured on 1e6 points from .5 to .93, the total still fell at .9 by a third to a half.
constexpr double kStructureShare = 0.9;
/// A search may take so many operations: a facet counts as one, and so do a thousand products of the structure.
constexpr std::int64_t kMostWork = 1'000'000;

/// The polytope inside K + (-K), in the frame in which K holds the unit ball and so K + (-K) the ball of radius 2.
class WidthSearch {
 public:
  WidthSearch(const AnyBody& body, const detail::WidthStructure& structure, double stop)
      : body_(body),
        structure_(structure),
        to_unit_(body.sandwich.fattening()),
        stop_(stop),
        hull_(body.dimension(), 1) {}

  AnyWidth run() {
    push(0, static_cast<std::int32_t>(hull_.facets().size()));
    double least = std::numeric_limits<double>::infinity();
    for (;;) {
      std::pop_heap(open_.begin(), open_.end());
      const Facet nearest = open_.back();
      open_.pop_back();
      if (!hull_.alive(nearest.facet)) continue;
      result_.lower = nearest.distance;
      if (least <= (1 + stop_) * nearest.distance) break;
      const AnyVector normal = hull_.normal(nearest.facet);
      const AnyVector direction = to_unit_.pull_back(normal);
      const AnySupport most = structure_.support(direction, result_.queries);
      const AnySupport behind = structure_.support(-direction, result_.queries);
      const double width = (most.value + behind.value) / direction.norm();
      if (width < least) {
        least = width;
        result_.direction = direction;
      }
      if (least <= (1 + stop_) * nearest.distance) break;
      result_.bracket_reached = work() < kMostWork;
      if (!result_.bracket_reached) break;
      const AnyVector reach = to_unit_.linear * (most.point - behind.point);
      grow(reach, nearest);
    }
    finish();
    return result_;
  }

 private:
  struct Facet {
    double distance;
    std::int32_t facet;
    friend bool operator<(const Facet& a, const Facet& b) {
      return a.distance != b.distance ? a.distance > b.distance : a.facet > b.facet;
    }
  };

  /// The plane <normal, z> = 1 of the frame, as a distance in the body's own metric.
  void push(std::int32_t first, std::int32_t last) {
    for (std::int32_t f = first; f < last; ++f) {
      if (!hull_.alive(f)) continue;
      open_.push_back({1 / to_unit_.pull_back(hull_.normal(f)).norm(), f});
      std::push_heap(open_.begin(), open_.end());
    }
  }

  /// K + (-K) is symmetric: the point and its mirror image.
  void grow(const AnyVector& reach, const Facet& nearest) {
    const auto before = static_cast<std::int32_t>(hull_.facets().size());
    // `reach` is beyond this facet, since its width is more than (1 + stop) times the facet's distance.
    bool grown = hull_.insert(reach, nearest.facet);
    std::int64_t visited = 0;
    const AnyVector mirrored = -reach;
    const std::int32_t behind = hull_.locate(mirrored, before - 1, visited);
    if (hull_.gauge(behind, mirrored) > 1 + stop_ / 4) grown = hull_.insert(mirrored, behind) || grown;
    // Rounding keeps the point out: a little nearer to the origin it is a point of K + (-K), too.
    for (double shrink = 0x1p-36; !grown; shrink *= 64) grown = hull_.insert((1 - shrink) * reach, nearest.facet);
    push(before, static_cast<std::int32_t>(hull_.facets().size()));
  }

  [[nodiscard]] std::int64_t work() const {
    constexpr std::int64_t kProductsAFacet = 1000;
    return static_cast<std::int64_t>(hull_.facets().size()) + result_.queries.dot_products / kProductsAFacet;
  }

  void finish() {
    result_.direction.normalize();
    result_.upper = body_.support(result_.direction).value + body_.support(-result_.direction).value;
    result_.lower = std::min(result_.lower * (1 - kWidthRoom), result_.upper);
    result_.upper *= 1 + kWidthRoom;
    result_.width = result_.upper;
    result_.facets = static_cast<std::int64_t>(hull_.facets().size());
    result_.vertices = static_cast<std::int64_t>(hull_.vertices().size());
    result_.structure = structure_.size();
  }

  const AnyBody& body_;
  const detail::WidthStructure& structure_;
  AnyMap to_unit_;
  double stop_;
  detail::RadialHull hull_;
  std::vector<Facet> open_;
  AnyWidth result_;
};

Expected<AnyWidth> width_of(const AnyBody& body, double epsilon, Backend backend) {
  const pd::detail::FloatingPointGuard guard;
  if (const auto error = detail::check_epsilon(epsilon)) return *error;
  // With k = kStructureShare: (1 + (1 - k) epsilon) / (1 - k epsilon / (1 + epsilon)) = 1 + epsilon; a hair less for
  // rounding.
  const double share = epsilon * (1 - 1e-4);
  const auto prepared = detail::PreparedBody::build(body, kStructureShare * share / (1 + share), backend);
  if (!prepared) return prepared.error();
  return WidthSearch(body, *prepared->structure, (1 - kStructureShare) * share).run();
}

template <int D>
ApproximateWidth<D> fixed(const AnyWidth& r) {
  return {r.width,    r.lower,   r.upper,    detail::fixed<D>(r.direction), r.bracket_reached, r.facets,
          r.vertices, r.queries, r.structure};
}

}  // namespace

template <int D>
Expected<ApproximateWidth<D>> approximate_width(const Body<D>& body, double epsilon, Backend backend) {
  const auto width = width_of(detail::any<D>(body), epsilon, backend);
  if (!width) return width.error();
  return fixed<D>(*width);
}

template <int D>
Expected<ApproximateWidth<D>> approximate_width(const ComposedBody<D>& body, double epsilon) {
  const pd::detail::FloatingPointGuard guard;
  if (const auto error = detail::check_epsilon(epsilon)) return *error;
  // The inner polytope's share; the rest is the search's. Inside K, every width at least 1 - inner times K's:
  // (1 + rest) / (1 - inner) = 1 + epsilon, a hair less for rounding.
  constexpr double kInnerShare = 0.7;
  const double share = epsilon * (1 - 1e-4);
  const double inner = kInnerShare * share / (1 + share);
  if (inner < (body.equations() > 0 ? 1e-5 : 1e-6)) {
    return Error{ErrorCode::bad_value,
                 "the width of a composed body needs a larger epsilon: 2e-6, 2e-5 with intersections", "epsilon"};
  }
  const auto polytope = approximate_minkowski_sum<D>(body, inner, Representation::points, Side::inner);
  if (!polytope) return polytope.error();
  const auto solid = Body<D>::from_points(polytope->body.points);
  if (!solid) return solid.error();
  const auto found = approximate_width<D>(*solid, (1 - kInnerShare) * share, Backend::kernel);
  if (!found) return found;
  ApproximateWidth<D> width = *found;
  width.bracket_reached = width.bracket_reached && polytope->bracket_reached;
  // A polytope that was left coarse may promise nothing: the upper bound is infinite then.
  width.upper = width.upper / std::max(0.0, 1 - polytope->epsilon) * (1 + kWidthRoom);
  width.width = width.upper;
  return width;
}

template Expected<ApproximateWidth<2>> approximate_width<2>(const ComposedBody<2>&, double);
template Expected<ApproximateWidth<3>> approximate_width<3>(const ComposedBody<3>&, double);
template Expected<ApproximateWidth<4>> approximate_width<4>(const ComposedBody<4>&, double);
template Expected<ApproximateWidth<5>> approximate_width<5>(const ComposedBody<5>&, double);
template Expected<ApproximateWidth<2>> approximate_width<2>(const Body<2>&, double, Backend);
template Expected<ApproximateWidth<3>> approximate_width<3>(const Body<3>&, double, Backend);
template Expected<ApproximateWidth<4>> approximate_width<4>(const Body<4>&, double, Backend);
template Expected<ApproximateWidth<5>> approximate_width<5>(const Body<5>&, double, Backend);

}  // namespace pd::dimension

#include "pd/dimension/approximate_minkowski_sum.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "dimension/composed/flattened_body.hpp"
#include "dimension/composed/growing_sum.hpp"
#include "dimension/equal_planes.hpp"
#include "numeric/floating_point_guard.hpp"
#include "numeric/number_text.hpp"

namespace pd::dimension {

namespace {

using detail::AnyHalfspace;
using detail::AnyMap;
using detail::AnyVector;
using detail::Composed;
using detail::GrowingSum;
using detail::Growth;
using detail::kRoom;
using AnySum = ApproximateSum<kAnyDimension>;

std::vector<AnyVector> points_of(const GrowingSum& grown, double factor) {
  const auto& hull = grown.hull();
  std::vector<char> used(hull.vertices().size(), 0);
  for (std::size_t f = 0; f < hull.facets().size(); ++f) {
    if (!hull.alive(static_cast<std::int32_t>(f))) continue;
    for (const std::int32_t v : hull.vertices_of(static_cast<std::int32_t>(f))) used[static_cast<std::size_t>(v)] = 1;
  }
  const AnyMap back = grown.frame().inverse();
  std::vector<AnyVector> r;
  for (std::size_t v = 0; v < used.size(); ++v) {
    if (used[v] != 0) r.push_back(back.apply(factor * hull.vertices()[v]));
  }
  return r;
}

std::vector<AnyHalfspace> halfspaces_of(const GrowingSum& grown, Side side) {
  const auto& hull = grown.hull();
  const std::vector<std::int32_t> same = detail::merge_equal_planes(hull);
  std::vector<AnyHalfspace> r;
  for (std::int32_t f = 0; f < static_cast<std::int32_t>(same.size()); ++f) {
    if (same[static_cast<std::size_t>(f)] != f) continue;
    const AnyVector plane = hull.normal(f);
    const AnyVector normal = grown.frame().pull_back(plane);
    const double offset = (side == Side::outer ? grown.upper(f) : 1 - kRoom) - plane.dot(grown.frame().translation);
    const double length = normal.norm();
    r.push_back({normal / length, offset / length});
  }
  return r;
}

Expected<AnySum> approximation_of(const Composed& sum, double epsilon, Representation representation, Side side) {
  const pd::detail::FloatingPointGuard guard;
  if (!(epsilon >= 1e-6 && epsilon < 1)) {
    return Error{ErrorCode::bad_value, "epsilon must lie in [1e-6, 1)", "epsilon"};
  }
  if (sum->equations > 0 && epsilon < 1e-5) {
    return Error{ErrorCode::bad_value, "epsilon must be 1e-5 or more with an intersection inside", "epsilon"};
  }
  if (sum->equations > 0) {
    // A fifth of epsilon of the width for the intersections, half of epsilon for the polytope, the rest for their
    // product.
    const auto flat = detail::without_intersections(sum, side, epsilon / 5, epsilon / 4);
    if (!flat) return flat.error();
    auto made = approximation_of(*flat, epsilon / 2, representation, side);
    if (!made) return made;
    AnySum whole = *std::move(made);
    // The rest of epsilon went into the intersections.
    whole.epsilon = whole.bracket_reached ? epsilon : whole.epsilon + epsilon / 2;
    return whole;
  }
  GrowingSum grown(sum);
  const double needed = detail::allowed_error(*sum, grown.ratio(), epsilon / 2);
  if (sum->epsilon > needed) {
    return Error{ErrorCode::bad_value,
                 "the bodies are preprocessed at epsilon " + pd::detail::number_text(sum->epsilon) +
                     "; this query needs " + pd::detail::number_text(needed),
                 "epsilon"};
  }
  // Outer: blown up by 1 + epsilon / 2 about a point inside, no support grows by more than epsilon / 2 of the width.
  const double limit = side == Side::outer ? 1 + epsilon / 2 * (1 - 1e-4) : 1 / (1 - epsilon * (1 - 1e-4));
  const Growth growth = grown.grow(limit);
  if (growth == Growth::rounding) {
    return Error{ErrorCode::out_of_range, "the bodies are too slender for this epsilon in double precision", "epsilon"};
  }
  const double reached = grown.reached();
  AnySum r;
  r.body.representation = representation;
  r.bracket_reached = growth == Growth::reached;
  r.epsilon = r.bracket_reached     ? epsilon
              : side == Side::outer ? 2 * (reached - 1) * (1 + 1e-4)
                                    : (1 - 1 / reached) * (1 + 1e-4);
  std::vector<AnyVector> points = points_of(
      grown, side == Side::outer && representation == Representation::points ? reached * (1 + kRoom) : 1 - kRoom);
  std::vector<AnyHalfspace> halfspaces = halfspaces_of(grown, side);
  r.vertices = static_cast<std::int64_t>(points.size());
  r.facets = static_cast<std::int64_t>(halfspaces.size());
  if (representation == Representation::points) {
    r.body.points = std::move(points);
  } else {
    r.body.halfspaces = std::move(halfspaces);
  }
  r.support_calls = grown.supports();
  r.counters = grown.counters();
  return r;
}

}  // namespace

template <int D>
Expected<ApproximateSum<D>> approximate_minkowski_sum(const ComposedBody<D>& sum, double epsilon,
                                                      Representation representation, Side side) {
  const auto r = approximation_of(sum.node(), epsilon, representation, side);
  if (!r) return r.error();
  return ApproximateSum<D>{{representation, detail::fixed<D>(r->body.points), detail::fixed<D>(r->body.halfspaces)},
                           r->epsilon,
                           r->bracket_reached,
                           r->support_calls,
                           r->vertices,
                           r->facets,
                           r->counters};
}

#define PD_INSTANTIATE(D)                                                                                           \
  template Expected<ApproximateSum<D>> approximate_minkowski_sum<D>(const ComposedBody<D>&, double, Representation, \
                                                                    Side);
PD_INSTANTIATE(2)
PD_INSTANTIATE(3)
PD_INSTANTIATE(4)
PD_INSTANTIATE(5)
#undef PD_INSTANTIATE

}  // namespace pd::dimension

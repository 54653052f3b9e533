#include "pd/depth/shallow_penetration.hpp"

#include "depth/pair/canonical_order.hpp"
#include "depth/pair/shallow_depth.hpp"
#include "numeric/floating_point_guard.hpp"
#include "pd/depth/scratch.hpp"

namespace pd {

Expected<ShallowPenetration> shallow_penetration(const PosedShape& a, const PosedShape& b, Scratch& scratch,
                                                 double delta, Bracket bracket, std::int64_t max_directions) {
  const detail::FloatingPointGuard guard;
  if (!(delta > 0 && delta <= 1)) return Error{ErrorCode::bad_value, "delta must lie in (0, 1]", "delta"};
  const ConvexPolytope* const polytope_a = a.shape->polytope();
  const ConvexPolytope* const polytope_b = b.shape->polytope();
  if (!polytope_a || !polytope_b) {
    return Error{ErrorCode::unsupported, "the facets near the origin are those of polytopes (with or without margins)",
                 ""};
  }
  const Expected<DirectionGrid> grid =
      direction_grid(GridKind::geodesic, delta / 4, GridExtent::sphere, max_directions);
  if (!grid)
    return Error{grid.error().code, "the rays go to a grid of delta / 4, and " + grid.error().message, "delta"};
  ShallowPenetration result;
  DepthSettings settings;
  settings.bracket = bracket;
  detail::shallow_depth({polytope_a, polytope_b, &a.pose, &b.pose, {a.shape->margin(), b.shape->margin()}}, delta,
                        *grid, settings, scratch.buffers(), result.answer, result.counts);
  detail::clear_negative_zeros(result.answer);
  return result;
}

}  // namespace pd

#include "depth/pair/shallow_depth.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "depth/rays/shallow_facets.hpp"
#include "numeric/floating_point_guard.hpp"
#include "pd/depth/scratch.hpp"

namespace pd {

namespace detail {

void shallow_depth(const PolytopePair& pair, double delta, const DirectionGrid& grid, const DepthSettings& settings,
                   ScratchBuffers& buffers, PenetrationDepth& out, ShallowCounts& counts) {
  DepthSettings roughly;
  roughly.delta = 1;
  PenetrationDepth cores;
  polytope_depth({pair.a, pair.b, pair.pose_a, pair.pose_b, {}}, roughly, buffers, nullptr, cores);
  const bool thin = pair.a->affine_dimension() < 2 || pair.b->affine_dimension() < 2;
  if (cores.contact != ContactClass::overlapping || thin) {
    DepthSettings exactly;
    exactly.bracket = settings.bracket;
    exactly.method = thin ? Method::overlay : Method::automatic;
    polytope_depth(pair, exactly, buffers, nullptr, out);
    counts.visited = out.statistics.facets_visited;
    out.method = Method::shallow;
    return;
  }

  // Steps 1 and 2: Delta <= (1 + delta / 4) pi.
  const PosedPair posed(*pair.a, *pair.pose_a, *pair.b, *pair.pose_b);
  PolytopeShooter shooter(posed);
  struct Ray {
    double lower;
    std::array<VertexPair, 3> corners;
  };
  std::vector<Ray> rays;
  rays.reserve(grid.directions.size());
  double shortest = std::numeric_limits<double>::infinity();
  for (const Vec3& direction : grid.directions) {
    const RayShot shot = shooter.shoot(direction);
    shortest = std::min(shortest, shot.upper);
    rays.push_back({shot.lower, shooter.corners()});
  }
  counts.directions = static_cast<std::int64_t>(rays.size());

  // Steps 3 to 5, seeds corrected. Directions are unit up to 2 ulp, far below the slack.
  constexpr double kSlack = 1 + 1e-12;
  counts.radius = (1 + delta / 2) * shortest * kSlack;
  const OverlayWalk walk(posed, buffers.overlay.overlay);
  ShallowSearch search(walk, std::ldexp(counts.radius, -posed.scale_exponent()));
  for (const Ray& ray : rays) {
    if (ray.lower <= (1 + delta / 4) * shortest * kSlack) search.add_seed(ray.corners);
  }
  search.run();
  counts.seeds = search.seeds();
  counts.visited = static_cast<std::int64_t>(search.visited().size());
  counts.steps = search.steps();
  counts.degrees = search.degrees();

  finish_overlapping(posed, nearest_piece(walk, search.visited()), pair.margins, settings.bracket, buffers.faces, out);
  out.method = Method::shallow;
  out.statistics.support_calls = cores.statistics.support_calls + shooter.support_calls();
  out.statistics.facets_visited = cores.statistics.facets_visited + counts.visited;
  out.statistics.exact_signs = cores.statistics.exact_signs + posed.stages().double_double + posed.stages().exact;
}

}  // namespace detail

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
  if (!grid) return grid.error();
  ShallowPenetration result;
  DepthSettings settings;
  settings.bracket = bracket;
  detail::shallow_depth({polytope_a, polytope_b, &a.pose, &b.pose, {a.shape->margin(), b.shape->margin()}}, delta,
                        *grid, settings, scratch.buffers(), result.answer, result.counts);
  result.answer.translation.array() += 0.0;
  result.answer.normal.array() += 0.0;
  return result;
}

}  // namespace pd

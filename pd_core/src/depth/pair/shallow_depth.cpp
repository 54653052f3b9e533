#include "depth/pair/shallow_depth.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "depth/pair/core_class.hpp"
#include "depth/rays/shallow_facets.hpp"

namespace pd::detail {

void shallow_depth(const PolytopePair& pair, double delta, const DirectionGrid& grid, const DepthSettings& settings,
                   ScratchBuffers& buffers, PenetrationDepth& out, ShallowCounts& counts) {
  const PenetrationDepth cores = coarse_core_depth(pair, buffers);
  const auto answer_by = [&](Method method) {
    DepthSettings exact;
    exact.bracket = settings.bracket;
    exact.method = method;
    polytope_depth(pair, exact, buffers, nullptr, out);
    counts.visited = out.statistics.facets_visited;
    out.method = Method::shallow;
  };
  const bool thin = pair.a->affine_dimension() < 2 || pair.b->affine_dimension() < 2;
  if (cores.contact != ContactClass::overlapping || thin) {
    answer_by(thin ? Method::overlay : Method::automatic);
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

  const std::optional<FacetOfDifference> nearest = nearest_piece(walk, search.visited());
  if (!nearest) {
    // Bodies of which one is a rounding beside the other: no ray met a facet that is whole.
    answer_by(Method::automatic);
    return;
  }
  answer_overlapping(posed, *nearest, pair.margins, settings.bracket, buffers.faces, out);
  out.method = Method::shallow;
  out.statistics.support_calls = cores.statistics.support_calls + shooter.support_calls();
  out.statistics.facets_visited = cores.statistics.facets_visited + counts.visited;
  out.statistics.exact_signs = cores.statistics.exact_signs + posed.stages().double_double + posed.stages().exact;
}

}  // namespace pd::detail

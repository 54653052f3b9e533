#include "pd/depth/approximate_separation.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <optional>

#include "depth/certificate/exact_answer.hpp"
#include "depth/pair/core_class.hpp"
#include "depth/pair/scratch_buffers.hpp"
#include "depth/rays/hierarchy_descent.hpp"
#include "depth/rays/ray_shooting.hpp"
#include "numeric/floating_point_guard.hpp"
#include "pd/depth/scratch.hpp"
#include "pd/shape/convex_shape.hpp"

namespace pd {

namespace {

/// Left of delta for the roundings of the rays: 2^-47 of their length each way, and the grid's.
constexpr double kRoundings = 0x1p-44;

void take(const PenetrationDepth& answer, ApproximateSeparation& out) {
  out.contact = answer.contact;
  out.lower = answer.lower;
  out.upper = answer.upper;
  out.translation = answer.translation;
  out.normal = answer.normal;
  out.statistics = answer.statistics;
}

/// Steps 2 and 3 for cores that overlap.
void shoot_all(const detail::PolytopePair& pair, const DirectionGrid& grid,
               const detail::PortalHierarchies& hierarchies, detail::ScratchBuffers& buffers,
               ApproximateSeparation& out) {
  const detail::PosedPair posed(*pair.a, *pair.pose_a, *pair.b, *pair.pose_b);
  detail::PolytopeShooter shooter(posed, hierarchies);
  double least_lower = std::numeric_limits<double>::infinity(), least_height = least_lower;
  for (const Vec3& direction : grid.directions) {
    const detail::RayShot shot = shooter.shoot(direction);
    if (shot.lower < least_lower) {
      least_lower = shot.lower;
      out.shortest_ray = (shot.upper + pair.margins.both() / direction.norm()) * direction;
    }
    if (shot.height < least_height) {
      least_height = shot.height;
      shooter.keep();
    }
  }
  PenetrationDepth nearest;
  const detail::ExactDirection normal(shooter.kept().normal);
  answer_overlapping(posed, facet_of_direction(posed, normal), pair.margins, Bracket::tightest, buffers.faces, nearest);
  take(nearest, out);
  // Directions are unit up to 2 ulp.
  const double core = grid.cosine * least_lower * (1 - 0x1p-50);
  out.lower = std::min(nearest.lower, (core + pair.margins.both()) * (1 - 0x1p-51));
  out.rays = shooter.shots();
  out.ray_supports = shooter.support_calls();
  out.statistics.facets_visited = shooter.shots();
  out.statistics.exact_signs = posed.stages().double_double + posed.stages().exact;
}

}  // namespace

Expected<ApproximateSeparation> approximate_separation(const PosedShape& a, const PosedShape& b, double delta,
                                                       Scratch& scratch,
                                                       const ApproximateSeparationSettings& settings) {
  const detail::FloatingPointGuard guard;
  if (!(delta > 0 && delta <= 1)) return Error{ErrorCode::bad_value, "delta must lie in (0, 1]", "delta"};
  const ConvexPolytope* const polytope_a = a.shape->polytope();
  const ConvexPolytope* const polytope_b = b.shape->polytope();
  if (!polytope_a || !polytope_b) {
    return Error{ErrorCode::unsupported, "these rays end on facets of polytopes (with or without margins)", ""};
  }
  if (settings.shot == DirectionalMethod::overlay) {
    return Error{ErrorCode::unsupported, "a ray is shot by portal or hierarchy", "shot"};
  }
  Expected<DirectionGrid> grid =
      direction_grid(settings.grid, std::max(delta - kRoundings, delta / 2), GridExtent::sphere, settings.max_rays);
  if (!grid) {
    return Error{grid.error().code, "the rays go to a grid of delta less roundings, and " + grid.error().message,
                 "delta"};
  }

  detail::PortalHierarchies hierarchies;
  std::array<std::optional<PolyhedralHierarchy>, 2> built;
  if (settings.shot == DirectionalMethod::hierarchy) {
    if (settings.hierarchies != nullptr) {
      const auto& [given_a, given_b] = *settings.hierarchies;
      if (const auto error = detail::refuse_hierarchy(given_a, *polytope_a, "hierarchies.a")) return *error;
      if (const auto error = detail::refuse_hierarchy(given_b, *polytope_b, "hierarchies.b")) return *error;
      hierarchies = {settings.hierarchies->a, settings.hierarchies->b};
    } else {
      for (const std::size_t side : {0U, 1U}) {
        Expected<PolyhedralHierarchy> hierarchy =
            PolyhedralHierarchy::build(side == 0 ? *polytope_a : *polytope_b, HierarchyKind::inner);
        if (!hierarchy) return hierarchy.error();
        built[side] = *std::move(hierarchy);
      }
      hierarchies = {&*built[0], &*built[1]};
    }
  }

  // [A] tests first whether the bodies meet: here by a coarse depth of the cores, whose class is exact.
  const detail::PolytopePair pair{polytope_a, polytope_b, &a.pose, &b.pose, {a.shape->margin(), b.shape->margin()}};
  ApproximateSeparation out;
  const PenetrationDepth cores = coarse_core_depth(pair, scratch.buffers());
  if (cores.contact == ContactClass::overlapping) {
    shoot_all(pair, *grid, hierarchies, scratch.buffers(), out);
  } else {
    PenetrationDepth exact;
    polytope_depth(pair, {}, scratch.buffers(), nullptr, exact);
    take(exact, out);
  }
  out.statistics.support_calls += cores.statistics.support_calls + out.ray_supports;
  out.statistics.facets_visited += cores.statistics.facets_visited;
  out.statistics.exact_signs += cores.statistics.exact_signs;
  out.translation.array() += 0.0;  // no negative zeros
  out.normal.array() += 0.0;
  return out;
}

}  // namespace pd

#include "pd/depth/polyhedral_depth.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "depth/difference/exact_support.hpp"
#include "depth/rays/ray_shooting.hpp"
#include "numeric/floating_point_guard.hpp"
#include "numeric/length.hpp"
#include "numeric/root_sum.hpp"
#include "pd/depth/scratch.hpp"
#include "pd/numeric/predicates.hpp"

namespace pd {

namespace {

using detail::Dyadic;
using detail::PairVector;
using detail::PosedPair;

/// Why a body is no unit ball, or nothing.
std::optional<Error> refusal(const ConvexPolytope& ball) {
  if (ball.affine_dimension() < 3) {
    return Error{ErrorCode::not_full_dimensional, "a metric needs a solid body with the origin inside", "metric"};
  }
  for (int f = 0; f < ball.num_facets(); ++f) {
    const auto loop = ball.facet_vertices(f);
    if (orient3d(ball.vertex(loop[0]), ball.vertex(loop[1]), ball.vertex(loop[2]), Vec3::Zero()) < 0) continue;
    return Error{ErrorCode::bad_value,
                 "the origin must lie inside the metric's body; it does not lie behind the facet through vertices " +
                     std::to_string(ball.caller_id(loop[0])) + ", " + std::to_string(ball.caller_id(loop[1])) + ", " +
                     std::to_string(ball.caller_id(loop[2])) + "; move the body so that the origin is its centre",
                 "metric"};
  }
  return std::nullopt;
}

/// lambda q, lengthened by ulps until it lies outside int P, exactly.
Vec3 separating_multiple(const PosedPair& pair, const detail::PolytopeShooter::Plane& plane, const Vec3& q,
                         double lambda) {
  for (int ulps = 0;; ulps = 2 * ulps + 1) {
    const Vec3 t = lambda * (1 + ulps * 0x1p-52) * q;
    if ((dot(plane.normal, detail::to_dyadic(t)) * pair.homogeneous_factor() - plane.offset).sign() >= 0) return t;
  }
}

}  // namespace

Expected<PenetrationDepth> polyhedral_depth(const PosedShape& a, const PosedShape& b, const ConvexPolytope& unit_ball,
                                            Scratch& scratch) {
  const detail::FloatingPointGuard guard;
  if (std::optional<Error> error = refusal(unit_ball)) return *error;
  const ConvexPolytope* const polytope_a = a.shape->polytope();
  const ConvexPolytope* const polytope_b = b.shape->polytope();
  if (!polytope_a || !polytope_b || a.shape->margin() > 0 || b.shape->margin() > 0) {
    return Error{ErrorCode::unsupported, "polyhedral metrics are for polytopes without a margin", ""};
  }
  DepthSettings roughly;
  roughly.delta = 1;
  PenetrationDepth out = penetration_depth(a, b, scratch, roughly);
  if (out.contact != ContactClass::overlapping) return penetration_depth(a, b, scratch);
  Statistics statistics = out.statistics;
  out = PenetrationDepth();
  out.contact = ContactClass::overlapping;

  const PosedPair pair(*polytope_a, a.pose, *polytope_b, b.pose);
  detail::PolytopeShooter shooter(pair);
  // lambda = offset / (slope factor), with one factor for all rays.
  detail::PolytopeShooter::Plane best;
  Dyadic best_slope;
  std::array<detail::VertexPair, 3> corners{};
  int vertex = -1;
  for (int v = 0; v < unit_ball.num_vertices(); ++v) {
    shooter.shoot(unit_ball.vertex(v));
    const detail::PolytopeShooter::Plane& plane = shooter.plane();
    const Dyadic slope = dot(plane.normal, detail::to_dyadic(unit_ball.vertex(v)));
    if (vertex >= 0 && (plane.offset * best_slope - best.offset * slope).sign() >= 0) continue;
    best = plane;
    best_slope = slope;
    corners = shooter.corners();
    vertex = v;
  }
  const Vec3 q = unit_ball.vertex(vertex);
  const Dyadic denominator = best_slope * pair.homogeneous_factor();
  const detail::RootSum exact(Dyadic(0.0), 1, best.offset * best.offset, denominator * denominator);
  out.lower = exact.round_down();
  out.upper = exact.round_up(out.lower);
  out.depth = std::clamp(detail::to_double(exact.approximate()), out.lower, out.upper);
  out.translation = separating_multiple(pair, best, q, out.upper);
  out.translation.array() += 0.0;
  out.normal = detail::unit_vector(q);
  out.normal.array() += 0.0;
  out.witness_a = crossing_on_a(pair, corners, detail::unit_vector(q));
  out.witness_b = out.witness_a + out.translation;
  const detail::FacetOfDifference facet = facet_of_direction(pair, detail::ExactDirection(best.normal));
  out.feature_a = facet.on_a;
  out.feature_b = facet.on_b;
  statistics.support_calls += shooter.support_calls();
  statistics.facets_visited += shooter.shots();
  statistics.exact_signs += pair.stages().double_double + pair.stages().exact;
  out.statistics = statistics;
  return out;
}

}  // namespace pd

#include "depth/pair/grid_depth.hpp"

#include <algorithm>

#include "depth/pair/core_class.hpp"
#include "depth/pair/scaled_shape.hpp"
#include "depth/pair/smooth_depth.hpp"
#include "depth/rays/round_frame.hpp"

namespace pd::detail {

namespace {

[[gnu::cold]] void polytope_grid(const PolytopePair& pair, double delta, const DepthSettings& settings,
                                 ScratchBuffers& buffers, PenetrationDepth& out) {
  const PenetrationDepth cores = coarse_core_depth(pair, buffers);
  if (cores.contact != ContactClass::overlapping) {
    DepthSettings exactly;
    exactly.bracket = settings.bracket;
    polytope_depth(pair, exactly, buffers, nullptr, out);
    return;
  }
  const PosedPair posed(*pair.a, *pair.pose_a, *pair.b, *pair.pose_b);
  PolytopeShooter shooter(posed);
  const DirectionRefinementResult found = DirectionRefinement(shooter, delta, 20, round_frame(posed)).run();
  answer_overlapping(posed, facet_of_direction(posed, ExactDirection(shooter.kept().normal)), pair.margins,
                     settings.bracket, buffers.faces, out);
  // Among planes that doubles cannot distinguish, the projection of the origin may lie on another one's facet: the ray
  // finds it.
  const PolytopeShooter::Plane best = shooter.kept();
  shooter.shoot(out.normal);
  const Dyadic3 turned = cross(best.normal, shooter.plane().normal);
  if (turned.x.sign() != 0 || turned.y.sign() != 0 || turned.z.sign() != 0) {
    out.witness_a = crossing_on_a(posed, shooter.corners(), out.normal) - pair.margins.a * out.normal;
    out.witness_b = out.witness_a + out.translation;
  }
  out.bracket_reached = found.reached;
  out.lower = std::min(out.lower, (found.lower + pair.margins.a + pair.margins.b) * (1 - 0x1p-50));
  out.statistics.support_calls = cores.statistics.support_calls + shooter.support_calls();
  out.statistics.facets_visited = cores.statistics.facets_visited + shooter.shots();
  out.statistics.exact_signs = cores.statistics.exact_signs + posed.stages().double_double + posed.stages().exact;
}

[[gnu::cold]] void smooth_grid(const PosedShape& a, const PosedShape& b, double delta, const DepthSettings& settings,
                               ScratchBuffers& buffers, PenetrationDepth& out) {
  DepthSettings coarse;
  coarse.delta = 1;
  smooth_depth(a, b, coarse, buffers, out);
  if (out.contact != ContactClass::overlapping || !(out.lower > 0)) {
    out = PenetrationDepth();
    smooth_depth(a, b, settings, buffers, out);
    return;
  }
  const Statistics before = out.statistics;
  // A sixteenth of delta goes to the ends of the rays.
  SweptShooter shooter(a, b, buffers.points, out.lower, delta / 16);
  const DirectionRefinementResult found = DirectionRefinement(shooter, delta, 20).run();
  shooter.shoot(found.normal);
  out = PenetrationDepth();
  out.contact = ContactClass::overlapping;
  out.bracket_reached = found.reached;
  out.lower = found.lower;
  out.depth = found.upper;
  out.upper = found.upper * (1 + 0x1p-50);
  out.normal = found.normal;
  out.translation = out.depth * out.normal;
  out.witness_a = shooter.crossing().on_a + a.pose.translation();
  out.witness_b = out.witness_a + out.translation;
  out.statistics.support_calls = before.support_calls + shooter.support_calls();
  out.statistics.facets_visited = before.facets_visited + shooter.shots();
}

}  // namespace

void grid_depth(const PosedShape& a, const PosedShape& b, const DepthSettings& settings, ScratchBuffers& buffers,
                PenetrationDepth& out) {
  const double delta = settings.delta > 0 ? settings.delta : kDefaultGridDelta;
  const ConvexPolytope* const polytope_a = a.shape->polytope();
  const ConvexPolytope* const polytope_b = b.shape->polytope();
  if (polytope_a && polytope_b) {
    polytope_grid({polytope_a, polytope_b, &a.pose, &b.pose, {a.shape->margin(), b.shape->margin()}}, delta, settings,
                  buffers, out);
  } else if (const int exponent = extreme_exponent(a, b); exponent != 0) {
    const ScaledPair near(a, b, exponent);
    smooth_grid(near.a(), near.b(), delta, settings, buffers, out);
    scale_answer(out, exponent);
    out.witness_a += a.pose.translation();
    out.witness_b += a.pose.translation();
  } else {
    smooth_grid(a, b, delta, settings, buffers, out);
  }
  out.method = Method::grid;
}

}  // namespace pd::detail

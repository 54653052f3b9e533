#include "pd/depth/width.hpp"

#include <algorithm>
#include <limits>

#include "depth/expansion/exact_expanding_polytope.hpp"
#include "depth/facets/overlay_depth.hpp"
#include "depth/pair/grid_depth.hpp"
#include "depth/pair/scratch_buffers.hpp"
#include "depth/rays/round_frame.hpp"
#include "numeric/floating_point_guard.hpp"
#include "numeric/root_sum.hpp"
#include "pd/depth/scratch.hpp"

namespace pd {

namespace {

using detail::Dyadic;
using detail::Dyadic3;
using detail::ExactDirection;
using detail::PosedPair;

/// margins + sqrt(numerator / denominator), rounded down and up.
void fill(const Dyadic& margins, const Dyadic& numerator, const Dyadic& denominator, Width& out) {
  const detail::RootSum exact(margins, 1, numerator, denominator);
  out.lower = exact.round_down();
  out.upper = exact.round_up(out.lower);
  out.width = std::clamp(detail::to_double(exact.approximate()), out.lower, out.upper);
}

/// A unit vector orthogonal to the direction.
Vec3 orthogonal(const Vec3& direction) {
  int least = 0;
  direction.cwiseAbs().minCoeff(&least);
  return direction.cross(Vec3::Unit(least)).normalized();
}

Vec3 normal_of_flat(const PosedPair& pair) {
  const ConvexPolytope& body = pair.a();
  const auto unit = [](const Dyadic3& v) { return ExactDirection(v).unit; };
  if (body.affine_dimension() == 0) return Vec3::UnitX();
  if (body.affine_dimension() == 1) return orthogonal(unit(pair.exact(detail::PairVector::edge_a(0, 1))));
  const auto corner = detail::FacetOfDifference::corners(body, 0);
  return unit(cross(pair.exact(detail::PairVector::edge_a(corner[0], corner[1])),
                    pair.exact(detail::PairVector::edge_a(corner[0], corner[2]))));
}

/// The plane of the best ray is exact, the bound from below that of the cells ([A] Corollary 3.3).
void grid_width(const PosedPair& pair, const Dyadic& margins, double delta, Width& out) {
  detail::PolytopeShooter shooter(pair);
  constexpr std::size_t kHalfTheFaces = 10;
  const detail::DirectionRefinementResult found =
      detail::DirectionRefinement(shooter, delta > 0 ? delta : detail::kDefaultGridDelta, kHalfTheFaces,
                                  detail::round_frame(pair))
          .run();
  out.bracket_reached = found.reached;
  const detail::PolytopeShooter::Plane& plane = shooter.kept();
  const Dyadic& factor = pair.homogeneous_factor();
  fill(margins, plane.offset * plane.offset, dot(plane.normal, plane.normal) * factor * factor, out);
  out.width = out.upper;
  out.lower = std::min(out.lower, (Dyadic(found.lower) + margins).round_down());
  out.normal = ExactDirection(plane.normal).unit;
  out.statistics.support_calls = shooter.support_calls();
  out.statistics.facets_visited = shooter.shots();
}

void polytope_width(const ConvexPolytope& body, const Pose& pose, const Dyadic& margins, Method method, double delta,
                    detail::ScratchBuffers& buffers, Width& out) {
  const PosedPair pair(body, pose, body, pose);
  if (body.affine_dimension() < 3) {
    fill(margins, Dyadic(0.0), Dyadic(1.0), out);
    out.normal = normal_of_flat(pair);
    return;
  }
  if (method == Method::grid) {
    grid_width(pair, margins, delta, out);
  } else if (method == Method::expansion) {
    const detail::VertexPair start{0, body.num_vertices() - 1};
    const detail::ExactDepth exact = detail::exact_expanding_polytope(pair, &start, 1, std::numeric_limits<int>::max());
    fill(margins, exact.squared.numerator, exact.squared.denominator, out);
    out.normal = exact.normal->unit;
    out.statistics.support_calls = exact.support_calls;
    out.statistics.facets_visited = exact.facets_visited;
  } else {
    const detail::OverlayDepth nearest = detail::overlay_depth(pair, buffers.overlay);
    const ExactDirection normal(cross(pair.exact(nearest.facet.u), pair.exact(nearest.facet.v)));
    // Points are homogeneous of degree one in the pair's factor; the normal's own factors cancel.
    const Dyadic offset = dot(pair.exact(nearest.facet.point()), normal.exact);
    const Dyadic& factor = pair.homogeneous_factor();
    fill(margins, offset * offset, dot(normal.exact, normal.exact) * factor * factor, out);
    out.normal = normal.unit;
    out.statistics.facets_visited = nearest.facets_visited;
  }
  out.statistics.exact_signs = pair.stages().double_double + pair.stages().exact;
}

/// Width and normal in the body's own frame.
void smooth_width(const Ellipsoid& e, const Dyadic& margins, Width& out) {
  int least = 0;
  const double radius = e.radii.minCoeff(&least);
  fill(margins + Dyadic(radius).scaled(1), Dyadic(0.0), Dyadic(1.0), out);
  out.normal = Vec3::Unit(least);
}

void smooth_width(const Cylinder& c, const Dyadic& margins, Width& out) {
  // The width in a direction at the angle x to the axis is 2 (h cos x + r sin x), concave: least at an end.
  const bool across = c.radius < c.half_height;
  fill(margins + Dyadic(std::min(c.radius, c.half_height)).scaled(1), Dyadic(0.0), Dyadic(1.0), out);
  out.normal = Vec3::Unit(across ? (c.axis + 1) % 3 : c.axis);
}

void smooth_width(const Cone& c, const Dyadic& margins, Width& out) {
  // At the angle x to the axis the width is max(H cos x + r sin x, 2 r sin x): concave, then growing past tan x = H /
  // r. Its least value is at x = 0 or where the two meet, which is the distance of a generator from the base circle's
  // far point.
  const Dyadic r(c.radius), h = Dyadic(c.half_height).scaled(1);
  const Dyadic rr = r * r, hh = h * h;
  if ((rr + rr.scaled(1) - hh).sign() >= 0) {
    fill(margins + h, Dyadic(0.0), Dyadic(1.0), out);
    out.normal = Vec3::Unit(c.axis);
  } else {
    fill(margins, (rr * hh).scaled(2), rr + hh, out);
    const double ratio = c.radius / (2 * c.half_height);
    out.normal = (Vec3::Unit(c.axis) * ratio + Vec3::Unit((c.axis + 1) % 3)).normalized();
  }
}

/// [A] Proposition 2.1.
Width width_by_depth(const PosedShape& body, Scratch& scratch, double delta) {
  const PenetrationDepth self = penetration_depth(body, body, scratch, {.delta = delta});
  Width out;
  out.width = self.depth;
  out.lower = self.lower;
  out.upper = self.upper;
  out.bracket_reached = self.bracket_reached;
  out.normal = self.normal;
  out.statistics = self.statistics;
  return out;
}

}  // namespace

Width width(const PosedShape& body, Scratch& scratch, Method method, double delta) {
  const detail::FloatingPointGuard guard;
  Width out;
  const Dyadic margins = Dyadic(body.shape->margin()).scaled(1);
  if (const ConvexPolytope* polytope = body.shape->polytope()) {
    polytope_width(*polytope, body.pose, margins, method, delta, scratch.buffers(), out);
    return out;
  }
  if (const auto* ellipsoid = std::get_if<Ellipsoid>(&body.shape->core())) smooth_width(*ellipsoid, margins, out);
  if (const auto* cylinder = std::get_if<Cylinder>(&body.shape->core())) smooth_width(*cylinder, margins, out);
  if (const auto* cone = std::get_if<Cone>(&body.shape->core())) smooth_width(*cone, margins, out);
  if (std::get_if<SphereHull>(&body.shape->core()) != nullptr) return width_by_depth(body, scratch, delta);
  out.normal = (body.pose.nearest_rotation() * out.normal).normalized();
  return out;
}

}  // namespace pd

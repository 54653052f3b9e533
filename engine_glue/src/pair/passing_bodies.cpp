#include "pair/passing_bodies.hpp"

#include <algorithm>

#include "pd/bullet/scalar.hpp"
#include "pd/contact/farthest_point.hpp"
#include "pieces/piece_wrapper.hpp"

namespace pd::detail {

bool on_one_line(const FreshPoints& points, btScalar width) {
  const auto from_first = [&](std::size_t k) { return points.points[k].point_on_b - points.points[0].point_on_b; };
  const auto narrow = [&](std::size_t i, std::size_t k) {
    const btVector3 x = from_first(i), y = from_first(k);
    return x.cross(y).length2() <= width * width * std::max(x.length2(), y.length2());
  };
  if (points.count < 3) return points.count > 0;
  return narrow(1, 2) && (points.count < 4 || (narrow(1, 3) && narrow(2, 3)));
}

bool pass_each_other(const PosedShape& a, const PosedShape& b, const FreshPoints& points, const StepReach& step) {
  if (!step.against_fixed()) return false;
  const double slack = seam_slack(a, b);
  const auto end = points.points.begin() + points.count;
  const auto pushes = [&](const FreshPoint& point) {
    return step.closed_in_step(point.point_on_b, point.normal) > point.distance + static_cast<btScalar>(slack);
  };
  if (std::none_of(points.points.begin(), end, pushes)) return false;
  const auto stay_apart = [&](const Vec3& normal) {
    const double overlap = reach_along(a, b, normal);
    if (!(overlap <= slack)) return false;
    const auto left = static_cast<btScalar>(slack - overlap);
    return std::all_of(points.points.begin(), end, [&](const FreshPoint& point) {
      return step.closed_in_step(point.point_on_b, to_bullet(normal)) <= left;
    });
  };
  const FreshPoint& first = points.points[0];
  const btVector3 on_a = first.point_on_b + first.distance * first.normal;
  const auto along_a_facet = [&](const PosedShape& body, const btVector3& on_other, double outwards) {
    const ConvexPolytope* const polytope = body.shape->polytope();
    if (polytope == nullptr) return false;
    const Vec3 other = body.pose.rotation().transpose() * (to_pd(on_other) - body.pose.translation());
    for (int f = 0; f < polytope->num_facets(); ++f) {
      const Vec3& normal = polytope->facet_normal(f);
      // Most facets have the other body's point under them.
      if (normal.dot(polytope->vertex(polytope->facet_vertices(f)[0]) - other) > 2 * slack) continue;
      if (stay_apart(body.pose.rotation() * (outwards * normal))) return true;
    }
    return false;
  };
  return along_a_facet(b, on_a, 1) || along_a_facet(a, first.point_on_b, -1);
}

}  // namespace pd::detail

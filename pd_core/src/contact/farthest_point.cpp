#include "pd/contact/farthest_point.hpp"

#include <cmath>

#include "depth/difference/smooth_difference.hpp"

namespace pd {

Vec3 farthest_point(const PosedShape& posed, const Vec3& direction) {
  const ConvexPolytope* const polytope = posed.shape->polytope();
  if (polytope == nullptr) {
    const Mat3 rotation = posed.pose.nearest_rotation();
    return rotation * detail::support_point(posed.shape->core(), rotation.transpose() * direction) +
           posed.pose.translation();
  }
  const Vec3 local = posed.pose.rotation().transpose() * direction;
  int farthest = 0;
  double most = -HUGE_VAL;
  for (int v = 0; v < polytope->num_vertices(); ++v) {
    const double value = polytope->vertex(v).dot(local);
    if (value > most) {
      most = value;
      farthest = v;
    }
  }
  return posed.pose.apply(polytope->vertex(farthest));
}

double reach_along(const PosedShape& a, const PosedShape& b, const Vec3& n) {
  return (farthest_point(b, n) - farthest_point(a, -n)).dot(n) + a.shape->margin() + b.shape->margin();
}

}  // namespace pd

#include "pd/contact/farthest_point.hpp"

#include <cmath>

#include "depth/difference/smooth_difference.hpp"
#include "numeric/length.hpp"
#include "shape/support/vertex_arrays.hpp"

namespace pd {

namespace {

/// Formulas of curved bodies square directions, times their sizes.
constexpr double kLeastSquared = 0x1p-100;

}  // namespace

Vec3 farthest_point(const PosedShape& posed, const Vec3& direction) {
  const ConvexPolytope* const polytope = posed.shape->polytope();
  if (polytope == nullptr) {
    const Mat3 rotation = posed.pose.nearest_rotation();
    const double largest = direction.cwiseAbs().maxCoeff();
    const bool extreme =
        !(largest > kLeastSquared && largest < 1 / kLeastSquared) && largest > 0 && std::isfinite(largest);
    const Vec3 along = extreme ? detail::unit_vector(direction) : direction;
    return rotation * detail::support_point(posed.shape->core(), rotation.transpose() * along) +
           posed.pose.translation();
  }
  const Vec3 local = posed.pose.rotation().transpose() * direction;
  const int farthest = detail::farthest_vertex(detail::arrays_of(*polytope), local.x(), local.y(), local.z());
  return posed.pose.apply(polytope->vertex(farthest));
}

double reach_along(const PosedShape& a, const PosedShape& b, const Vec3& n) {
  return (farthest_point(b, n) - farthest_point(a, -n)).dot(n) + a.shape->margin() + b.shape->margin();
}

}  // namespace pd

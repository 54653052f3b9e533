#include "depth/features/thinnest_axis.hpp"

#include <algorithm>
#include <limits>

#include "depth/expansion/initial_simplex.hpp"

namespace pd::detail {

WayOut thinnest_axis(const PosedShape& a, const PosedShape& b, const SmoothDifference& difference) {
  WayOut best{Vec3::UnitX(), std::numeric_limits<double>::infinity()};
  const auto try_along = [&](const Vec3& n) {
    const double h = difference.support(n, nullptr).x.dot(n) + support_plane_error(difference);
    if (h < best.upper) best = {n, std::max(0.0, h)};
  };
  const auto try_both_ways = [&](const Vec3& n) {
    try_along(n);
    try_along(-n);
  };
  for (const PosedShape* body : {&a, &b}) {
    const Mat3 rotation = body->pose.nearest_rotation();
    for (int axis = 0; axis < 3; ++axis) try_both_ways(rotation.col(axis));
    const ConvexPolytope* polytope = body->shape->polytope();
    if (polytope == nullptr) continue;
    if (polytope->affine_dimension() == 2) try_both_ways((rotation * polytope->facet_normal(0)).normalized());
    if (polytope->affine_dimension() != 1) continue;
    Vec3 across, other;
    frame_across((rotation * (polytope->vertex(1) - polytope->vertex(0))).normalized(), across, other);
    try_both_ways(across.normalized());
    try_both_ways(other.normalized());
  }
  return best;
}

}  // namespace pd::detail

#include "structure/hierarchy/plane_descent.hpp"

#include <cmath>

namespace pd::detail {

/// Any direction across will do; one that is in no simple ratio to the body's edges has fewer ties.
Vec3 sideways_of(const Vec3& direction) {
  int least = 0;
  direction.cwiseAbs().minCoeff(&least);
  const Vec3 across = direction.cross(Vec3::Unit(least));
  return across + 0.6180339887498949 * direction.cross(across) / direction.cwiseAbs().maxCoeff();
}

DirectionView::DirectionView(const ConvexPolytope& polytope, const Vec3& direction)
    : polytope_(&polytope), direction_(direction), sideways_(sideways_of(direction)) {}

PlaneDescent::PlaneDescent(const PolyhedralHierarchy& hierarchy, const Vec3& direction)
    : descent_(hierarchy, DirectionView(hierarchy.polytope(), direction)) {
  const ConvexPolytope& body = hierarchy.polytope();
  int best = -1;
  double most = -HUGE_VAL;
  for (const std::int32_t v : hierarchy.coarsest()) {
    descent_.count_evaluation();
    const double value = body.vertex(v).dot(direction);
    if (value <= most) continue;
    best = v;
    most = value;
  }
  descent_.enter(best);
}

PlaneDescent::PlaneDescent(const PolyhedralHierarchy& hierarchy, const Vec3& direction, int vertex)
    : descent_(hierarchy, DirectionView(hierarchy.polytope(), direction)) {
  descent_.enter(vertex);
}

}  // namespace pd::detail

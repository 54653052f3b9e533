#include "structure/hierarchy/line_descent.hpp"

#include <cmath>

#include "structure/hierarchy/plane_descent.hpp"

namespace pd::detail {

LineView::LineView(const ConvexPolytope& polytope, const Vec3& point, const Vec3& direction)
    : polytope_(&polytope), point_(point), direction_(direction), sideways_(sideways_of(direction)) {}

LineView::Row LineView::row(int facet) const {
  const Vec3& n = polytope_->facet_normal(facet);
  const Vec3 corner = polytope_->vertex(polytope_->facet_vertices(facet)[0]);
  return {n.dot(direction_), n.dot(sideways_), n.dot(corner - point_)};
}

LineEntry enter_outer_hierarchy(const PolyhedralHierarchy& hierarchy, const Vec3& point, const Vec3& direction) {
  const LineView view(hierarchy.polytope(), point, direction);
  LineEntry entry;
  double latest = -HUGE_VAL;
  for (const std::int32_t f : hierarchy.coarsest()) {
    ++entry.evaluations;
    const LineView::Row row = view.row(f);
    if (row.slope >= 0 || row.offset / row.slope <= latest) continue;
    latest = row.offset / row.slope;
    entry.facet = f;
  }
  if (entry.facet < 0) return entry;
  for (const std::int32_t f : hierarchy.coarsest()) {
    ++entry.evaluations;
    const LineView::Row row = view.row(f);
    if (row.slope >= 0 && row.slope * latest > row.offset) entry.blocker = f;
  }
  if (entry.blocker >= 0) return entry;
  ShadowDescent<LineView> descent(hierarchy, view);
  descent.enter(entry.facet);
  while (descent.next(0)) {
  }
  entry.facet = descent.element();
  entry.blocker = descent.view().blocker();
  entry.evaluations += descent.evaluations();
  return entry;
}

}  // namespace pd::detail

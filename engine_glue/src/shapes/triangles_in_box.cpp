#include "shapes/triangles_in_box.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "pd/bullet/scalar.hpp"
#include "shapes/each_triangle.hpp"

namespace pd::detail {

// The Voronoi region of the point tells the nearest feature: C. Ericson, "Real-Time Collision Detection", 2005, section
// 5.1.5.
double distance_from(const Vec3& point, const std::array<Vec3, 3>& corners) {
  const Vec3 ab = corners[1] - corners[0], ac = corners[2] - corners[0], ap = point - corners[0];
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return ap.norm();
  const Vec3 bp = point - corners[1];
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return bp.norm();
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return (ap - d1 / (d1 - d3) * ab).norm();
  const Vec3 cp = point - corners[2];
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return cp.norm();
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return (ap - d2 / (d2 - d6) * ac).norm();
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    const double share = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return (bp - share * (corners[2] - corners[1])).norm();
  }
  const Vec3 normal = ab.cross(ac);
  return std::abs(normal.dot(ap)) / normal.norm();
}

double margin_of_triangles(const btConcaveShape& concave) {
  return concave.getShapeType() == STATIC_PLANE_PROXYTYPE ? 0 : static_cast<double>(concave.getMargin());
}

std::vector<TriangleCorners> corners_in_box(const btConcaveShape& concave, const btVector3& lower,
                                            const btVector3& upper, const Whereabouts* near) {
  // Poses in single precision turn lengths by less.
  constexpr double kTurned = 1 + 1e-5;
  const double margin = margin_of_triangles(concave);
  std::vector<TriangleCorners> triangles;
  for_each_triangle(concave, lower, upper, [&](const btVector3* corners, int part, int index) {
    const auto reach = static_cast<btScalar>(margin);
    for (int axis = 0; axis < 3; ++axis) {
      const auto [low, high] = std::minmax({corners[0][axis], corners[1][axis], corners[2][axis]});
      if (low - reach > upper[axis] || high + reach < lower[axis]) return;
    }
    const std::array points{to_pd(corners[0]), to_pd(corners[1]), to_pd(corners[2])};
    if (near != nullptr && distance_from(near->centre, points) > kTurned * (near->radius + margin)) return;
    triangles.push_back({points, part, index});
  });
  return triangles;
}

std::shared_ptr<const ConvexShape> to_shape(const TriangleCorners& triangle, double margin) {
  auto hull = ConvexPolytope::from_points(triangle.corners);
  if (!hull) return nullptr;
  auto shape = ConvexShape(std::move(hull).value()).with_margin(margin);
  return shape ? std::make_shared<const ConvexShape>(std::move(shape).value()) : nullptr;
}

std::vector<BoxedTriangle> triangles_in_box(const btConcaveShape& concave, const btVector3& lower,
                                            const btVector3& upper) {
  std::vector<BoxedTriangle> triangles;
  for (const TriangleCorners& corners : corners_in_box(concave, lower, upper)) {
    auto shape = to_shape(corners, margin_of_triangles(concave));
    if (shape) triangles.push_back({std::move(shape), corners.part, corners.index});
  }
  return triangles;
}

}  // namespace pd::detail

/// @file
/// The triangles of a mesh, heightfield or plane that a box meets, as convex bodies.
#pragma once

#include <BulletCollision/CollisionShapes/btConcaveShape.h>

#include <array>
#include <memory>
#include <vector>

#include "pd/numeric/vector.hpp"
#include "pd/shape/convex_shape.hpp"

namespace pd::detail {

struct BoxedTriangle {
  std::shared_ptr<const ConvexShape> shape;  ///< with the concave shape's margin; a plane has none
  int part;                                  ///< Bullet's numbers for it
  int index;
};

/// The corners of one, before it is converted.
struct TriangleCorners {
  std::array<Vec3, 3> corners;
  int part;
  int index;
};

/// Where a body may come to, in a concave shape's frame: no point of it gets farther from the centre than the radius.
struct Whereabouts {
  Vec3 centre;
  double radius;
};

/// The distance of the nearest point of a triangle. NaN if the triangle has no area.
[[nodiscard]] double distance_from(const Vec3& point, const std::array<Vec3, 3>& corners);
/// The triangles that a box meets, in the concave shape's frame. Those whose corners are no numbers are among them.
/// @param near  null, or: triangles that do not come near, margin included, are left out
[[nodiscard]] std::vector<TriangleCorners> corners_in_box(const btConcaveShape& concave, const btVector3& lower,
                                                          const btVector3& upper, const Whereabouts* near = nullptr);
/// The margin that a concave shape's triangles have in contacts; a plane has none.
[[nodiscard]] double margin_of_triangles(const btConcaveShape& concave);
/// One as a convex body; null where its corners are no numbers, as Bullet's own contacts leave it out.
[[nodiscard]] std::shared_ptr<const ConvexShape> to_shape(const TriangleCorners& triangle, double margin);

/// The same, converted.
[[nodiscard]] std::vector<BoxedTriangle> triangles_in_box(const btConcaveShape& concave, const btVector3& lower,
                                                          const btVector3& upper);

}  // namespace pd::detail

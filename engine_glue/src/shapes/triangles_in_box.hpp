/// @file
/// The triangles of a mesh, heightfield or plane that a box meets, as convex bodies.
#pragma once

#include <BulletCollision/CollisionShapes/btConcaveShape.h>

#include <memory>
#include <vector>

#include "pd/shape/convex_shape.hpp"

namespace pd::detail {

struct BoxedTriangle {
  std::shared_ptr<const ConvexShape> shape;  ///< with the concave shape's margin; a plane has none
  int part;                                  ///< Bullet's numbers for it
  int index;
};

/// @param lower, upper  in the concave shape's frame. Triangles whose corners are no numbers are left out, as Bullet's
/// own contacts leave them out.
[[nodiscard]] std::vector<BoxedTriangle> triangles_in_box(const btConcaveShape& concave, const btVector3& lower,
                                                          const btVector3& upper);

}  // namespace pd::detail

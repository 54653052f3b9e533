/// @file
/// The triangles of a mesh, heightfield or plane that a box meets, as convex bodies.
#pragma once

#include <BulletCollision/CollisionShapes/btConcaveShape.h>

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

/// Where a body may come to, in a concave shape's frame: no point of it gets farther from the centre than the radius.
struct Whereabouts {
  Vec3 centre;
  double radius;
};

/// @param lower, upper  in the concave shape's frame. Triangles whose corners are no numbers are left out, as Bullet's
/// own contacts leave them out.
/// @param near  null, or: triangles that do not come near, margin included, are left out, which is quicker than to
/// convert them
[[nodiscard]] std::vector<BoxedTriangle> triangles_in_box(const btConcaveShape& concave, const btVector3& lower,
                                                          const btVector3& upper, const Whereabouts* near = nullptr);

}  // namespace pd::detail

/// @file
/// A box with rounded corners round a convex body: what tells at little cost that a triangle is out of the body's
/// reach.
#pragma once

#include <BulletCollision/CollisionShapes/btConvexShape.h>

#include "pd/numeric/vector.hpp"

namespace pd::detail {

/// The points no farther than `radius` from a box. A sphere's box is a point and a capsule's a segment, so that both
/// are met exactly; any other body's is the box along its own axes, with radius 0.
struct RoundedBox {
  Vec3 centre;
  Mat3 axes;  ///< columns: the box's axes, of length 1 but for the rounding of Bullet's matrices
  Vec3 half;
  double radius;
};

/// Round a body, in a frame in which the body has this pose. Includes the body's margin.
[[nodiscard]] RoundedBox rounded_box(const btConvexShape& body, const btTransform& pose);

/// Whether the box is certainly farther than `reach` from a triangle: apart along the triangle's normal, an axis of the
/// box, the way to the nearest corner or the outward normal of an edge in the triangle's plane.
/// @param corners  in the box's frame
/// @param across  (corner 1 - corner 0) x (corner 2 - corner 0), not zero
/// @param rounding  of coordinates, relative
[[nodiscard]] bool out_of_reach(const RoundedBox& box, const Vec3 (&corners)[3], const Vec3& across, double reach,
                                double rounding);

}  // namespace pd::detail

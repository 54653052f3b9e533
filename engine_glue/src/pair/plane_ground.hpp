/// @file
/// A `btStaticPlaneShape` as the ground that bodies are asked against.
#pragma once

#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/CollisionShapes/btConvexShape.h>
#include <BulletCollision/CollisionShapes/btStaticPlaneShape.h>

#include "pd/bullet/scalar.hpp"
#include "pd/shape/halfspaces.hpp"

namespace pd::detail {

/// In the world. Requires a finite pose.
inline Halfspace3 ground_of(const btCollisionObjectWrapper& plane) {
  const auto& shape = static_cast<const btStaticPlaneShape&>(*plane.getCollisionShape());
  const Pose pose = to_pd(plane.getWorldTransform());
  const Vec3 local = to_pd(shape.getPlaneNormal());
  const Vec3 normal = (pose.rotation() * local).normalized();
  const Vec3 point = pose.apply(static_cast<double>(shape.getPlaneConstant()) * local);
  return {normal, normal.dot(point)};
}

/// Whether the body's bounding box is farther above the plane than contacts reach: so are most bodies of a pile, each
/// of which meets the plane's endless box.
inline bool box_above(const btConvexShape& body, const btTransform& pose, const Halfspace3& ground, double reach) {
  btVector3 lower;
  btVector3 upper;
  body.getAabb(pose, lower, upper);
  const Vec3 low = to_pd(lower), high = to_pd(upper);
  const Vec3 least = ground.normal.cwiseProduct(low).cwiseMin(ground.normal.cwiseProduct(high));
  return least.sum() > ground.offset + reach;
}

}  // namespace pd::detail

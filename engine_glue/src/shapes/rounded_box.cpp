#include "shapes/rounded_box.hpp"

#include <BulletCollision/CollisionShapes/btCapsuleShape.h>
#include <BulletCollision/CollisionShapes/btSphereShape.h>

#include <algorithm>
#include <cmath>

#include "pd/bullet/scalar.hpp"

namespace pd::detail {

RoundedBox rounded_box(const btConvexShape& body, const btTransform& pose) {
  RoundedBox box{to_pd(pose.getOrigin()), to_pd(pose.getBasis()), Vec3::Zero(), 0};
  switch (body.getShapeType()) {
    case SPHERE_SHAPE_PROXYTYPE:
      box.radius = static_cast<double>(static_cast<const btSphereShape&>(body).getRadius());
      break;
    case CAPSULE_SHAPE_PROXYTYPE: {
      const auto& capsule = static_cast<const btCapsuleShape&>(body);
      box.radius = static_cast<double>(capsule.getRadius());
      box.half[capsule.getUpAxis()] = static_cast<double>(capsule.getHalfHeight());
      break;
    }
    default: {
      btVector3 lower;
      btVector3 upper;
      body.getAabb(btTransform::getIdentity(), lower, upper);
      box.centre += box.axes * (0.5 * (to_pd(lower) + to_pd(upper)));
      box.half = 0.5 * (to_pd(upper) - to_pd(lower));
    }
  }
  return box;
}

bool out_of_reach(const RoundedBox& box, const Vec3 (&corners)[3], const Vec3& across, double reach, double rounding) {
  // Along the box's axes, from its centre.
  const Mat3 into = box.axes.transpose();
  const Vec3 at[3] = {into * (corners[0] - box.centre), into * (corners[1] - box.centre),
                      into * (corners[2] - box.centre)};
  const Vec3 low = at[0].cwiseMin(at[1]).cwiseMin(at[2]), high = at[0].cwiseMax(at[1]).cwiseMax(at[2]);
  reach += box.radius + 2 * rounding * high.cwiseMax(-low).maxCoeff();
  const Vec3 extent = box.half + Vec3::Constant(reach);
  if ((low.array() > extent.array()).any() || (high.array() < -extent.array()).any()) return true;
  // Of the plane at this distance along n, times the length of n.
  const auto apart = [&](const Vec3& n, double distance) {
    const double beyond = distance - n.cwiseAbs().dot(box.half);
    return beyond > 0 && beyond * beyond > reach * reach * n.squaredNorm();
  };
  const Vec3 normal = into * across;
  if (apart(normal, std::abs(normal.dot(at[0])))) return true;
  const double squared[3] = {at[0].squaredNorm(), at[1].squaredNorm(), at[2].squaredNorm()};
  const Vec3& nearest = at[std::min_element(squared, squared + 3) - squared];
  if (apart(nearest, std::min({nearest.dot(at[0]), nearest.dot(at[1]), nearest.dot(at[2])}))) return true;
  for (int i = 0; i < 3; ++i) {
    const Vec3 outward = (at[(i + 1) % 3] - at[i]).cross(normal);
    if (apart(outward, -outward.dot(at[i]))) return true;
  }
  return false;
}

}  // namespace pd::detail

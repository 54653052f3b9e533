#include "rounded_box.hpp"

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
  const Vec3 from_centre[3] = {corners[0] - box.centre, corners[1] - box.centre, corners[2] - box.centre};
  double farthest = 0;
  for (const Vec3& corner : from_centre) farthest = std::max(farthest, corner.cwiseAbs().maxCoeff());
  reach += rounding * farthest;
  if (std::abs(across.dot(from_centre[0])) > box.half_width(across) + reach * across.norm()) return true;
  if (!box.half.isZero(0)) {
    for (int axis = 0; axis < 3; ++axis) {
      const Vec3 along = box.axes.col(axis);
      const auto [low, high] =
          std::minmax({along.dot(from_centre[0]), along.dot(from_centre[1]), along.dot(from_centre[2])});
      const double extent = box.half[axis] + box.radius + reach;
      if (low > extent || high < -extent) return true;
    }
  }
  const auto apart_along = [&](const Vec3& n) {
    const double nearest = std::min({n.dot(from_centre[0]), n.dot(from_centre[1]), n.dot(from_centre[2])});
    return nearest > box.half_width(n) + reach * n.norm();
  };
  const auto shorter = [](const Vec3& x, const Vec3& y) { return x.squaredNorm() < y.squaredNorm(); };
  if (apart_along(*std::min_element(from_centre, from_centre + 3, shorter))) return true;
  for (int i = 0; i < 3; ++i) {
    const Vec3 outward = (from_centre[(i + 1) % 3] - from_centre[i]).cross(across);
    if (-outward.dot(from_centre[i]) > box.half_width(outward) + reach * outward.norm()) return true;
  }
  return false;
}

}  // namespace pd::detail

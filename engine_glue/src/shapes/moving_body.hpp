/// @file
/// The motion between two Bullet transforms as pd_core means it.
#pragma once

#include <BulletDynamics/Dynamics/btRigidBody.h>
#include <LinearMath/btTransform.h>

#include <Eigen/Geometry>
#include <cmath>

#include "pd/bullet/scalar.hpp"
#include "pd/contact/time_of_impact.hpp"

namespace pd::detail {

/// The constant velocities that lead from one transform to the other in `duration` > 0: the shorter turn.
inline RigidMotion motion_between(const btTransform& from, const btTransform& to, double duration) {
  RigidMotion motion;
  motion.linear_velocity = (to_pd(to.getOrigin()) - to_pd(from.getOrigin())) / duration;
  if (from.getBasis() == to.getBasis()) return motion;  // products of rounded bases would turn a body at rest
  const Eigen::AngleAxisd turn(Mat3(to_pd(to.getBasis()) * to_pd(from.getBasis()).transpose()));
  motion.angular_velocity = turn.angle() / duration * turn.axis();
  return motion;
}

/// How far a point within `radius` of the frame's origin has come at the most, turning by the nearest rotations
/// included.
inline double moved_at_most(const btTransform& from, const btTransform& to, double radius) {
  if (from == to) return 0;
  double turned = 0;
  for (int i = 0; i < 3; ++i) turned += (to_pd(to.getBasis()[i]) - to_pd(from.getBasis()[i])).squaredNorm();
  return (1 + 0x1p-16) * (std::sqrt(turned) * radius + (to_pd(to.getOrigin()) - to_pd(from.getOrigin())).norm());
}

/// Of its centre of mass; zero where it is no rigid body.
inline Vec3 linear_velocity(const btCollisionObject& object) {
  const btRigidBody* const body = btRigidBody::upcast(&object);
  return body == nullptr ? Vec3(Vec3::Zero()) : to_pd(body->getLinearVelocity());
}

/// A piece of a body that turns about the body's origin. `local`: of the piece in the body.
inline MovingShape moving_piece(const ConvexShape& shape, const btTransform& body_start, const btTransform& local,
                                const RigidMotion& motion) {
  const btTransform start = body_start * local;
  return {{&shape, to_pd(start)}, motion, to_pd(start.getOrigin()) - to_pd(body_start.getOrigin())};
}

}  // namespace pd::detail

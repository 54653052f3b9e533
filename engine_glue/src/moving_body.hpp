/// @file
/// The motion between two Bullet transforms as pd_core means it.
#pragma once

#include <LinearMath/btTransform.h>

#include <Eigen/Geometry>

#include "pd/bullet/scalar.hpp"
#include "pd/contact/time_of_impact.hpp"

namespace pd::detail {

/// The constant velocities that lead from one transform to the other in `duration` > 0: the shorter turn.
inline MovingShape moving_shape(const ConvexShape& shape, const btTransform& from, const btTransform& to,
                                double duration) {
  MovingShape result{{&shape, to_pd(from)}, {}};
  result.motion.linear_velocity = (to_pd(to.getOrigin()) - to_pd(from.getOrigin())) / duration;
  const Eigen::AngleAxisd turn(Mat3(to_pd(to.getBasis()) * to_pd(from.getBasis()).transpose()));
  result.motion.angular_velocity = turn.angle() / duration * turn.axis();
  return result;
}

}  // namespace pd::detail

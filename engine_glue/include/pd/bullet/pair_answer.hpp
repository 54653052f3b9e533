/// @file
/// The full answer about two Bullet shapes (`BulletPenetrationDepthSolver::query`).
#pragma once

#include <memory>

#include "pd/bullet/penetration_depth_solver.hpp"
#include "pd/contact/manifold.hpp"
#include "pd/depth/depth_answer.hpp"
#include "pd/shape/convex_shape.hpp"

namespace pd {

/// One answer about two Bullet shapes, with the bodies that it was made for.
struct BulletPairAnswer {
  PenetrationDepth depth;
  std::shared_ptr<const ConvexShape> shape_a;
  std::shared_ptr<const ConvexShape> shape_b;
  Pose pose_a;
  Pose pose_b;
};

}  // namespace pd

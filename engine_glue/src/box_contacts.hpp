/// @file
/// Two btBoxShapes that Bullet's own tables take sharp: contact points from sizes and poses alone, without a converted
/// shape, the cache or the pair's certificate. Most pairs of most worlds.
#pragma once

#include <BulletCollision/CollisionShapes/btConvexShape.h>

#include "manifold_points.hpp"
#include "solver_core.hpp"

namespace pd::detail {

[[nodiscard]] inline bool are_boxes(const btConvexShape& a, const btConvexShape& b) {
  return a.getShapeType() == BOX_SHAPE_PROXYTYPE && b.getShapeType() == BOX_SHAPE_PROXYTYPE;
}

/// Requires `are_boxes`. Counted as one query where it answers.
/// @return false: `SolverCore::answer` has to be asked.
[[nodiscard]] bool box_contacts(const btConvexShape& a, const btTransform& pose_a, const btConvexShape& b,
                                const btTransform& pose_b, double breaking_threshold, ThreadBuffers& held,
                                FreshPoints& out);

}  // namespace pd::detail

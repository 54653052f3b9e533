/// @file
/// Two btBoxShapes that Bullet's own tables take sharp: contact points from sizes and poses alone, without a converted
/// shape, the cache or the pair's certificate. Most pairs of most worlds.
#pragma once

#include <BulletCollision/CollisionShapes/btConvexShape.h>

#include "pair/manifold_points.hpp"
#include "pair/thread_buffers.hpp"
#include "pd/contact/box_contact.hpp"

namespace pd::detail {

[[nodiscard]] inline bool are_boxes(const btConvexShape& a, const btConvexShape& b) {
  return a.getShapeType() == BOX_SHAPE_PROXYTYPE && b.getShapeType() == BOX_SHAPE_PROXYTYPE;
}

/// Both with their margins inside, to the tolerance of contacts. Requires `are_boxes` and poses in range.
[[nodiscard]] BoxContact ask_boxes(const btConvexShape& a, const btTransform& pose_a, const btConvexShape& b,
                                   const btTransform& pose_b, double breaking_threshold, BoxWitness witness);

/// A whole pair. Requires `are_boxes`. Counted as one query where it answers.
/// @return false: `SolverCore::contacts` has to be asked, which is rare (`BoxContact::answered`).
[[nodiscard]] bool box_contacts(const btConvexShape& a, const btTransform& pose_a, const btConvexShape& b,
                                const btTransform& pose_b, double breaking_threshold, ThreadBuffers& held,
                                FreshPoints& out);

}  // namespace pd::detail

/// @file
/// The bodies of a world as they are measured: sharp convex pieces without margins, whoever found the contacts.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "pd/shape/convex_shape.hpp"
#include "pd/shape/pose.hpp"
#include "scenes/worlds.hpp"

namespace pd::scenes {

struct ConvexPiece {
  int body;
  std::shared_ptr<const ConvexShape> shape;
  Pose local;     ///< of the piece in its body
  Vec3 centre;    ///< of a ball that holds it, in the body's frame
  double radius;  ///< of that ball

  [[nodiscard]] Pose posed(const Pose& body_pose) const {
    return Pose::from_trusted_matrix(body_pose.rotation() * local.rotation(), body_pose.apply(local.translation()));
  }
};

/// Body by body. Of a mesh or heightfield: the ground below each triangle, one unit deep, so that a body that went
/// through the surface counts as deep inside it.
[[nodiscard]] std::vector<ConvexPiece> convex_pieces(const World& world);

class BulletScene;

struct PosedPiece {
  const ConvexPiece& piece;
  const Pose& pose;  ///< of the piece in the world
};
/// Visits the pairs of pieces that could be in each other now, each once, the lower body first: of two bodies that are
/// not held together by a joint (what those share of space is no penetration), one of which at least can move.
/// @param pieces  of the scene's plan
/// Time: O(n m) for n pieces, m of them of bodies that can move.
void for_each_near_pair(BulletScene& scene, const std::vector<ConvexPiece>& pieces,
                        const std::function<void(const PosedPiece& a, const PosedPiece& b)>& visit);

}  // namespace pd::scenes

/// @file
/// The bodies of a world as they are measured: sharp convex pieces without margins, whoever found the contacts.
#pragma once

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

/// Whether two bodies of a world are held together by a joint: what they share of space is no penetration.
[[nodiscard]] bool jointed(const World& world, int a, int b);

}  // namespace pd::scenes

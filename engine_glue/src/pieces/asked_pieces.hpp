/// @file
/// Two bodies of Bullet as the rule for covered contacts is asked about them.
#pragma once

#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>

#include <optional>

#include "pd/bullet/scalar.hpp"
#include "pd/union_contact/covered_contact.hpp"
#include "pieces/near_pieces.hpp"
#include "shapes/moving_body.hpp"

namespace pd::detail {

/// Of a pair in one step.
struct PiecesStep {
  double threshold;  ///< up to which gap a pair of points is a contact
  double seconds;    ///< of the step
  StepShapes shapes;
  NearPieces& near;
  CoverBuffers& cover;
  ManifoldScratch& manifold;
};

class AskedPieces {
 public:
  AskedPieces(const btCollisionObjectWrapper& a, const btCollisionObjectWrapper& b, const PiecesStep& step)
      : step_(step), way_(way_between(a, b, step.seconds)) {
    if (is_piece(a)) a_.emplace(a, step.shapes, step.near);
    if (is_piece(b)) b_.emplace(b, step.shapes, step.near);
  }
  /// @param front  as of `PiecePair`
  [[nodiscard]] PiecePair as(const PosedShape& a, const PosedShape& b, const Vec3& front = Vec3::Zero()) {
    return {.a = a,
            .b = b,
            .around_a = a_ ? &*a_ : nullptr,
            .around_b = b_ ? &*b_ : nullptr,
            .threshold = step_.threshold,
            .way = way_,
            .pose_rounding = kPoseRounding,
            .cover = step_.cover,
            .manifold = step_.manifold,
            .front = front};
  }

 private:
  static double way_between(const btCollisionObjectWrapper& a, const btCollisionObjectWrapper& b, double seconds) {
    const Vec3 way = seconds * (linear_velocity(*a.getCollisionObject()) - linear_velocity(*b.getCollisionObject()));
    return way.norm();
  }

  PiecesStep step_;
  double way_;
  std::optional<PieceOfBody> a_;
  std::optional<PieceOfBody> b_;
};

}  // namespace pd::detail

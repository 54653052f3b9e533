/// @file
/// Two bodies that were apart when they were last asked about, and a proof that they still are.
///
/// The plane across the answer's normal n parts them by its `distance_lower`. In the frame of B that plane stands
/// still. A comes nearer to it by at most -<n, d> + |R' - R| r, where d is the way of A's origin, R and R' its
/// rotations then and now, and r its radius. Bodies that fall, swing or slide together hardly move in each other's
/// frame. Lengths are in the unit of the shapes, poses in the frame of the world; each function takes constant time.
#pragma once

#include "pd/depth/depth_answer.hpp"
#include "pd/numeric/vector.hpp"
#include "pd/shape/pose.hpp"

namespace pd {

class PartedPieces {
 public:
  /// Tells whether there is anything to prove with.
  [[nodiscard]] bool known() const { return distance_ > 0; }
  void forget() { distance_ = 0; }
  /// Takes note of an answer; one that is not `separated` is forgotten.
  void note(const Pose& a, const Pose& b, const PenetrationDepth& answer);
  /// True if the bodies are proved to be farther apart than `gap` (>= 0); false where nothing is known. Requires: the
  /// shapes are those of the answer.
  /// @param radius  of A about its frame's origin
  [[nodiscard]] bool beyond(double gap, const Pose& a, const Pose& b, double radius) const;

 private:
  double distance_ = 0;  ///< 0: nothing is known
  Vec3 normal_;          ///< in B's frame, as the pose below
  Vec3 place_;
  Mat3 rotation_;
};

}  // namespace pd

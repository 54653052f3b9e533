/// @file
/// How far a convex polytope reaches beyond a solid: the largest distance of its points from the solid, as a bracket.
///
/// The polytope is cut into pieces by boxes, and the piece with the largest bound is halved first. A piece has one of
/// these bounds:
///   - The distance of its farthest corner from one triangle of the surface. The distance from a convex set is a convex
///     function, so that no point of the piece is farther from that triangle than the farthest corner.
///   - 2^-32 of its diameter, where the piece, shrunk by that share about its middle, meets no triangle and has its
///     middle in the solid.
/// Every middle that lies outside of the solid bounds the largest distance from below.
#pragma once

#include <cstdint>

#include "pd/shape/convex_polytope.hpp"
#include "pd/shape/mesh_solid.hpp"
#include "pd/shape/pose.hpp"
#include "solid/posed_solids.hpp"

namespace pd::detail {

/// lower <= largest distance <= upper, in lengths of the solid.
struct ReachBracket {
  double lower = 0;
  double upper = 0;
  Vec3 worst = Vec3::Zero();  ///< a point of the polytope near which the upper bound was left
  std::int64_t steps = 0;     ///< pieces that were looked at
};

struct ReachGoal {
  double enough = 0;  ///< the search ends once upper <= enough, or, without a share, lower > enough
  double share = 0;   ///< the search ends once upper <= (1 + share) lower; 0: it decides whether lower > enough
  std::int64_t steps = 100'000;  ///< the search ends after so many pieces
};

class HullReach {
 public:
  /// Refers to the solid, which must outlive it.
  explicit HullReach(const MeshSolid& solid) : alone_(solid, identity_, solid, identity_) {}
  HullReach(const HullReach&) = delete;
  HullReach& operator=(const HullReach&) = delete;

  /// Requires a polytope of dimension 3.
  [[nodiscard]] ReachBracket beyond(const ConvexPolytope& polytope, const ReachGoal& goal) const;

 private:
  Pose identity_;
  PosedSolids alone_;
};

}  // namespace pd::detail

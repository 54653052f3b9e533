/// @file
/// How deep a point lies in a solid, bounded from below.
#pragma once

#include "pd/shape/pose.hpp"
#include "solid/posed_solids.hpp"

namespace pd::detail {

/// A signed distance from a surface, positive inside, rounded down: at most that of the point.
struct SurfaceDepth {
  double depth = 0;
  Vec3 inward = Vec3::Zero();  ///< the unit direction in which it grows; zero: unknown
};

/// Depths of points in one of the solids, where it stands (inside lengths).
class DepthProbe {
 public:
  /// Refers to the solids.
  DepthProbe(const PosedSolids& solids, Body body);
  DepthProbe(const DepthProbe&) = delete;
  DepthProbe& operator=(const DepthProbe&) = delete;

  [[nodiscard]] SurfaceDepth at(const Vec3& x) const;
  /// With the depth of a point that is `moved` away, which bounds the search and often tells the side.
  [[nodiscard]] SurfaceDepth at(const Vec3& x, const SurfaceDepth& near, double moved) const;

 private:
  /// @param known_sign  of the depth; 0: unknown
  [[nodiscard]] SurfaceDepth signed_depth(const Vec3& x, double at_most, double known_sign) const;
  /// The side of a point farther from the surface than the slack: that of the point in the body's own frame, rounded.
  [[nodiscard]] bool holds(const Vec3& x) const;

  const Pose identity_;
  const PosedSolids& solids_;
  Body body_;
  PosedSolids alone_;
  double slack_;
};

}  // namespace pd::detail

/// @file
/// A remembered surface looked at where it may have come near: most frames need a few of its planes only.
///
/// When all planes were last computed (WarmCertificate::Reference), every face f was d_f from the origin and at least c
/// from an inner point q, with both behind it. Its points have moved by at most delta_f since: by as much as a base
/// vertex has, and by both bodies' turning over the distance from there. Then
/// 1. if delta_f < c for all f, no face has crossed q, so the surface still winds round q as it did, at least once;
/// 2. a face with d_f - delta_f > rho is farther than rho from the origin still, and has not met the segment from the
///    origin to q (a plane's distance is linear along it);
/// 3. the planes of the other faces are computed anew; where they have the origin and q behind them, they miss that
///    segment, too, so the surface winds round the origin, and round the whole ball that no face reaches.
/// As in inner_surface.hpp, that ball lies in P. Neither orientation nor convexity of the faces left alone is asked
/// for.
#pragma once

#include <span>

#include "depth/difference/polytope_difference.hpp"
#include "depth/expansion/inner_surface.hpp"
#include "pd/depth/warm_certificate.hpp"

namespace pd::detail {

/// More faces and vertices are not remembered. A closed triangulated surface of F faces has F / 2 + 2 vertices.
inline constexpr int kMaxRememberedFaces = 128;
inline constexpr int kMaxRememberedVertices = kMaxRememberedFaces / 2 + 2;

/// The nearest face at the present poses.
struct RememberedFace {
  DifferenceVertex corners[3];  ///< of the face below the origin, where several lie in one plane
  double weights[3];            ///< barycentric coordinates of the origin's projection on them
  Vec3 normal;                  ///< outward, any length
  double distance;              ///< of the plane from the origin, rounded
  double largest;               ///< the surface reaches at least this |coordinate|
  int faces_seen;
};

/// What is remembered of a surface whose faces all have the origin behind them: `state.faces` are its slots.
void set_reference(WarmCertificate::State& state, InnerSurface& surface, const PolytopeDifference& difference);

/// False where the movement is too large, too many faces may be near, or one of them shows the origin in front: the
/// surface must be restored. Time O(faces remembered / 4 + faces near).
[[nodiscard]] bool nearest_remembered(const WarmCertificate::State& state, const PolytopeDifference& difference,
                                      RememberedFace& out);

}  // namespace pd::detail

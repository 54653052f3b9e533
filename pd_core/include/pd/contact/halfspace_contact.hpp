/// @file
/// A body on a half-space: its signed distance and the points where the two touch, from one support each way and one
/// face, without a search. What a floor is to a physics engine, and what many flush facets are under a body that stands
/// over all of them at once.
#pragma once

#include "pd/contact/manifold.hpp"
#include "pd/depth/depth_answer.hpp"
#include "pd/shape/halfspaces.hpp"

namespace pd {

struct HalfspaceContact {
  ContactClass contact = ContactClass::separated;
  /// Certified lower end of the signed distance (minus the depth where the two overlap). The way along the
  /// half-space's normal is the shortest way out.
  double lower = 0;
  double upper = 0;
  ContactManifold manifold;  ///< its normal is the half-space's; no points beyond the threshold
  /// Of a body with points: how far its farthest point lies above the half-space, along the normal; up to rounding.
  double highest = 0;
};

/// Lengths are in the unit of the input, points in the frame that `ground` and the pose share. The body is A.
///
/// @param ground  {x : <normal, x> <= offset}, its normal of length 1 up to rounding. Coordinates and sizes from 1e-100
/// to 1e100, as of the body.
/// @param breaking_threshold  >= 0, as for `contact_manifold`. Points are as lifted (`DeepestPoint::as_lifted`); where
/// a curved body offers none that is as deep as the body, its deepest point is one of the four. Ids are those of
/// `contact_manifold` for a face of the ground that holds all of A's.
/// Time O(n) up to 48 vertices and that of a support beyond, O(k) in the vertices of the face. No allocation once the
/// buffers have grown.
[[nodiscard]] HalfspaceContact halfspace_contact(const PosedShape& a, const Halfspace3& ground,
                                                 double breaking_threshold, ManifoldScratch& scratch);

}  // namespace pd

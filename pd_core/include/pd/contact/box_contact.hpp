/// @file
/// Two boxes, the commonest pair of a physics engine: their signed distance and contact points in one pass, without a
/// polytope, a memory or a search.
///
/// The same answer as `penetration_depth` with Bracket::contact and `contact_manifold` give, from the fifteen axes of
/// two boxes; a sixth of their work goes into telling that two polytopes are boxes, and half of it into faces of any
/// number of corners. Constant time, no allocation.
#pragma once

#include <cstdint>

#include "pd/contact/manifold.hpp"
#include "pd/depth/depth_answer.hpp"
#include "pd/shape/pose.hpp"

namespace pd {

/// A box about the origin of its own frame, its edges along the axes, posed.
struct PosedBox {
  Vec3 half_extents;  ///< > 0
  const Pose* pose = nullptr;
};

/// Whether the points next to each other are asked for, where the corners of the faces say as much.
enum class BoxWitness : std::uint8_t { left_out, placed };

struct BoxContact {
  /// False: ask `penetration_depth`. The numbers below say nothing, then: edges parallel but for rounding leave the
  /// depth open, the nearest points of boxes apart lie on features of other axes, or sizes beyond 2^100 apart.
  bool answered = false;
  ContactClass contact = ContactClass::separated;
  double lower = 0;  ///< of the signed distance (minus the depth where the boxes overlap), certified
  double upper = 0;
  ContactManifold manifold;       ///< no points beyond the threshold
  Vec3 witness_a = Vec3::Zero();  ///< if asked for, within the threshold
  Vec3 witness_b = Vec3::Zero();
};

/// @param tolerance  of `DepthSettings::contact_tolerance`: the bracket is at most max(2e-14 L, tolerance) wide.
/// @param breaking_threshold  as for `contact_manifold`; boxes farther apart than that are `separated` by a plane, and
/// `upper` is wide. Points are as lifted (`DeepestPoint::as_lifted`), ids those of `contact_manifold`.
[[nodiscard]] BoxContact box_contact(const PosedBox& a, const PosedBox& b, double tolerance, double breaking_threshold,
                                     BoxWitness witness = BoxWitness::left_out);

/// What `penetration_depth` says of the two, without features and statistics. Requires `answered`.
[[nodiscard]] PenetrationDepth depth_of(const BoxContact& contact);

}  // namespace pd

/// @file
/// Two boxes, the commonest pair of a physics engine: their signed distance and contact points in one pass, without a
/// polytope, a memory or a search.
///
/// What `penetration_depth` with Bracket::contact and `contact_manifold` say of them, by the fifteen axes of two boxes
/// (depth/facets/gauss_boxes.hpp) and two rectangles cut by each other (Sutherland, Hodgman 1974). If axes are
/// equally near up to rounding, either may be taken, and exchanged bodies may take the other.
#pragma once

#include <cstdint>

#include "pd/contact/manifold.hpp"
#include "pd/depth/depth_answer.hpp"
#include "pd/shape/pose.hpp"

namespace pd {

/// A box about the origin of its own frame, its edges along the axes, posed.
struct PosedBox {
  Vec3 half_extents;           ///< > 0
  const Pose* pose = nullptr;  ///< of the caller, never null in a call
};

/// A posed box as kernels read it, for engines that have rows of a rotation at hand and no `Pose`.
struct BoxInRows {
  double x[4], y[4], z[4];  ///< rows of the rotation, taken as they stand (`Pose::from_trusted_matrix`), and a 0
  double half_extents[4];   ///< > 0, and a 0
  Vec3 centre;
};
[[nodiscard]] BoxInRows in_rows(const PosedBox& box);

/// Says if the closest points are asked for where the corners of the faces already tell them.
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

/// Lengths are in the unit of the input, points and the normal (from B to A) in the frame that both poses share.
///
/// @param a, b  finite poses. Half extents outside of 2^-100 to 2^100, or no numbers, are not answered.
/// @param tolerance  of `DepthSettings::contact_tolerance`, >= 0: the bracket is at most max(2e-14 L, tolerance) wide.
/// @param breaking_threshold  >= 0, as for `contact_manifold`; boxes farther apart than that are `separated` by a
/// plane, without points, and `upper` is wide. Points are as lifted (`DeepestPoint::as_lifted`): the deepest may miss
/// the depth by a thousandth of the threshold. Ids are those of `contact_manifold`. Constant time, no allocation.
[[nodiscard]] BoxContact box_contact(const BoxInRows& a, const BoxInRows& b, double tolerance,
                                     double breaking_threshold, BoxWitness witness = BoxWitness::left_out);
[[nodiscard]] BoxContact box_contact(const PosedBox& a, const PosedBox& b, double tolerance, double breaking_threshold,
                                     BoxWitness witness = BoxWitness::left_out);

/// The answer of `penetration_depth` for the two boxes, without features and statistics. Requires `answered`.
[[nodiscard]] PenetrationDepth depth_of(const BoxContact& contact);

}  // namespace pd

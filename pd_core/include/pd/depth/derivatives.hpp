/// @file
/// Derivatives of the signed depth by the two poses, and of normal and witness points where they have any.
///
/// s = depth inside (> 0), minus the distance outside (< 0). A pose has six numbers here: its translation t, and a
/// rotation vector w about t in the axes of the common frame: R(w) = exp([w]x) R, at w = 0. With P = B + (-A), s is
/// the least over unit n of the greatest <p, n> over p in P: the signed distance of the origin from P's boundary.
/// With n the answer's normal and witnesses a and b in the common frame the envelope theorem gives
///
///   ds/dt_B = n,   ds/dt_A = -n,   ds/dw_B = (b - t_B) x n,   ds/dw_A = -(a - t_A) x n,
///
/// where the least direction is unique and, for the rotations, the pair of witnesses is, too. Two parallel faces have
/// the first and not the second: s has one-sided derivatives by rotations then, but none. Normal and witnesses are
/// differentiated through the conditions that define them, as long as the same flats meet. Each witness lies on the
/// flat of its face, the normal is across both flats, and smooth parts are curved.
///
/// Danskin, "The theory of max-min, with applications", 1966 (envelope theorem).
#pragma once

#include "pd/depth/penetration_depth.hpp"

namespace pd {

/// A number's derivative by one pose.
struct PoseGradient {
  Vec3 translation;  ///< by t, dimensionless for a length
  Vec3 rotation;     ///< by w, per radian
};

/// A vector's derivative by one pose: column k belongs to coordinate k of t or w.
struct PoseJacobian {
  Mat3 translation;
  Mat3 rotation;
};

/// Derivatives of one pair, and flags that say which of them exist. A derivative that does not exist is NaN, never a
/// number that looks like one.
///
/// L is the largest |coordinate| of b - a. A tie means, with `kPolytopeTie` (polytopes, rounded ones,
/// spheres and capsules) or `kCurvedTie` (ellipsoids, cylinders, cones): something farther off than `reach` that is as
/// good up to `tie`. Ties that are exact in real arithmetic, and those that rounding of poses blurs, are thus both
/// ties. Pairs between the two bounds of a tie may be flagged either way.
struct DepthDerivatives {
  /// The pair's answer with the tightest bracket. Curved bodies have delta = 1e-12 (the bracket may end wider, which
  /// it says), and their witnesses are taken anew from the faces across the normal.
  PenetrationDepth answer;
  double signed_depth = 0;  ///< depth, or minus the distance

  /// No direction that is more than `reach` radians from the normal separates at a depth within tie * L of the least.
  /// True is proved by a search that bounds the depth on every part of the sphere of directions (rounding aside).
  /// False means that such a direction was found, or that 2e5 parts did not suffice to exclude one. Always true where
  /// the cores (the bodies without their margins) are apart.
  bool unique_direction = false;
  /// `unique_direction`, and no other pair of points of the two faces across the normal, farther than reach_of_points *
  /// L from the witnesses, faces each other within tie * L (sideways, too).
  bool unique_witness = false;
  /// `unique_witness` holds, and each witness is farther than reach_of_points * L from the rim of its body's face
  /// across the normal. The curvature of curved bodies is the same to a hundredth within 1e-5 radians of it (not next
  /// to a disc, where a rim bends ever faster). The conditions determine the derivatives of normal and witnesses (not
  /// the normal of a ball in a concentric one).
  bool stable_features = false;

  PoseGradient by_a;  ///< of signed_depth: translation where unique_direction, rotation where unique_witness
  PoseGradient by_b;

  PoseJacobian normal_by_a;  ///< the rest: where stable_features
  PoseJacobian normal_by_b;
  PoseJacobian witness_a_by_a;
  PoseJacobian witness_a_by_b;
  PoseJacobian witness_b_by_a;
  PoseJacobian witness_b_by_b;
};

struct TieTolerance {
  double tie;              ///< relative to L
  double reach;            ///< of directions, radians
  double reach_of_points;  ///< relative to L
};
/// Doubles show a plane's distance to about 1e-15 L, poses that were rounded once hold parallel faces to 1e-16: a
/// thousand times that. A facet through which the origin's foot lies farther than 1e-6 L inside its rim is told apart.
inline constexpr TieTolerance kPolytopeTie{1e-12, 1e-6, 1e-6};
/// A depth within (1 + 1e-12) of the least leaves the normal of a curved body open by sqrt(2e-12) radians. A body
/// 1e-4 radians from it that curves like a ball of L / 500 is a tie deeper. Faces that lean by 1e-5 radians count as
/// across the normal, where curved ones have points up to 1e-5 L aside.
inline constexpr TieTolerance kCurvedTie{1e-11, 1e-4, 1e-4};

/// Answers the pair and differentiates the answer.
///
/// Error of the gradient, relative to its norm: about 1e-14 L / |lever| for polytopes (witness points in doubles),
/// about 1e-5 for curved bodies (their normal is known to sqrt(2e-12) radians); `derivative_pairs` measures both. The
/// derivatives of normal and witnesses of curved bodies come from the curvature at a normal known to that only. They
/// are measured (its columns "feat."), not bounded. Differences over steps of 1e-3 agree to 9e-3 for 99 % of the
/// pairs, which is the noise of these differences, and to 5e-2 at worst. Time: the query, and some hundred supports of
/// P for the flags where the cores overlap; more for near ties.
[[nodiscard]] DepthDerivatives depth_derivatives(const PosedShape& a, const PosedShape& b, Scratch& scratch);

}  // namespace pd

/// @file
/// Pairs for the derivatives of the signed depth: random ones judged by central differences, and ties whose flags are
/// known by construction.
#pragma once

#include <cstdint>
#include <string>

#include "pd/depth/derivatives.hpp"
#include "pd/depth/scratch.hpp"

namespace pd::oracle {

enum class DerivativeFamily : std::uint8_t { polytopes, rounded, round, curved };

struct PosedPairCase {
  std::string kind;
  ConvexShape a;
  ConvexShape b;
  Pose pose_a;
  Pose pose_b;
  [[nodiscard]] PosedShape posed_a() const { return {&a, pose_a}; }
  [[nodiscard]] PosedShape posed_b() const { return {&b, pose_b}; }
};

/// A pair of bodies of size 1, overlapping or apart. Depends on seed and index only.
[[nodiscard]] PosedPairCase derivative_case(DerivativeFamily family, std::uint64_t seed, std::uint64_t index);

/// Whether a facet of P (built by `minkowski_difference`) other than the nearest is within `gap` of it, as a distance
/// of planes from the origin; of cores that are apart, whether their features change within a step of the differences.
/// False for curved bodies, whose runner-up has no name: `GradientJudgement::one_slope` leaves them out.
[[nodiscard]] bool runner_up_within(const PosedPairCase& pair, double gap, double step, Scratch& scratch);

struct GradientJudgement {
  DepthDerivatives derivatives;
  double gradient_error = 0;  ///< |claimed - central| / |central| of all 12 numbers; those that do not exist left out
  double feature_error = 0;   ///< the same of normal and witnesses together; 0 unless stable_features
  /// Whether the slopes ahead and behind agree to 1e-2 (of features: to 1e-1), so that the middle of both is a
  /// derivative: false where another direction takes over, or a witness passes a rim, within the step. Seen by the
  /// differences alone, whatever is claimed.
  bool one_slope = true;
  bool one_feature_slope = true;
};

/// Central differences of `penetration_depth` with steps of `step` and half of it, extrapolated, in every number of
/// both poses; of normal and witnesses of curved bodies with 100 times the step, and those of `depth_derivatives`.
[[nodiscard]] GradientJudgement judge_gradient(const PosedPairCase& pair, double step, Scratch& scratch);

/// A tie, or its near miss, built so that its flags are known.
struct TieCase {
  PosedPairCase pair;
  bool unique_direction;
  bool unique_witness;
};
[[nodiscard]] TieCase tie_case(std::uint64_t seed, std::uint64_t index);
inline constexpr int kTieKinds = 16;

}  // namespace pd::oracle

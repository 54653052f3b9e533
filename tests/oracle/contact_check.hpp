/// @file
/// Judges answers of `Bracket::contact` by exact ones.
#pragma once

#include <string>

#include "pd/depth/depth_answer.hpp"
#include "pd/depth/penetration_depth.hpp"
#include "pd/depth/scratch.hpp"

namespace pd::oracle {

/// The signed distance: positive apart, minus the depth of an overlap.
struct SignedInterval {
  double lower;
  double upper;
};
[[nodiscard]] SignedInterval signed_distance(const PenetrationDepth& answer);

/// S of the answer's promises, of two polytopes.
[[nodiscard]] double size_of_numbers(const PosedShape& a, const PosedShape& b);

/// Empty when the answer keeps the promises of `Bracket::contact`; else the first that it breaks: its interval holds
/// that of `exact` and is as narrow as `bracket_reached` says, it took no exact sign, `upper` * normal leads out but
/// for the tolerance, witnesses and normal fit.
[[nodiscard]] std::string check_contact(const PosedShape& a, const PosedShape& b, const PenetrationDepth& answer,
                                        const PenetrationDepth& exact, double allowed_width, Scratch& scratch);

}  // namespace pd::oracle

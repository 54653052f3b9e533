/// @file
/// Rounded bodies within a hair of contact, as engines leave them: a resting contact is the surface distance of two
/// cores less their margins, where nearly all digits cancel.
#pragma once

#include "oracle/judged_pair.hpp"

namespace pd::oracle {

struct RestingPair {
  scenes::PointPair cores;
  double margin_a = 0;
  double margin_b = 0;
};

/// Boxes and hulls on boxes, floors of up to 200 units and each other, moved by the library's own translations (or
/// distances) until they kiss, and from there by +-1e-20 to 1e-6 along the normal, or not at all. Even seeds round as
/// single precision does.
[[nodiscard]] RestingPair make_resting_pair(std::uint64_t seed, Scratch& scratch);

/// Sign of (x - signed depth of the swept bodies), exactly. Requires a verdict that knows the distance.
[[nodiscard]] int compare_with_depth(double x, const Verdict& core, const Scaled& margins);

/// Empty when the answer keeps its promises about two swept bodies; else the first that it breaks: the class, the
/// bracket and its width, a translation that separates exactly and is no longer than `upper`, witnesses that differ by
/// the translation.
[[nodiscard]] std::string check_rounded(const JudgedPair& pair, double margin_a, double margin_b,
                                        const PenetrationDepth& answer, Bracket bracket);

}  // namespace pd::oracle

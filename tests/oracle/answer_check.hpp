/// @file
/// Every promise that an answer makes, checked against the exact verdict: class, bracket, translation, witnesses,
/// normal, features.
#pragma once

#include <string>
#include <vector>

#include "oracle/depth_oracle.hpp"
#include "pd/depth/penetration_depth.hpp"

namespace pd::oracle {

/// What was asked, besides the pair.
struct Question {
  const ConvexPolytope* a;  ///< for the numbering of the features; built from the points of the oracle's bodies
  const ConvexPolytope* b;
  const Pose* pose_a;
  const Pose* pose_b;
  Bracket bracket = Bracket::certified;
};

struct Findings {
  std::vector<std::string> wrong;  ///< one line for each broken promise, its kind first
  double relative_width = 0;       ///< (upper - lower) / L of the depth or of the distance
};

/// L: the largest |coordinate| of b - a over the posed vertices (rounded).
[[nodiscard]] double difference_extent(const ExactPair& pair);

/// Empty findings when every promise of `PenetrationDepth` is kept.
[[nodiscard]] Findings check_answer(const ExactPair& pair, const Verdict& verdict, const Question& question,
                                    const PenetrationDepth& answer);

}  // namespace pd::oracle

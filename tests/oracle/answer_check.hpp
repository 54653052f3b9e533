/// @file
/// Every promise that an answer makes, checked against the exact verdict: class, bracket, translation, witnesses,
/// normal, features.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
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
  Bracket bracket = Bracket::tightest;
};

enum class Promise : std::uint8_t {
  finite,       ///< no NaN, no infinity
  contact,      ///< the exact class
  bracket,      ///< lower <= true value <= upper, and the value between them
  width,        ///< upper - lower <= 2e-14 S (certified), or neighbouring doubles (tightest)
  translation,  ///< separates exactly as stored, no longer than upper
  witness,      ///< in the bodies, and their difference is the translation
  normal,       ///< unit, along the translation
  feature,      ///< the faces of an optimal direction (tightest)
  zero,         ///< fields that the class says are zero
  oracle,       ///< the oracle itself could not decide
};
inline constexpr int kPromises = 10;
[[nodiscard]] std::string_view to_string(Promise promise);

struct Breach {
  Promise promise;
  std::string what;
};

struct Findings {
  std::vector<Breach> wrong;
  double relative_width = 0;  ///< (upper - lower) / L of the depth or of the distance
};

/// L: the largest |coordinate| of b - a over the posed vertices (rounded).
[[nodiscard]] double difference_extent(const ExactPair& pair);
/// S of the answer's promises, without margins.
[[nodiscard]] double size_of_numbers(const ConvexPolytope& a, const Pose& pose_a, const ConvexPolytope& b,
                                     const Pose& pose_b);

/// Empty findings when every promise of `PenetrationDepth` is kept.
[[nodiscard]] Findings check_answer(const ExactPair& pair, const Verdict& verdict, const Question& question,
                                    const PenetrationDepth& answer);

}  // namespace pd::oracle

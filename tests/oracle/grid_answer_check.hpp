/// @file
/// Every promise that an answer about two grid bodies makes, checked against the grid oracle's verdict: class, bracket,
/// tightness, translation, normal, witnesses, features, and the laws of swapping and of the order of points.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "oracle/grid_oracle.hpp"

namespace pd::oracle::grid {

enum class Promise : std::uint8_t {
  finite,       ///< no NaN, no infinity
  contact,      ///< the exact class
  bracket,      ///< lower <= true value <= upper, and the value between them
  width,        ///< 2e-14 S (certified; contact: or kContactTolerance), or the value rounded down and up (tightest)
  translation,  ///< separates exactly as stored, no longer than upper (contact: up to rounding)
  normal,       ///< unit, along the translation, and the depth is attained in its direction
  witness,      ///< in the bodies, and their difference is the translation
  feature,      ///< the faces of an optimal direction (tightest)
  zero,         ///< fields that the class says are zero
  swap,         ///< the same numbers for (B, A), translation and normal negated
  order,        ///< the same bits for the same points in another order
};
inline constexpr int kPromises = 11;
[[nodiscard]] std::string_view to_string(Promise promise);

struct Breach {
  Promise promise;
  std::string what;
};

/// What `Bracket::contact` is asked with: far below the least signed distance of the grid other than 0, which is 1 /
/// 281.
inline constexpr double kContactTolerance = 0x1p-40;

/// A pair of bodies, the hulls that the library was asked about, and how.
struct Question {
  PlacedBody a;
  PlacedBody b;
  const ConvexPolytope* hull_a;  ///< for the numbering of the features
  const ConvexPolytope* hull_b;
  Bracket bracket = Bracket::tightest;
};

struct Findings {
  std::vector<Breach> wrong;
  /// Tightest, overlapping: upper is the double after the depth rounded up. Allowed where no translation of doubles is
  /// as short as that and separates, which is not decided here but for depths that are doubles.
  bool upper_is_next = false;
};

/// What is broken of the promises but the laws; `judge` holds the verdict about the same pair.
[[nodiscard]] Findings check_answer(const Judge& judge, const Verdict& verdict, const Question& question,
                                    const PenetrationDepth& answer);

/// `swapped` is the answer about (b, a) of the question.
[[nodiscard]] std::vector<Breach> check_swapped(const Judge& judge, const PenetrationDepth& answer,
                                                const PenetrationDepth& swapped);

/// `reordered` is the answer about the same points given in another order.
[[nodiscard]] std::vector<Breach> check_reordered(const PenetrationDepth& answer, const PenetrationDepth& reordered);

}  // namespace pd::oracle::grid

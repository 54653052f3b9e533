/// @file
/// Tells answers that doubles hold from those past their range, and makes the error that refuses the latter.
///
/// Bodies may be of sizes so far apart that a length of their answer is infinite or NaN. The queries of C++ return such
/// an answer as it is. The interfaces for other languages, and the line protocol, refuse it in the words given here.
#pragma once

#include <string>
#include <utility>

#include "pd/compound/compound_depth.hpp"
#include "pd/contact/manifold.hpp"
#include "pd/depth/depth_answer.hpp"
#include "pd/depth/directional_depth.hpp"
#include "pd/numeric/expected.hpp"
#include "pd/numeric/vector.hpp"

namespace pd {

/// The error out_of_range of an answer that holds infinity or NaN. @param where  the argument that asked for it
[[nodiscard]] inline Error past_doubles(std::string where) {
  return {ErrorCode::out_of_range, "the answer is past the range of doubles; bring the sizes nearer to each other",
          std::move(where)};
}

namespace detail {

// Zero for finite numbers, else NaN: no branches.
inline double zero_of(double x) { return 0 * x; }
inline double zero_of(const Vec3& v) { return zero_of(v.x()) + zero_of(v.y()) + zero_of(v.z()); }

}  // namespace detail

/// Tells whether all of the numbers and vectors are finite.
template <class... Values>
[[nodiscard]] bool all_finite(const Values&... values) {
  return (detail::zero_of(values) + ...) == 0;
}

[[nodiscard]] inline bool is_finite(const PenetrationDepth& x) {
  return all_finite(x.depth, x.lower, x.upper, x.distance, x.distance_lower, x.distance_upper, x.translation, x.normal,
                    x.witness_a, x.witness_b);
}

[[nodiscard]] inline bool is_finite(const DirectionalDepth& x) {
  return all_finite(x.depth, x.lower, x.upper, x.normal);
}

[[nodiscard]] inline bool is_finite(const UnionDirectionalDepth& x) {
  return all_finite(x.depth, x.lower, x.upper, x.normal);
}

[[nodiscard]] inline bool is_finite(const ContactPoint& x) { return all_finite(x.depth, x.position_a, x.position_b); }

/// Looks at the first `count` points.
[[nodiscard]] inline bool is_finite(const ContactManifold& x) {
  bool finite = all_finite(x.normal);
  for (int i = 0; i < x.count; ++i) finite = finite && is_finite(x.points[static_cast<std::size_t>(i)]);
  return finite;
}

/// The answer, or why there is none: `past_doubles` for one that is not finite.
template <class Answer>
[[nodiscard]] Expected<Answer> finite_or_error(Expected<Answer> answer) {
  if (answer && !is_finite(*answer)) return past_doubles("");
  return answer;
}

}  // namespace pd

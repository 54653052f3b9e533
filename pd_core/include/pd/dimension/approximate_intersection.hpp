/// @file
/// Do convex bodies of R^d meet, up to epsilon of their widths? ([M] Theorem 1, Lemmas 12 to 15.)
///
/// K_epsilon is K grown by epsilon / 2 of its width on both sides in every direction. The answer is yes when the bodies
/// have a common point, no when the grown bodies have none, and either in between. The bodies are preprocessed one by
/// one and queried as they are, under any affine maps. Two of them meet when O lies in A + (-B) (Lemma 12). k of them
/// meet when O lies among the differences from the first, a body in R^((k - 1) d).
///
/// Budget: cutting planes end after O(N^2 log(1 / epsilon)) supports whatever the bodies, and the answer is certified
/// within epsilon.
#pragma once

#include <cstdint>
#include <span>

#include "pd/dimension/composed_body.hpp"

namespace pd::dimension {

/// How O is looked for; see src/dimension/origin_search.hpp.
enum class IntersectionSearch {
  cutting_planes,  ///< GJK, and behind it the ellipsoid method: O(N^2 log(1 / epsilon)) supports in R^N
  nested_ternary,  ///< Lemmas 14 and 15 as printed: O(log^(N - 1)(1 / epsilon)) supports; for comparison
};

struct IntersectionAnswer {
  bool intersect = true;
  std::int64_t support_calls = 0;  ///< of the composed body; each asks every part once
  std::int64_t cuts = 0;           ///< steps of the ellipsoid method among them
  QueryCounters counters;          ///< of the structures
};

/// @param epsilon  in (0, 1), at least 4 times that of every structure inside; the ternary search asks more of macbeath
/// structures (`ternary_oracle_error`).
/// @return ErrorCode::bad_value ("epsilon", or an empty list), limit_exceeded (more than kMaxEquations coordinates),
/// out_of_range where the bodies lie so far from O, or are so slender, that doubles do not carry epsilon.
template <int D>
[[nodiscard]] Expected<IntersectionAnswer> approximate_intersection(
    std::span<const ComposedBody<D>> bodies, double epsilon,
    IntersectionSearch search = IntersectionSearch::cutting_planes);

/// Lemma 13: is the point in K? Yes when it is, no when it is not in K_epsilon, either in between. Errors as above.
template <int D>
[[nodiscard]] Expected<IntersectionAnswer> approximate_membership(
    const ComposedBody<D>& body, const Vector<D>& point, double epsilon,
    IntersectionSearch search = IntersectionSearch::cutting_planes);

}  // namespace pd::dimension

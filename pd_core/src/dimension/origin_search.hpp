/// @file
/// Does the origin lie in K, up to epsilon of K's directional widths? [M] Lemma 13, by two searches over one support
/// oracle.
///
/// K_epsilon is K grown by epsilon / 2 of its width on both sides in every direction. The answer is `true` when O in K,
/// `false` when O is not in K_epsilon, and either in between. Both searches end with a certificate:
///
///   outside: a direction u with h'(u) + g w'(u) < 0, where h' and w' are the oracle's support and width, and g bounds
///   the
///            oracle's error; then h_K(u) < 0;
///   inside:  O is (almost) a convex combination of points of K_epsilon, or no direction is left that could separate.
///
/// Cutting planes: GJK from the centre of K. A support that falls short of O without separating is moved outwards by
/// epsilon / 2 of the width: it lies in K_epsilon, and beyond O. After a fixed number of steps the ellipsoid method on
/// the directions takes over, so that O(N^2 log(1 / epsilon)) calls suffice whatever the body. Nested ternary: Lemmas
/// 14 and 15 as printed, over [-alpha, alpha]^(N-1).
#pragma once

#include <cstdint>

#include "dimension/support_body.hpp"

namespace pd::dimension::detail {

enum class OriginMethod { cutting_planes, nested_ternary };

struct OriginSettings {
  double epsilon = 0;
  OriginMethod method = OriginMethod::cutting_planes;
};

/// What O's side is, and what it took.
struct OriginAnswer {
  bool contains = true;
  bool decided = true;        ///< false: rounding errors at these coordinates are larger than epsilon allows
  Point direction;            ///< separates O from K when !contains: h_K(direction) < 0
  std::int64_t supports = 0;  ///< calls of the oracle
  std::int64_t cuts = 0;      ///< steps of the ellipsoid method among them, 0 in nearly every case
};

/// Requires 0 < epsilon < 1 and relative_error() <= epsilon / 4 (times 8^-(N - 1) and the body's fatness for the
/// ternary search over an oracle that is not consistent; see `ternary_oracle_error`).
[[nodiscard]] OriginAnswer locate_origin(const SupportBody& body, const OriginSettings& settings);

/// The oracle's error at which the ternary search keeps epsilon over an oracle that is not consistent: each level of
/// Lemma 14 loses up to 7 times the error of the one below and the length at which it stops, a factor 8 a level.
/// @param fatness  least width over largest of the body in its fattened frame
[[nodiscard]] double ternary_oracle_error(double epsilon, int dimension, double fatness);

}  // namespace pd::dimension::detail

/// @file
/// A direction sweep for curved bodies: pi = min over unit n of h_P(n), so that every direction gives an upper bound on
/// the signed depth (a lower bound on the distance, where all of them are negative). Sampled and refined in long
/// double; no tessellation, no code of the library's engines.
#pragma once

#include "pd/shape/convex_shape.hpp"

namespace pd::oracle {

/// Support in long double: rounding errors stay below 1e-17 of the size.
struct Vec3L {
  long double x = 0;
  long double y = 0;
  long double z = 0;
};

struct Sweep {
  long double least = 0;  ///< least h_P(n) found: depth <= least; when negative, distance >= -least
  Vec3L direction;        ///< unit
};

/// h_P(n) / |n| for one direction, rounding error below 1e-16 of the size: an answer's own normal proves its upper
/// bound.
[[nodiscard]] long double difference_support(const PosedShape& a, const PosedShape& b, const Vec3& direction);

/// @param directions  number of samples of the sphere; the best `refined` of them are followed downhill by pattern
/// search.
[[nodiscard]] Sweep sweep_directions(const PosedShape& a, const PosedShape& b, int directions = 2000, int refined = 12);

}  // namespace pd::oracle

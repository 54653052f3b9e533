/// @file
/// The foot of the origin on a supporting plane of a curved P, as a point of A and a point of B.
///
/// The face of a search that proves a depth need not hold the foot on the plane that bounds it: faces of opposite sides
/// are tied where bodies share a centre, and a flat body's points on a face lie far apart. But the foot p itself is
/// known. The point q of P nearest to p is found by `closest_point`, and q is the difference of two points of the
/// bodies.
///
/// If q is not p, a plane parts p from P. P lies below that plane, which is therefore nearer to the origin than the
/// plane through p: the search goes on with its foot. The distance of p and q falls by (d / r)^2 each time, where d is
/// the depth and r > d the radius of curvature of P at the foot.
#pragma once

#include <cstdint>
#include <vector>

#include "depth/difference/smooth_difference.hpp"

namespace pd::detail {

struct Foot {
  Vec3 normal;    ///< unit
  double height;  ///< certified: P lies below the plane at this height across `normal`
  Vec3 on_a;      ///< point of A's core, relative to A's translation
  double missed;  ///< distance of height * normal from P at most: on_a + height * normal is so far from B's core
};

/// @param from     a supporting plane; `on_a` and `missed` of any points so far.
/// @param allowed  `missed` is to be no more than this.
/// @param rounds   planes that may be tried: each takes some ten to fifty supports.
/// @return the foot that misses least: `from` itself where no other misses less.
[[nodiscard]] Foot settled_foot(const SmoothDifference& difference, const Foot& from, double allowed, int rounds,
                                std::vector<std::int32_t>& stack, std::int64_t& support_calls);

}  // namespace pd::detail

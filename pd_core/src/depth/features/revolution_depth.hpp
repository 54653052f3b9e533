/// @file
/// The depth of a cylinder or a cone in a solid polytope of not too many facets: by all directions across which a ball
/// inside P can touch P's boundary.
///
/// Let P = V + S with the polytope V and the solid S of revolution, both or their negatives. The largest ball about the
/// origin inside P touches the boundary where P has one supporting plane only, across n say. The face of P there is the
/// sum of the faces of V and S, and its normals are those that both faces have in common. So V's face and S's are one
/// of
///     a facet and anything;  anything and the disc of a cap;
///     an edge, and a point of a rim or a line of the mantle;  a vertex and a line of the mantle,
/// for all else leaves more than one normal. Hence the depth is the least height of P
///  1. across V's facets,
///  2. along the arcs of V's edges (edge_arc.hpp), their ends being 1,
///  3. across the discs,
///  4. across a vertex v and a line of the mantle, n = s d + c m with the axis d, a unit vector m across it and the
///  mantle's
///     own s and c. There h(n) = max_v f_v(m) with f_v(m) = s <v, d> + c <v, m> + (what S adds), and a minimum on v
///     alone is one of f_v, at m opposite to v's part across the axis. The least values of all f_v bound h from below
///     on the whole circle, so that the greatest of them is the only one that can be a minimum of h.
/// Every height is also an upper bound. An arc is left out where a point of P shows it to be high enough: <x, n> is no
/// less along an arc than at its ends, if it is positive there.
#pragma once

#include <optional>

#include "depth/difference/smooth_difference.hpp"
#include "pd/shape/convex_shape.hpp"

namespace pd::detail {

struct RevolutionDepth {
  double lower = 0;       ///< certified, of the cores; with `upper` only where they overlap
  double upper = 0;       ///< certified
  Vec3 normal;            ///< unit
  Vec3 on_a;              ///< of A's core, relative to A's translation; one of B's lies `normal` * depth on
  Vec3 touched;           ///< the point of P farthest along `normal`
  bool is_apart = false;  ///< P's height along `normal` is negative: nothing else is known
};

/// Nothing where the pair is not of this kind or no more than touches, where faces lie flush on each other so that no
/// common point is told, or where the bracket would be wider than `width` and than `relative` of the depth.
///
/// Time: O(facets + edges), some dozen operations each, and some hundred for each arc that is not left out.
[[nodiscard]] std::optional<RevolutionDepth> revolution_depth(const PosedShape& a, const PosedShape& b,
                                                              const SmoothDifference& difference, double relative,
                                                              double width, std::int64_t& support_calls);

}  // namespace pd::detail

/// @file
/// Where the point of P below the origin lies on a facet of P = B + (-A), in doubles: inside of a piece, or where two
/// faces of the bodies meet that lie in one plane.
#pragma once

#include <optional>

#include "depth/difference/polytope_difference.hpp"
#include "depth/facets/near_facets.hpp"

namespace pd::detail {

[[nodiscard]] inline Vec3 turned_vertex(const VertexArrays& v, int i) { return {v.x[i], v.y[i], v.z[i]}; }
template <class Id>
[[nodiscard]] Vec3 turned_edge(const VertexArrays& v, const Id (&ends)[2]) {
  return turned_vertex(v, ends[1]) - turned_vertex(v, ends[0]);
}

/// How far inside of a piece the point below the origin lies; 0 on its border, and beyond it by rounding. Nothing where
/// the piece does not hold that point.
/// @param s      the support along the piece's unit normal, at `height` along it.
/// @param piece  its kind, features and normal; of edges, where on them the point lies is filled in.
/// Requires posed vertices (`PolytopeDifference::prepare_supports`).
[[nodiscard]] std::optional<double> foot_inside(const PolytopeDifference& difference, const DifferenceVertex& s,
                                                double height, NearFacets& piece);

/// A point that faces of both bodies have in common when A is moved by `height` along `normal` (unit), in the common
/// axes, relative to B's translation. The facet of P of two faces that lie in one plane is the sum of both, so that the
/// point below the origin may lie beyond the one face moved by each corner of the other. Nothing where the faces have
/// no point in common, or where neither is a facet.
/// @param slack  corners off a plane by no more lie in it; the point lies in each face up to this.
/// Requires solids of at most `kMostGaussVertices` vertices, supports that are prepared, and a plane across `normal`
/// that supports P at `height`. Time: O(corners of A's face times corners of B's), no allocation.
[[nodiscard]] std::optional<Vec3> meeting_point(const PolytopeDifference& difference, const Vec3& normal, double height,
                                                double slack);

/// Rounding: of corners off their facet's plane, of points beyond a face's border.
[[nodiscard]] inline double foot_rounding(const PolytopeDifference& difference) {
  return 64 * kUnitRoundoff * difference.reach();
}

}  // namespace pd::detail

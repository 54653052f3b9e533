/// @file
/// Which facets and edges of two bodies may belong to a facet of P nearer than a bound: [A] section 2 with most of the
/// two normal diagrams left out.
///
/// A point x of P with <x, n> > bound shows a facet with unit normal n too far. The points tried against a facet are
/// those of one of its own corners with a few vertices of the other body, so that an edge's two facets share them: an
/// edge is left out where one of them shows both facets too far, since along an arc shorter than half a circle <x, n>
/// is a piece of a sine, which stays above a positive level where both ends do.
#pragma once

#include <cstdint>
#include <vector>

#include "depth/difference/polytope_difference.hpp"
#include "depth/expansion/inner_surface.hpp"
#include "pd/shape/pose.hpp"

namespace pd::detail {

struct NearArcs {
  std::vector<std::uint32_t> far;  ///< by facet: the points that show it too far
  std::vector<std::int32_t> kept;  ///< edges, as half-edges
  std::vector<float> levels;       ///< buffer
};

/// A body and the one on the other side of the difference.
struct BodySide {
  const ConvexPolytope& own;
  const Pose& own_pose;
  const ConvexPolytope& other;
  const Pose& other_pose;
  bool is_a;
};

/// @param surface  whose vertices of P are tried, the first ones found first: those stand far apart. Not empty.
/// @param upper    the bound, divided by the difference's reach; positive.
/// Requires bodies with facets. Time O(n).
void find_near_arcs(const BodySide& body, const PolytopeDifference& difference, const InnerSurface& surface,
                    double upper, NearArcs& out);

}  // namespace pd::detail

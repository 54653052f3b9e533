/// @file
/// What the depth of a cylinder or a cone in a polytope (revolution_depth.hpp) does with all facets and all vertices,
/// four at a time.
///
/// Compiled for several instruction sets and chosen at run time, each lane on its own: the same bits on every one.
#pragma once

#include "depth/features/edge_arc.hpp"
#include "pd/shape/convex_polytope.hpp"

namespace pd::detail {

/// A polytope as a part of P, itself or its negative: x -> matrix x + offset.
struct PosedPolytope {
  const ConvexPolytope::Storage& storage;
  double matrix[9];     ///< row by row, with the sense
  double cofactors[9];  ///< row by row, with the sense: they turn normals
  double determinant;   ///< of the matrix without the sense
  double offset[3];
};

/// A facet and the point of a core that is farthest across it: rise * normal + shift * axis, or the middle of its disc.
struct alignas(32) FacetTouch {
  double normal[3];  ///< unit
  double along;      ///< <axis, normal>
  double level;      ///< of the polytope
  double rise;       ///< 0 of an apex and of a disc's middle
  double shift;
  double height;  ///< of the facet and that point, at most P's
};

/// Of the squared sine of a facet's angle from the axis: below, a point of the rim is not told from it, and the middle
/// of its disc stands for it.
inline constexpr double kNearAxis = 0x1p-10;

/// Fills `touches`, which has room for the facets and three more.
/// @param least  the least height of P across a facet. @return the first facet of that height.
int facet_touches(const PosedPolytope& polytope, const RevolvedCore& core, FacetTouch* touches, double& least);

/// By vertex v the least of s <v, d> + c <v, m> over unit vectors m across the axis d, where s is the core's `kink` and
/// s^2 + c^2 = 1. Room for the vertices and seven more in `least`. @return the greatest.
double vertex_circles(const PosedPolytope& polytope, const RevolvedCore& core, double* least);

}  // namespace pd::detail

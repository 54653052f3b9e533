/// @file
/// The normal diagram of a posed polytope in doubles, with the error bounds that the overlay's filter rests on.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "shape/posed_pair.hpp"

namespace pd::detail {

/// One body's diagram in the common frame (rotated, not translated), in doubles with error bounds.
struct PosedDiagram {
  struct Facet {
    double normal[3];  ///< of the body itself, not of P; not normalised
    double bound;      ///< |<e, normal> - exact| <= bound * e.size for the edges e of the other body
  };
  struct Edge {
    double vector[3];  ///< the half-edge's
    double size;       ///< |vector|_1 + edge_size
  };
  std::vector<Vec3> points;
  std::vector<Edge> half_edges;
  std::vector<Facet> facets;
  std::vector<double> normal_errors;  ///< of each coordinate of a facet's normal
  std::vector<std::int32_t> cell;     ///< the other body's vertex that supports a facet's plane from the other side
  double point_error = 0;             ///< of each coordinate of a point
  double edge_error = 0;              ///< of each coordinate of an edge
  double edge_size = 0;               ///< mean |vector|_1
  double reach = 0;                   ///< >= |point|_1
};

/// Poses a body's points and edges.
void pose_edges(const PosedPair& pair, bool of_a, PosedDiagram& diagram);

/// Poses a body's facets, whose normals will be tried against the edges of `other` (posed before). Forgets the cells.
void pose_facets(const ConvexPolytope& body, const PosedDiagram& other, PosedDiagram& diagram);

}  // namespace pd::detail

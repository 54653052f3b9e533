/// @file
/// All facets of P = B + (-A) for two solids of few vertices, by their Gauss maps: a facet of P belongs to a facet of
/// one body or to two edges whose arcs cross (Gregorius, "The separating axis test between convex polyhedra", GDC
/// 2013).
///
/// Which arcs cross is told by signs alone: one for every facet of either body and edge of the other. They are taken in
/// single precision and kept as bits, an edge's bits for all edges of the other body in one word, so that crossings are
/// found 18 at a time; only those, 18 in the mean for two random hulls of 8 vertices, are measured, in double
/// precision.
///
/// Compiled for several instruction sets; every lane on its own: the same bits on each.
#pragma once

#include "shape/small_gauss_map.hpp"
#include "shape/support/vertex_arrays.hpp"

namespace pd::detail {

/// -A or B: P is their sum, moved by an offset.
struct SmallSatBody {
  const SmallGaussMap& map;
  VertexArrays posed;  ///< the vertices of -A or of B, turned
  double normals[9];   ///< what turns the map's normals to those of -A or B, row by row, any positive scale
  double growth;       ///< what <normal, vertex> grows by when both are turned
};

struct SmallSatNearest {
  double key = 0;  ///< the least of sign * square of the facets' distances, of edge pairs that of their nearest corner
  int facet_a = -1;  ///< the winner: a facet of A or of B, or an edge of each by their numbers in the maps
  int facet_b = -1;
  int edge_a = -1;
  int edge_b = -1;
  double sign = 1;          ///< of edge of B x edge of A, to point outwards
  double others_key = 0;    ///< no other facet, of edges that certainly cross, has a lesser key
  double largest = 0;       ///< |coordinate| of P
  double possible_key = 0;  ///< no pair of edges whose sides are not all certain has a facet with a lesser key
  int possible = 0;         ///< such pairs
  int crossings = 0;
};

/// What single precision may add.
struct SmallSatErrors {
  double height;  ///< of a plane of P and a point of P, less the points' own
  float side_a;   ///< of an edge of A along a facet of B
  float side_b;
};

/// `key` is negative as soon as a facet has the origin beyond it; edges are tried otherwise.
SmallSatNearest nearest_of_small(const SmallSatBody& a, const SmallSatBody& b, const double (&offset)[3],
                                 const SmallSatErrors& errors);

}  // namespace pd::detail

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
  double others_key = 0;    ///< no other facet, of edges that certainly cross, has a lesser key; of those that are
                            ///< farther than the bodies' nearest facet only some are looked at
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

/// The facets of P that are not much farther than the nearest one of either body: what the next frames look at
/// (remembered_piece.hpp).
struct SmallNearPieces {
  static constexpr int kMost = 64;
  struct Piece {
    double key;                      ///< sign * square of the distance
    std::int8_t facet_a, facet_b;    ///< -1: none
    std::int8_t vertex_a, vertex_b;  ///< of a facet: where it lies, and the other body's vertex
    std::int8_t edge_a, edge_b;      ///< -1: none
    std::int8_t sign;                ///< of edge of B x edge of A
  };
  double band = 0;        ///< asked for: how much farther
  double radius = 0;      ///< all facets of P that are no farther are listed, if `complete`
  bool complete = false;  ///< they fit, and no side of an edge near them is open
  int count = 0;
  Piece pieces[kMost + 1];

  void add(const Piece& piece) {
    pieces[count] = piece;
    count += static_cast<int>(count < kMost);
  }
};

/// `key` is negative as soon as a facet has the origin beyond it; edges are tried otherwise.
SmallSatNearest nearest_of_small(const SmallSatBody& a, const SmallSatBody& b, const double (&offset)[3],
                                 const SmallSatErrors& errors, SmallNearPieces* near);

}  // namespace pd::detail

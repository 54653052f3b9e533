/// @file
/// All facets of P = B + (-A) for two solids of few facets, by their Gauss maps: a facet of P belongs to a facet of one
/// body or to two edges whose arcs cross (Gregorius, "The separating axis test between convex polyhedra", GDC 2013).
///
/// Heights of vertices along facets in single precision tell which facets may be the nearest, which edges may belong to
/// a facet of P that is as near (arc_culling.hpp), which pairs of edges cross, or may, and which of many pairs may be
/// as near (gauss_sat_crossings.hpp). Only those are measured, in double precision, which also tells the sides that
/// single precision leaves open.
///
/// One text for bodies of at most eight vertices, whose arrays are small and laid out beforehand, and for bodies of at
/// most 32. Compiled for several instruction sets; every lane on its own: the same bits on each.
#pragma once

#include <cstdint>

#include "pd/shape/convex_polytope.hpp"
#include "shape/support/vertex_arrays.hpp"

namespace pd::detail {

/// Bodies of more vertices or facets are left to the surface.
inline constexpr int kMostGaussVertices = 32;
inline constexpr int kMostGaussFacets = 64;

/// -A or B: P is their sum, moved by an offset.
struct GaussSatBody {
  const ConvexPolytope::Storage& storage;
  VertexArrays posed;  ///< the vertices of -A or of B, turned
  double turn[9];      ///< what turns facets' normals to those of -A or B, row by row, about a rotation
  double growth;       ///< what <normal, vertex> grows by when both are turned
};

/// A facet of P by facets and vertices of the bodies.
struct GaussPiece {
  std::int8_t facet_a, facet_b;  ///< -1: none
  /// Of a facet: a corner of it, and first the vertex of the other body that is farthest along its normal. Of two
  /// edges: their ends, (b[1] - b[0]) x (a[1] - a[0]) pointing outwards.
  std::int8_t a[2], b[2];

  [[nodiscard]] bool is_of_edges() const { return facet_a < 0 && facet_b < 0; }
};

/// The facets of P that are not much farther than the nearest one of either body: exact numbers tell the nearest of
/// them (gauss_ties.hpp).
struct NearGaussPieces {
  static constexpr int kMost = 64;
  struct Measured {
    double key;  ///< sign * square of the distance
    GaussPiece piece;
  };
  double band = 0;        ///< asked for: how much farther
  double radius = 0;      ///< all facets of P that are no farther are listed, if `complete`
  bool complete = false;  ///< the list has room for them
  /// For boxes, bit 3 i + j says that edge i of A and edge j of B are parallel up to rounding. If they are not exactly
  /// parallel, their facets are not listed, and may be as near.
  unsigned parallel = 0;
  double beyond = 0;      ///< no facet of P that is not listed is nearer; 0: not known
  bool all_told = false;  ///< every facet that is nearer is listed; else one of several in a plane
  int count = 0;
  Measured pieces[kMost + 1];

  void add(double key, const GaussPiece& piece) {
    pieces[count] = {key, piece};
    count += static_cast<int>(count < kMost);
  }
  /// Drops the pieces that are farther than `distance`. Facets that are not listed may then be as near as `distance`
  /// less an error.
  void keep_within(double distance, double error) {
    int kept = 0;
    for (int i = 0; i < count; ++i) {
      pieces[kept] = pieces[i];
      kept += static_cast<int>(!(pieces[i].key > distance * distance));
    }
    count = kept;
    beyond = distance - error < beyond ? distance - error : beyond;
  }
};

/// A pair of edges, nearly parallel, that may belong to a facet of P: a sliver. Its normal is badly known.
struct ThinPair {
  double bound;  ///< it is no nearer
  GaussPiece piece;
  std::uint8_t facets_a[2], facets_b[2];  ///< beside the edges
  bool oriented;                          ///< else all sides are open, and its normal may point either way
};

struct ThinPairs {
  static constexpr int kMost = 256;
  int count = 0;
  double unoriented = 0;  ///< pairs whose normal may point either way are no nearer, once all pairs are bounded
  ThinPair pairs[kMost + 1];
};

struct NearestByGaussMaps {
  enum class Outcome : std::uint8_t {
    found,
    beyond,  ///< a facet has the origin beyond it
    full,    ///< more edges are near than there is room for
  };
  Outcome outcome = Outcome::full;
  double key = 0;         ///< least of sign * square of distances, of edge pairs that of their nearest corner
  double others_key = 0;  ///< no other facet has a lesser key, but those of the thin pairs listed
  GaussPiece piece{-1, -1, {0, 0}, {0, 0}};  ///< the winner
  int pieces = 0;                            ///< measured
};

/// What rounding may add.
struct GaussSatErrors {
  double reach;   ///< of P from its middle
  double height;  ///< of a facet's plane in P, by single precision
  float side_a;   ///< of an edge of A along a facet of B, by single precision
  float side_b;
  double fine_side_a;  ///< by double precision
  double fine_side_b;
  double upper;  ///< of the depth
  double room;   ///< slivers no nearer than the winner less this are not listed
};

/// @param near  asks for the facets that are not much farther; nullptr where the nearest one is enough.
/// @param thin  filled with the slivers that may be nearer than the winner.
/// Either body has at most `kMostGaussVertices` vertices and `kMostGaussFacets` facets.
NearestByGaussMaps nearest_by_gauss_maps(const GaussSatBody& a, const GaussSatBody& b, const double (&offset)[3],
                                         const GaussSatErrors& errors, NearGaussPieces* near, ThinPairs& thin);

}  // namespace pd::detail

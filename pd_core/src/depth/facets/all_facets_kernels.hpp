/// @file
/// All facets of P = B + (-A) for two solids of up to 64 facets each, by their Gauss maps, as small_sat_kernels.hpp has
/// it for eight vertices: for bodies deep in each other, where a surface that grows inside P would meet most of them.
///
/// Heights of vertices along facets in single precision tell which facets may be the nearest, which edges may belong to
/// a facet of P that is as near (arc_culling.hpp), and on which side of a facet's normal an edge runs. Facets and
/// crossings that are left are measured in double precision.
///
/// Compiled for several instruction sets; every lane on its own: the same bits on each.
#pragma once

#include "pd/shape/convex_polytope.hpp"
#include "shape/support/vertex_arrays.hpp"

namespace pd::detail {

/// -A or B: P is their sum, moved by an offset.
struct AllFacetsBody {
  static constexpr int kMostVertices = 32;
  static constexpr int kMostFacets = 64;

  const ConvexPolytope::Storage& storage;
  VertexArrays posed;  ///< the vertices of -A or of B, turned
  double turn[9];      ///< what turns facets' normals to those of -A or B, row by row, about a rotation
};

struct NearestOfAllFacets {
  enum class Outcome : std::uint8_t {
    found,
    beyond,  ///< a facet has the origin beyond it
    open,    ///< the side of an edge is within its error, or more edges are near than there is room for
  };
  Outcome outcome = Outcome::open;
  double key = 0;  ///< the least of sign * square of the facets' distances, of edge pairs that of their nearest corner
  double others_key = 0;  ///< no other facet has a lesser key
  int facet_a = -1;       ///< the winner: a facet of A or of B, or an edge of each by its vertices
  int facet_b = -1;
  int edge_a[2] = {-1, -1};
  int edge_b[2] = {-1, -1};
  double sign = 1;     ///< of (edge of B) x (edge of A), each from its first vertex to its second, to point outwards
  double largest = 0;  ///< |coordinate| of P
  int pieces = 0;      ///< measured
};

/// What single precision may add.
struct AllFacetsErrors {
  double height;  ///< of a facet's plane in P
  float side_a;   ///< of an edge of A along a facet of B
  float side_b;
};

NearestOfAllFacets nearest_of_all_facets(const AllFacetsBody& a, const AllFacetsBody& b, const double (&offset)[3],
                                         const AllFacetsErrors& errors);

}  // namespace pd::detail

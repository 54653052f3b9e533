/// @file
/// The nearest facet of P where so many are nearly as near that growing a surface inside P would meet them all: those
/// of [A] section 2 whose planes may be as near as a known bound, in doubles with a certificate.
///
/// [A] step 1: the planes of the facets of one body that may be near (arc_culling.hpp) are measured by supports. Step
/// 2: of the edges left all pairs of lines are tried, four at a time (line_kernels.hpp): 0.4 ns a pair, less than the
/// dual tree of closest_lines.hpp takes for bodies of up to some thousands of edges.
///
/// Why it proves anything: the boundary of P consists of facets with a facet of one body and of parallelograms of two
/// edges whose arcs cross. No pair is taken for crossing that need be: a pair that doubles cannot exclude counts, so
/// that the least distance is a lower bound, and the support in the winner's normal is an upper bound. Pieces of two
/// edges parallel up to rounding are near-degenerate parallelograms, no wider than their sine times the shorter edge:
/// what they hide is taken off the lower bound.
#pragma once

#include <cstdint>
#include <vector>

#include "depth/certificate/nearest_facet_proof.hpp"
#include "depth/difference/polytope_difference.hpp"
#include "depth/expansion/inner_surface.hpp"
#include "depth/facets/arc_culling.hpp"
#include "depth/facets/line_kernels.hpp"
#include "pd/shape/pose.hpp"

namespace pd::detail {

struct NearFacetsBuffers {
  /// An edge in the common frame, lengths divided by the reach.
  struct Edge {
    Vec3 direction;  ///< unit
    Vec3 left;       ///< normals of its body's facets, nearly unit
    Vec3 right;
    Vec3 point;  ///< where it begins
    double length;
    std::int32_t from;  ///< vertices
    std::int32_t to;
  };
  enum class Kind : std::uint8_t { facet_of_a, facet_of_b, edges };
  struct Candidate {
    Kind kind;
    bool certain;    ///< a facet of P for certain
    std::int32_t a;  ///< facet, vertex, or number of an edge below
    std::int32_t b;
    double lower;  ///< of the piece's distance, divided by the reach
    double upper;
    Vec3 normal;  ///< unit, outward, once `lower` is sharp
  };
  NearArcs near_a;
  NearArcs near_b;
  std::vector<Edge> edges_a;
  std::vector<Edge> edges_b;
  std::vector<double> lines_a[6];
  std::vector<std::uint64_t> near;
  std::vector<Candidate> candidates;
  std::vector<SurfaceCorners> nearest;
};

/// The piece of P's boundary that holds its point nearest to the origin.
struct NearFacets {
  bool certified = false;  ///< the bracket is as narrow as asked; else nothing below is known but the counts
  double lower = 0;
  double upper = 0;
  Vec3 normal = Vec3::UnitX();  ///< unit, of `upper`
  NearFacetsBuffers::Kind kind = NearFacetsBuffers::Kind::edges;
  std::int32_t facet = -1;   ///< of A or of B
  std::int32_t vertex = -1;  ///< of the other body
  std::int32_t edge_a[2];    ///< vertices
  std::int32_t edge_b[2];
  /// Where the point below the origin lies on the two edges, 0 at the first vertex, 1 at the second.
  double along_a = 0;
  double along_b = 0;
  /// For an exact answer: `NearFacetsBuffers::nearest` holds three corners of every piece that may be the nearest one,
  /// the likeliest first, and all others are at least this far away; 0 where near-degenerate parallelograms leave that
  /// open.
  double beyond = 0;
  std::int64_t pairs = 0;
  std::int64_t facets = 0;
  std::int64_t support_calls = 0;
};

struct NearFacetsSettings {
  double lower = 0;  ///< certified bounds of the depth, lower > 0
  double upper = 0;
  double width = 0;  ///< of the bracket asked for, in units of L
};

/// @param surface  some vertices of P.
/// Fails (`certified` false) for flat bodies, where too much is left to try pair by pair, and where doubles do not
/// narrow the bracket enough. Time O(n) and 0.4 ns a pair of edges left, of which there may be 256 (m + n) for m and n
/// edges.
NearFacets nearest_of_near_facets(const ConvexPolytope& a, const Pose& pose_a, const ConvexPolytope& b,
                                  const Pose& pose_b, const PolytopeDifference& difference, const InnerSurface& surface,
                                  const NearFacetsSettings& settings, std::vector<std::int32_t>& stack,
                                  NearFacetsBuffers& buffers);

}  // namespace pd::detail

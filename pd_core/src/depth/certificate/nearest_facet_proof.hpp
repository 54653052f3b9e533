/// @file
/// From a surface of points of P round the origin to the nearest facet of P, proved on the stored numbers without big
/// numbers where the geometry allows: the bridge from a best-first expansion in doubles to an exact answer.
///
/// Every triangle of the surface has points of P for corners, so the ball that reaches its nearest triangle lies in P
/// (inner_surface.hpp): the depth is at least the least distance of a triangle's plane. Where that very plane supports
/// P, the depth is also at most that distance. Both sides hold for the exact points, whatever the doubles were that led
/// here.
#pragma once

#include <array>
#include <optional>
#include <span>

#include "depth/certificate/support_faces.hpp"
#include "depth/distance/gjk_exact.hpp"

namespace pd::detail {

/// A triangle of the surface, counter-clockwise from outside.
struct SurfaceCorners {
  VertexPair v[3];
};

struct ProvenFacet {
  FacetOfDifference facet;
  FacetPlane plane;
};

/// Proves one of the triangles to lie in the nearest facet of P. Requires a surface as above with the origin strictly
/// behind all of its triangles.
/// @param near    triangles that may be nearest.
/// @param beyond  every other triangle is at least so far from the origin (the pair's scaled lengths).
/// @param first_of_equals  of facets exactly as near as the first triangle's, that one is wanted. Else ties are left
/// open.
/// @param faces   filled with the faces in the facet's plane.
/// @return nothing where no triangle lies in a facet, or a tie is left open: an exact search must.
[[nodiscard]] std::optional<ProvenFacet> prove_nearest_facet(const PosedPair& pair,
                                                             std::span<const SurfaceCorners> near, double beyond,
                                                             bool first_of_equals, SupportFaces& faces);

/// The same of one piece of P's boundary where every other one is `beyond` or farther.
[[nodiscard]] std::optional<ProvenFacet> prove_facet(const PosedPair& pair, const FacetOfDifference& facet,
                                                     double beyond, SupportFaces& faces);

/// The same where the facet's plane is known to support P.
[[nodiscard]] std::optional<ProvenFacet> prove_supporting_facet(const PosedPair& pair, const FacetOfDifference& facet,
                                                                double beyond);

/// Cores that are apart: the plane through P's point nearest to the origin, normal to it (distance negative), and that
/// point as a combination of vertices of P.
struct ProvenSeparation {
  FacetPlane plane;
  int count = 0;
  std::array<VertexPair, 3> simplex{};
  std::array<double, 3> weights{};
};

/// Proves that the point of the simplex nearest to the origin is P's: it lies in the simplex' relative interior, and
/// the plane normal to it supports P. Nothing where the simplex is not the right one, or double-double cannot tell.
/// @param faces  filled with the faces in that plane.
[[nodiscard]] std::optional<ProvenSeparation> prove_separation(const PosedPair& pair,
                                                               std::span<const VertexPair> simplex,
                                                               SupportFaces& faces);

}  // namespace pd::detail

/// @file
/// The memory of a pair: the surface inside P that the last query ended with, by ids, and what else it may begin from.
/// The next query poses the surface anew and proves its nearest face as if there had been no memory.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "pd/numeric/vector.hpp"
#include "pd/shape/convex_polytope.hpp"
#include "pd/shape/convex_shape.hpp"
#include "shape/support/vertex_pair.hpp"

namespace pd::detail {

/// More faces and vertices are not remembered. A closed triangulated surface of F faces has F / 2 + 2 vertices.
inline constexpr int kMaxRememberedFaces = 128;
inline constexpr int kMaxRememberedVertices = kMaxRememberedFaces / 2 + 2;

struct CachedFace {
  std::int16_t vertex[3];
  std::int16_t neighbour[3];
};

/// Of bodies apart, one of them smooth: points of the cores whose differences surround the closest point of P, each in
/// its body's frame.
struct WarmSmoothPoints {
  std::optional<ConvexShape> a, b;  ///< the very shapes: points of others lie anywhere
  Vec3 on_a[3];
  Vec3 on_b[3];
  int count = 0;
  double taken_out = 0;  ///< of the radii of the cores that hold the points, which brackets choose
};

/// Of bodies that rest on each other: the facet of either that faces the other, and how often they were of no use
/// (Bracket::contact, pair/contact_facets.hpp).
struct WarmFacets {
  struct OfBody {
    std::optional<ConvexPolytope> owner;  ///< the very polytope; facet -1: none
    int facet = -1;
    std::int32_t near = -1;  ///< vertex of the other body that lay on it
  };
  OfBody bodies[2];      ///< of A, of B
  int first = 1;         ///< the one that answered last
  int pause_length = 0;  ///< frames to go without after one without an answer
  int pause = 0;
};

/// What a WarmCertificate holds.
struct WarmState {
  WarmFacets facets;  ///< first: bodies at rest read nothing else, and hosts may fetch it beforehand
  /// The shapes by content, not by address: the same calls give the same bits wherever memory lies.
  std::int32_t vertices_a = 0;
  std::int32_t vertices_b = 0;
  double radius_a = 0;
  double radius_b = 0;
  Vec3 direction = Vec3::Zero();  ///< last normal, or last separating direction
  std::vector<VertexPair> vertices;
  std::vector<CachedFace> faces;
  // Of bodies apart: the vertices of P around its point closest to the origin.
  VertexPair apart[3];
  int apart_count = 0;
  WarmSmoothPoints smooth;
};

}  // namespace pd::detail

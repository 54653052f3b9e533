/// @file
/// Every facet of P = B + (-A), one by one, without building P: the overlay of the normal diagrams of B and -A ([A]
/// section 2.2), walked.
///
/// A facet of P is a facet of one body and a vertex of the other, or an edge of each. Where facets or edges of the
/// two are parallel it is a sum of two larger faces. The walk meets it as several pieces in one plane (as if A were
/// turned by infinitely little) or united, as the caller asks.
///
/// [A] Agarwal, Guibas, Har-Peled, Rabinovitch, Sharir, "Penetration depth of two convex polytopes in 3D", 2000.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "pd/shape/convex_polytope.hpp"
#include "pd/shape/feature.hpp"
#include "pd/shape/pose.hpp"

namespace pd {

namespace detail {
struct OverlayBuffers;
}

/// A facet of P, or a piece of one: the faces of A and B whose difference it is.
struct OverlayFacet {
  Feature on_a;
  Feature on_b;
};

class OverlayVisitor {
 public:
  virtual ~OverlayVisitor() = default;
  /// Takes the next facets (at most a few hundred at a time; valid during the call). Returns false to stop the walk.
  virtual bool visit(std::span<const OverlayFacet> facets) = 0;
};

struct OverlayCounts {
  std::int64_t facet_vertex = 0;  ///< a facet of A with a vertex, edge or facet of B
  std::int64_t vertex_facet = 0;  ///< a vertex or an edge of A with a facet of B
  std::int64_t edge_edge = 0;
  [[nodiscard]] std::int64_t total() const { return facet_vertex + vertex_facet + edge_edge; }
};

enum class OverlayPieces : std::uint8_t {
  as_walked,  ///< facet-vertex, vertex-facet and edge-edge pieces only; those of two parallel edges have no area
  united,     ///< each facet of P once, K in all, as the largest two faces; none when P is flat
};

/// Walks overlays. Owns the buffers: one object per thread, nothing is allocated once they have grown.
class Overlay {
 public:
  Overlay();
  ~Overlay();
  Overlay(Overlay&&) noexcept;
  Overlay& operator=(Overlay&&) noexcept;

  /// Visits every facet of P exactly once, in an order that depends on the two posed bodies alone, and counts them
  /// (those that were visited, when the visitor stopped the walk). Exact on the stored numbers and poses. Time O(m + n
  /// + K deg) for m and n edges, K pieces and vertices of degree deg; measured 10 to 20 ns a piece for large K.
  OverlayCounts walk(const ConvexPolytope& a, const Pose& pose_a, const ConvexPolytope& b, const Pose& pose_b,
                     OverlayPieces pieces, OverlayVisitor& visitor);
  /// Counts alone.
  OverlayCounts count(const ConvexPolytope& a, const Pose& pose_a, const ConvexPolytope& b, const Pose& pose_b,
                      OverlayPieces pieces);

 private:
  std::unique_ptr<detail::OverlayBuffers> buffers_;
};

}  // namespace pd

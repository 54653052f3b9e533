/// @file
/// The medial axis of R = P + (-Q), and with it the depth of many placements of Q ([D] Theorem 3.2).
///
/// Inside a convex polygon the distance to the boundary is the least of the distances to its edges' lines; the medial
/// axis is where two edges are equally near. It is a tree with a leaf at every corner and n - 2 inner nodes, each
/// equally far from three edges.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>

#include "pd/planar/convex_depth.hpp"

namespace pd {

/// Immutable, cheap to copy.
class MedialAxis {
 public:
  struct Node {
    Point2 position;
    double radius;  ///< distance to its three edges
    /// Edges of R (indices into convex_difference's corners), counter-clockwise.
    std::array<std::int32_t, 3> edges;
    /// The node beyond the bisector of the two other edges; -1: a corner of R.
    std::array<std::int32_t, 3> links;
  };

  /// Chew's randomised algorithm ("Building Voronoi diagrams for convex polygons in linear expected time", 1990).
  /// Edges are taken off in a fixed random order, each remembering its neighbours. They are put back in the reverse
  /// order, so that each finds its place at one known corner. Expected time O(n + m) for the axis; the tree of its
  /// centroids takes O((n + m) log(n + m)). Nodes are computed in double-double and their order decided there, not
  /// exactly: answers do not depend on it (see `depth`).
  static MedialAxis build(const ConvexPolygon& p, const ConvexPolygon& q);

  [[nodiscard]] std::span<const Node> nodes() const;
  [[nodiscard]] int num_edges() const;  ///< of R
  /// Nodes made and dropped while building.
  [[nodiscard]] std::int64_t work() const;

  /// sigma(P, Q displaced): equal to `convex_depth`, which see. The class is exact. The edge is found by the tree of
  /// centroids: at a node, the directions to its three edges divide R, and one of the parts holds the point. Every edge
  /// within 1e-12 of R's size of being nearest is then compared exactly, cell after cell from the one that was found.
  /// Time O(log n + log m) and the number of those edges; all of them at the centre of a regular polygon.
  [[nodiscard]] Expected<PlanarDepth> depth(const Point2& displacement) const;

 private:
  struct Storage;
  explicit MedialAxis(std::shared_ptr<const Storage> data) : data_(std::move(data)) {}
  std::shared_ptr<const Storage> data_;
};

}  // namespace pd

/// @file
/// The lines of one body's edges in a tree, for the closest pair of lines among the edge-edge facets of P.
///
/// Lines are Pluecker coordinates: a unit direction d and the moment m = p x d of a point p. For lines of B and of A
///   N = <p - p', d x d'> = <m, d'> + <d, m'> with m' = p' x d'
/// is, up to sign, |d x d'| times their distance: one bilinear form in six coordinates. Nodes bound their lines twice,
/// in the sphere of normals (by slabs round the arcs, to see which arcs can cross) and in the six coordinates (centre,
/// chord and the residuals beyond it, to bound N over blocks of lines). They are halved when they are asked for.
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <vector>

#include "depth/facets/shared_facets.hpp"
#include "numeric/unit_roundoff.hpp"
#include "structure/overlay/overlay_walk.hpp"

namespace pd::detail {

/// (d, m) of a line of B. A's lines are stored as (m', d'), so that N is the plain product of the two.
using Line6 = std::array<double, 6>;

inline double dot(const Line6& x, const Line6& y) {
  return ((x[0] * y[0] + x[1] * y[1]) + (x[2] * y[2] + x[3] * y[3])) + (x[4] * y[4] + x[5] * y[5]);
}

class LineTree {
 public:
  /// Slabs are taken along so many directions: the axes and the diagonals of the cube.
  static constexpr int kSlabs = 7;
  static constexpr int kLeaf = 4;

  struct Slabs {
    std::array<double, kSlabs> low;
    std::array<double, kSlabs> high;

    [[nodiscard]] bool apart_from(const Slabs& other) const {
      for (std::size_t k = 0; k < kSlabs; ++k) {
        if (low[k] > other.high[k] || other.low[k] > high[k]) return true;
      }
      return false;
    }
  };

  struct Node {
    std::int32_t first;  ///< lines first .. last - 1
    std::int32_t last;
    std::int32_t left = -1;  ///< children left and left + 1; -1 when it has none (yet)
    Line6 centre;            ///< mean of the lines
    Line6 chord;             ///< unit, or zero
    double low;              ///< least and greatest <line - centre, chord>
    double high;
    double residual;  ///< >= |line - centre - chord <line - centre, chord>|
    Slabs slabs;
    EdgeFacets facets{-1, -1};  ///< to which all its edges belong

    [[nodiscard]] std::int64_t size() const { return last - first; }
    [[nodiscard]] bool is_leaf() const { return last - first <= kLeaf; }
  };

  /// Where lines are taken from: the points of a walk's posed diagrams less `origin`, scaled.
  struct Frame {
    Vec3 offset;   ///< of B's points from A's: t_B - t_A
    Vec3 origin;   ///< in A's frame
    double scale;  ///< multiplies lengths, so that all points of P lie within 1 of the origin
  };

  /// |error| of each coordinate of a line's direction: an edge is the difference of stored points (u of each
  /// coordinate), turned (u for the matrix, 3u for products and sums, all of |edge|), and divided by its length (4u).
  static constexpr double kDirectionError = 16 * kUnitRoundoff;
  /// |error| of each coordinate of the difference of two points of lines: each is turned (5u of its length), moved, and
  /// the sum is at most 1.
  static constexpr double kPointError = 16 * kUnitRoundoff;

  void clear();
  /// The edges are half-edges, one for each edge; the facets shared with the other body are numbered facet by facet.
  /// Time O(k).
  void build(const PosedPair& pair, const OverlayBuffers& overlay, bool of_a, const std::vector<std::int32_t>& edges,
             const std::vector<std::int32_t>& shared_facets, const Frame& frame);

  [[nodiscard]] bool empty() const { return nodes_.empty(); }
  [[nodiscard]] const Node& node(int i) const { return nodes_[static_cast<std::size_t>(i)]; }
  /// The first of a node's two children, made where there are none yet: time O(lines). Requires a node that is no leaf.
  /// Moves nodes.
  int children(int node);

  [[nodiscard]] std::int32_t half_edge(int line) const { return half_edges_[order(line)]; }
  /// Those round its arc.
  [[nodiscard]] const Slabs& slabs(int line) const { return slabs_[order(line)]; }
  [[nodiscard]] const EdgeFacets& facets(int line) const { return facets_[order(line)]; }
  /// A node's lines lie one behind the other.
  [[nodiscard]] const Line6& line(int i) const { return lines_[static_cast<std::size_t>(i)]; }
  /// The point of a line that its moment is taken from.
  [[nodiscard]] const Vec3& point(int line) const { return points_[order(line)]; }
  /// Greatest |line|.
  [[nodiscard]] double largest() const { return largest_; }

 private:
  [[nodiscard]] std::size_t order(int i) const { return static_cast<std::size_t>(order_[static_cast<std::size_t>(i)]); }
  void bound(Node& node) const;

  struct Key {
    double at;
    std::int32_t line;  ///< parts equals, so that the order does not depend on how they came
    std::int32_t position;
    friend auto operator<=>(const Key&, const Key&) = default;
  };

  std::vector<Node> nodes_;
  std::vector<Line6> lines_;         ///< node by node, as `order_`
  std::vector<std::int32_t> order_;  ///< where the other arrays hold a line
  std::vector<Key> keys_;
  std::vector<Line6> moved_;
  std::vector<Vec3> points_;
  std::vector<Vec3> middles_;  ///< of the arcs
  std::vector<Slabs> slabs_;
  std::vector<std::int32_t> half_edges_;
  std::vector<EdgeFacets> facets_;
  double largest_ = 0;
};

}  // namespace pd::detail

/// @file
/// A convolved triangle T + (-B) in implicit form ([D] section 4.1, step 2): the three places where T's edges go
/// between those of -B, in slope order. Any vertex or edge in constant time, all in O(1) space; parallel edges are one
/// edge. T may be any convex part of P: its k places take O(k) space, and a search among them O(log k) time. Corners of
/// T and B may lie inside a side: then several consecutive edges of the sum have one direction.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "planar/boundary/box_tree.hpp"
#include "planar/boundary/sum_geometry.hpp"

namespace pd::detail {

/// -B for a convex polygon B: its edges by their angle in (-90, 270] degrees.
class NegatedChain {
 public:
  /// `points`: B counter-clockwise. A single point has no edges.
  explicit NegatedChain(std::vector<Point2> points);

  [[nodiscard]] int size() const { return size_; }
  /// B's vertex k (mod size), k <= size: -point(k) is vertex k of -B. Vertex 0 is the least of -B.
  [[nodiscard]] const Point2& point(int k) const { return points_[static_cast<std::size_t>(k)]; }
  /// Of the caller's points, the one that is vertex k.
  [[nodiscard]] int index(int k) const { return size_ == 0 ? 0 : (first_ + k) % size_; }
  [[nodiscard]] PlaneDirection edge(int k) const { return {point(k + 1), point(k)}; }
  /// How many edges have a smaller angle than d.
  [[nodiscard]] int edges_before(const PlaneDirection& d) const;
  /// A box of B's vertices first .. first + count (mod size), in constant time.
  [[nodiscard]] Box2 box(int first, int count) const;

 private:
  std::vector<Point2> points_;           ///< vertex 0 again at the end
  std::array<std::int32_t, 4> extreme_;  ///< vertices of least and greatest x and y
  int size_;
  int first_;
};

/// A convex part of P: indices of its corners, counter-clockwise. Some may lie inside a side.
class ConvexPart {
 public:
  ConvexPart(const std::vector<Point2>& points, std::vector<std::int32_t> corners)
      : points_(&points), corner_(std::move(corners)) {
    const auto least = std::min_element(corner_.begin(), corner_.end(), [&](std::int32_t a, std::int32_t b) {
      return points[static_cast<std::size_t>(a)] < points[static_cast<std::size_t>(b)];
    });
    std::rotate(corner_.begin(), least, corner_.end());
  }

  [[nodiscard]] int size() const { return static_cast<int>(corner_.size()); }
  /// The first corner is the least.
  [[nodiscard]] const std::vector<std::int32_t>& corners() const { return corner_; }
  /// The corner after the last one is the first.
  [[nodiscard]] const Point2& point(int a) const {
    const std::size_t k = static_cast<std::size_t>(a) == corner_.size() ? 0 : static_cast<std::size_t>(a);
    return (*points_)[static_cast<std::size_t>(corner_[k])];
  }
  [[nodiscard]] PlaneDirection edge(int a) const { return {point(a), point(a + 1)}; }

 private:
  const std::vector<Point2>* points_;
  std::vector<std::int32_t> corner_;
};

class ConvexSum {
 public:
  /// Requires that both parts stay where they are.
  ConvexSum(const ConvexPart& part, const NegatedChain& chain);

  [[nodiscard]] int size() const { return size_; }
  [[nodiscard]] int num_corners() const { return part_->size(); }
  [[nodiscard]] const std::vector<std::int32_t>& corners() const { return part_->corners(); }
  [[nodiscard]] const NegatedChain& chain() const { return *chain_; }

  /// What edge t (0 <= t < size) is made of: T's edge from corner `a`, -B's edge from vertex `b`, or both where they
  /// are parallel. The edge starts at corner a minus vertex b.
  struct Parts {
    int a, b;
    bool of_triangle, of_chain;
  };
  [[nodiscard]] Parts parts(int t) const;
  [[nodiscard]] SumPoint vertex(int t) const;
  [[nodiscard]] PlaneDirection direction(int t) const;
  [[nodiscard]] Span edge(int t) const { return {vertex(t), direction(t), vertex(t + 1 == size_ ? 0 : t + 1)}; }
  /// How many edges have a smaller angle than d: the number of the first one that has not, which starts at the vertex
  /// farthest to the right of d (`size` stands for 0).
  [[nodiscard]] int edges_before(const PlaneDirection& d) const;
  /// The edge that T's edge from corner a lies on.
  [[nodiscard]] int edge_of_corner(int a) const { return place_[static_cast<std::size_t>(a)].edge; }
  [[nodiscard]] const Point2& corner(int a) const { return part_->point(a); }

  /// Strictly inside, or else an edge that the point lies on or beyond.
  struct Location {
    bool inside;
    int edge;
  };
  [[nodiscard]] Location locate(const SumPoint& x) const;
  /// In the closed polygon.
  [[nodiscard]] bool contains(const SumPoint& x) const;

  /// Beyond the sum itself.
  [[nodiscard]] std::size_t memory_bytes() const { return place_.capacity() * sizeof(InsertedEdge); }

  /// The part of a span that lies inside.
  struct Cover {
    enum class Kind { inside, same_edge, opposite_edge } kind;
    Place from, to;
    int edge;  ///< the first edge on the span's line, for the last two kinds
  };
  /// Empty where the part has no length. A span along an edge counts as such, of positive length only.
  [[nodiscard]] std::optional<Cover> cover(const Span& e) const;
  /// The same of the whole line.
  [[nodiscard]] std::optional<Cover> cover_of_line(const Span& e) const;

 private:
  /// The place of an edge of T among those of -B.
  struct InsertedEdge {
    std::int32_t edge;   ///< its number in the sum
    std::int32_t fused;  ///< how many edges of T before it are parallel to an edge of -B
    bool parallel;       ///< fused with an edge of -B
  };
  [[nodiscard]] int fused_before(std::size_t a) const {
    if (a < place_.size()) return place_[a].fused;
    return place_.back().fused + (place_.back().parallel ? 1 : 0);
  }

  const ConvexPart* part_;
  const NegatedChain* chain_;
  std::vector<InsertedEdge> place_;
  std::int32_t size_;
};

}  // namespace pd::detail

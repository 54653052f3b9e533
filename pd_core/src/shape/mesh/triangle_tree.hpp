/// @file
/// The hierarchy of boxes over the triangles of a mesh, split at the median of the longest axis.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "pd/numeric/vector.hpp"
#include "pd/shape/triangle_node.hpp"

namespace pd::detail {

/// Axis-parallel and closed.
struct TriangleBox {
  Vec3 low, high;
  [[nodiscard]] bool meets(const TriangleBox& other) const {
    return (low.array() <= other.high.array()).all() && (other.low.array() <= high.array()).all();
  }
};

[[nodiscard]] inline TriangleBox box_of(std::span<const Vec3> points, const std::array<std::int32_t, 3>& triangle) {
  const auto point = [&](std::size_t k) -> const Vec3& { return points[static_cast<std::size_t>(triangle[k])]; };
  return {point(0).cwiseMin(point(1)).cwiseMin(point(2)), point(0).cwiseMax(point(1)).cwiseMax(point(2))};
}

/// Leaves hold up to kLeaf triangles. Equal boxes are ordered by their index, so that a tree is the same on every run.
class TriangleTree {
 public:
  static constexpr std::int32_t kLeaf = 4;
  using Node = TriangleNode;

  TriangleTree() = default;
  explicit TriangleTree(std::span<const TriangleBox> boxes);

  /// The root is first; empty without triangles.
  [[nodiscard]] const std::vector<Node>& nodes() const { return nodes_; }
  /// Triangles in the order of the leaves.
  [[nodiscard]] const std::vector<std::int32_t>& order() const { return order_; }
  [[nodiscard]] std::vector<Node> take_nodes() && { return std::move(nodes_); }

 private:
  struct Item {
    TriangleBox box;
    std::int32_t triangle;
  };
  std::int32_t build(std::span<Item> items, std::int32_t first, std::int32_t last);

  std::vector<std::int32_t> order_;
  std::vector<Node> nodes_;
};

}  // namespace pd::detail

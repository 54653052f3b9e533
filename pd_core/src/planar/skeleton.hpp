/// @file
/// Chew's randomised construction of the medial axis of a convex polygon given by its edges' lines in order.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "numeric/double_double.hpp"

namespace pd::detail {

/// Distance from the line: <normal, x> + offset, positive inside; |normal| = 1.
struct EdgeLine {
  DoubleDouble x, y, offset;
};

class Skeleton {
 public:
  struct Node {
    DoubleDouble x, y, radius;
    std::array<std::int32_t, 3> faces;  ///< edges, in an order that runs counter-clockwise
    std::array<std::int32_t, 3> links;  ///< beyond the bisector of the other two; -1: a corner
  };

  /// @param start  three or four edges, ascending, that bound a region alone.
  Skeleton(std::vector<EdgeLine> lines, const std::vector<std::int32_t>& start);

  [[nodiscard]] const std::vector<Node>& nodes() const { return nodes_; }
  /// The node at the corner between an edge and the next.
  [[nodiscard]] int corner_node(int edge) const { return corner_[static_cast<std::size_t>(edge)]; }
  [[nodiscard]] std::int64_t work() const { return work_; }

 private:
  void begin(const std::vector<std::int32_t>& start);
  void insert(int edge);
  [[nodiscard]] Node centre(int a, int b, int c) const;
  [[nodiscard]] bool hides(int edge, const Node& node) const;
  int add(const Node& node);
  void compact();

  std::vector<EdgeLine> lines_;
  std::vector<std::int32_t> previous_, next_;  ///< among the edges that are there
  std::vector<std::int32_t> corner_;
  std::vector<Node> nodes_;
  std::vector<std::int32_t> free_;
  std::vector<char> dropped_;
  std::int64_t work_ = 0;
};

}  // namespace pd::detail

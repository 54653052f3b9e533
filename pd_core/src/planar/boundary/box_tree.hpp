/// @file
/// A binary tree of boxes, to pass over what is certainly elsewhere. Boxes are rounded outwards by who makes them.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <vector>

#include "pd/planar/polygon.hpp"

namespace pd::detail {

struct Box2 {
  Point2 low = {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  Point2 high = {-std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};

  void add(const Point2& p) {
    for (std::size_t k = 0; k < 2; ++k) {
      low[k] = std::min(low[k], p[k]);
      high[k] = std::max(high[k], p[k]);
    }
  }
  void add(const Box2& b) {
    add(b.low);
    add(b.high);
  }
  /// Grown by more than a few roundings of its coordinates.
  [[nodiscard]] Box2 widened() const {
    Box2 r = *this;
    for (std::size_t k = 0; k < 2; ++k) {
      const double air = 0x1p-48 * std::max(std::abs(low[k]), std::abs(high[k]));
      r.low[k] -= air;
      r.high[k] += air;
    }
    return r;
  }
  [[nodiscard]] bool meets(const Box2& b) const {
    return low[0] <= b.high[0] && b.low[0] <= high[0] && low[1] <= b.high[1] && b.low[1] <= high[1];
  }
  /// A number not above the squared distance of p, but for rounding.
  [[nodiscard]] double distance_squared(const Point2& p) const {
    double sum = 0;
    for (std::size_t k = 0; k < 2; ++k) {
      const double gap = std::max({low[k] - p[k], p[k] - high[k], 0.0});
      sum += gap * gap;
    }
    return sum;
  }
  /// From the box's middle to p, rounded.
  [[nodiscard]] double middle_distance_squared(const Point2& p) const {
    double sum = 0;
    for (std::size_t k = 0; k < 2; ++k) {
      const double gap = 0.5 * low[k] + 0.5 * high[k] - p[k];
      sum += gap * gap;
    }
    return sum;
  }
};

class BoxTree {
 public:
  BoxTree() = default;
  explicit BoxTree(std::vector<Box2> boxes) : item_(boxes.size()) {
    std::iota(item_.begin(), item_.end(), 0);
    if (!boxes.empty()) build(boxes, 0, static_cast<int>(boxes.size()));
  }

  /// Calls item(i) for what lies below nodes with enter(box); the child that first(box) puts lower goes first.
  template <class Enter, class First, class Item>
  void visit(const Enter& enter, const First& first, const Item& item) const {
    if (!node_.empty()) visit_node(0, enter, first, item);
  }
  template <class Enter, class Item>
  void visit(const Enter& enter, const Item& item) const {
    visit(
        enter, [](const Box2&) { return 0.0; }, item);
  }
  [[nodiscard]] std::size_t memory_bytes() const {
    return node_.capacity() * sizeof(Node) + item_.capacity() * sizeof(std::int32_t);
  }

 private:
  static constexpr int kLeafSize = 4;
  struct Node {
    Box2 box;
    std::int32_t begin, end;  ///< of its items
    std::int32_t right;       ///< second child; the first one is the next node; -1: a leaf
  };

  int build(const std::vector<Box2>& boxes, int begin, int end) {
    const auto index = static_cast<int>(node_.size());
    Box2 box, middles;
    const auto middle = [&](std::int32_t i, std::size_t k) {
      return 0.5 * boxes[static_cast<std::size_t>(i)].low[k] + 0.5 * boxes[static_cast<std::size_t>(i)].high[k];
    };
    for (int i = begin; i < end; ++i) {
      const std::int32_t id = item_[static_cast<std::size_t>(i)];
      box.add(boxes[static_cast<std::size_t>(id)]);
      middles.add(Point2{middle(id, 0), middle(id, 1)});
    }
    node_.push_back({box, begin, end, -1});
    if (end - begin <= kLeafSize) return index;
    const std::size_t axis = middles.high[0] - middles.low[0] >= middles.high[1] - middles.low[1] ? 0 : 1;
    const int half = begin + (end - begin) / 2;
    std::nth_element(item_.begin() + begin, item_.begin() + half, item_.begin() + end,
                     [&](std::int32_t a, std::int32_t b) {
                       const double ma = middle(a, axis), mb = middle(b, axis);
                       return ma != mb ? ma < mb : a < b;
                     });
    build(boxes, begin, half);
    const int right = build(boxes, half, end);
    node_[static_cast<std::size_t>(index)].right = right;
    return index;
  }

  template <class Enter, class First, class Item>
  void visit_node(int index, const Enter& enter, const First& first, const Item& item) const {
    const Node& node = node_[static_cast<std::size_t>(index)];
    if (!enter(node.box)) return;
    if (node.right < 0) {
      for (int i = node.begin; i < node.end; ++i) item(item_[static_cast<std::size_t>(i)]);
      return;
    }
    const bool swapped =
        first(node_[static_cast<std::size_t>(node.right)].box) < first(node_[static_cast<std::size_t>(index) + 1].box);
    visit_node(swapped ? node.right : index + 1, enter, first, item);
    visit_node(swapped ? index + 1 : node.right, enter, first, item);
  }

  std::vector<Node> node_;
  std::vector<std::int32_t> item_;
};

}  // namespace pd::detail

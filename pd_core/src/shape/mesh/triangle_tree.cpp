#include "shape/mesh/triangle_tree.hpp"

#include <numeric>

namespace pd::detail {

TriangleTree::TriangleTree(std::span<const TriangleBox> boxes) : order_(boxes.size()) {
  std::iota(order_.begin(), order_.end(), 0);
  nodes_.reserve(boxes.size());
  if (!order_.empty()) build(boxes, 0, static_cast<std::int32_t>(order_.size()));
  nodes_.shrink_to_fit();
}

std::int32_t TriangleTree::build(std::span<const TriangleBox> boxes, std::int32_t first, std::int32_t last) {
  const auto box_at = [&](std::int32_t place) -> const TriangleBox& {
    return boxes[static_cast<std::size_t>(order_[static_cast<std::size_t>(place)])];
  };
  TriangleBox box = box_at(first);
  for (std::int32_t i = first + 1; i < last; ++i) {
    box = {box.low.cwiseMin(box_at(i).low), box.high.cwiseMax(box_at(i).high)};
  }
  const auto at = static_cast<std::int32_t>(nodes_.size());
  nodes_.push_back({box.low, box.high, first, last, 0, 0});
  if (last - first <= kLeaf) return at;
  int axis = 0;
  (box.high - box.low).maxCoeff(&axis);
  const std::int32_t middle = first + (last - first) / 2;
  const auto place = [&](std::int32_t triangle) {
    const TriangleBox& b = boxes[static_cast<std::size_t>(triangle)];
    return 0.5 * b.low[axis] + 0.5 * b.high[axis];
  };
  std::nth_element(order_.begin() + first, order_.begin() + middle, order_.begin() + last,
                   [&](std::int32_t i, std::int32_t j) {
                     const double x = place(i), y = place(j);
                     return x < y || (x == y && i < j);
                   });
  const std::int32_t left = build(boxes, first, middle), right = build(boxes, middle, last);
  nodes_[static_cast<std::size_t>(at)].left = left;
  nodes_[static_cast<std::size_t>(at)].right = right;
  return at;
}

}  // namespace pd::detail

#include "shape/mesh/triangle_tree.hpp"

namespace pd::detail {

TriangleTree::TriangleTree(std::span<const TriangleBox> boxes) {
  // Boxes are moved along with their triangles, so that they are read one after the other.
  std::vector<Item> items;
  items.reserve(boxes.size());
  for (const TriangleBox& box : boxes) items.push_back({box, static_cast<std::int32_t>(items.size())});
  nodes_.reserve(boxes.size());
  if (!items.empty()) build(items, 0, static_cast<std::int32_t>(items.size()));
  nodes_.shrink_to_fit();
  order_.reserve(items.size());
  for (const Item& item : items) order_.push_back(item.triangle);
}

std::int32_t TriangleTree::build(std::span<Item> items, std::int32_t first, std::int32_t last) {
  const auto here = items.subspan(static_cast<std::size_t>(first), static_cast<std::size_t>(last - first));
  TriangleBox box = here.front().box;
  for (const Item& item : here) box = {box.low.cwiseMin(item.box.low), box.high.cwiseMax(item.box.high)};
  const auto at = static_cast<std::int32_t>(nodes_.size());
  nodes_.push_back({box.low, box.high, first, last, 0, 0});
  if (last - first <= kLeaf) return at;
  int axis = 0;
  (box.high - box.low).maxCoeff(&axis);
  const std::int32_t middle = first + (last - first) / 2;
  const auto place = [&](const Item& item) { return 0.5 * item.box.low[axis] + 0.5 * item.box.high[axis]; };
  std::nth_element(here.begin(), here.begin() + (middle - first), here.end(), [&](const Item& i, const Item& j) {
    const double x = place(i), y = place(j);
    return x < y || (x == y && i.triangle < j.triangle);
  });
  const std::int32_t left = build(items, first, middle), right = build(items, middle, last);
  nodes_[static_cast<std::size_t>(at)].left = left;
  nodes_[static_cast<std::size_t>(at)].right = right;
  return at;
}

}  // namespace pd::detail

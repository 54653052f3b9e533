#include "planar/boundary/turned_boxes.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "numeric/at.hpp"
#include "numeric/length.hpp"

namespace pd::detail {

namespace {

Point2 middle_of(const TurnedBoxes::Item& item) {
  Box2 box;
  for (const Point2& x : item.corner) box.add(x);
  return {0.5 * box.low[0] + 0.5 * box.high[0], 0.5 * box.low[1] + 0.5 * box.high[1]};
}

}  // namespace

TurnedBoxes::TurnedBoxes(const std::vector<Item>& items) : order_(items.size()) {
  std::iota(order_.begin(), order_.end(), 0);
  if (items.empty()) return;
  node_.emplace_back();
  build(items, 0, static_cast<int>(items.size()), 0);
}

TurnedBoxes::Node TurnedBoxes::box_along(const std::vector<Item>& items, int begin, int end, const Point2& axis) const {
  Box2 box;
  double size = 0;
  for (int i = begin; i < end; ++i) {
    const Item& item = items[at(order_[at(i)])];
    size = std::max(size, item.size);
    for (const Point2& x : item.corner) {
      box.add(Point2{axis[0] * x[0] + axis[1] * x[1], axis[0] * x[1] - axis[1] * x[0]});
    }
  }
  // The corners within 2^-50 of the size, the turn within 2^-51 of it twice.
  const double air = 0x1p-47 * size;
  for (std::size_t k = 0; k < 2; ++k) {
    box.low[k] -= air;
    box.high[k] += air;
  }
  return {axis, {box.low, box.high}, begin, end, -1};
}

/// The smaller of the upright box and the one along the longest item.
TurnedBoxes::Node TurnedBoxes::smaller_box(const std::vector<Item>& items, int begin, int end) const {
  const Node upright = box_along(items, begin, end, {1, 0});
  Point2 longest = {0, 0};
  double length = 0;
  for (int i = begin; i < end; ++i) {
    const Item& item = items[at(order_[at(i)])];
    const Point2 along = {item.corner[3][0] - item.corner[0][0], item.corner[3][1] - item.corner[0][1]};
    const double l = pd::detail::length(along[0], along[1]);
    if (l > length) {
      length = l;
      longest = {along[0] / l, along[1] / l};
    }
  }
  if (!(length > 0) || !std::isfinite(length) || longest[0] == 1) return upright;
  const Node turned = box_along(items, begin, end, longest);
  // An upright box is cheaper to look into.
  return area(turned) < 0.7 * area(upright) ? turned : upright;
}

/// Halves a range by the middles of its items along a direction. @return the area of the two boxes.
double TurnedBoxes::halve(const std::vector<Item>& items, int begin, int end, const Point2& direction) {
  const int half = begin + (end - begin) / 2;
  const auto place = [&](std::int32_t i) {
    const Point2 m = middle_of(items[at(i)]);
    return direction[0] * m[0] + direction[1] * m[1];
  };
  std::nth_element(order_.begin() + begin, order_.begin() + half, order_.begin() + end,
                   [&](std::int32_t a, std::int32_t b) {
                     const double pa = place(a), pb = place(b);
                     return pa != pb ? pa < pb : a < b;
                   });
  return area(smaller_box(items, begin, half)) + area(smaller_box(items, half, end));
}

/// Halved along the box or across it, as the halves are smaller: beams side by side are parted from each other however
/// much their lengths differ.
void TurnedBoxes::build(const std::vector<Item>& items, int begin, int end, std::size_t index) {
  const Node node = smaller_box(items, begin, end);
  node_[index] = node;
  if (end - begin <= kLeafSize) return;
  const Point2 across = {-node.axis[1], node.axis[0]};
  const double along_area = halve(items, begin, end, node.axis), across_area = halve(items, begin, end, across);
  const bool wide = width(node, 0) >= width(node, 1);
  if (along_area < across_area || (along_area == across_area && wide)) halve(items, begin, end, node.axis);
  const int half = begin + (end - begin) / 2;
  const std::size_t child = node_.size();
  node_[index].child = static_cast<std::int32_t>(child);
  node_.resize(child + 2);
  build(items, begin, half, child);
  build(items, half, end, child + 1);
}

}  // namespace pd::detail

/// @file
/// A binary tree of boxes, each turned along the longest thing in it where that makes it smaller, for rays.
///
/// Long edges side by side, as a star has them, have upright boxes that all overlap; turned ones do not. Boxes are kept
/// in doubles and widened by more than all roundings, so that nothing that a ray meets is passed over.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "planar/box_tree.hpp"

namespace pd::detail {

/// A ray from y along d with what bounds its roundings. d != 0.
struct RoundedRay {
  Point2 y, d;
  Point2 inverse;       ///< 1 / d
  double reach;         ///< |y|_1
  double speed;         ///< |d|_1
  double slow;          ///< 2^-12 of that
  double per_square;    ///< 1 / (d . d) but for rounding; not a number where that might be lost below or above doubles
  double air;           ///< more than the roundings of y and of differences with it
  Point2 above, below;  ///< y moved by it up and down
  RoundedRay(const Point2& from, const Point2& along)
      : y(from),
        d(along),
        inverse{1 / d[0], 1 / d[1]},
        reach(std::abs(y[0]) + std::abs(y[1])),
        speed(std::abs(d[0]) + std::abs(d[1])),
        slow(0x1p-12 * speed),
        per_square(speed > 0x1p-400 && speed < 0x1p400 ? 1 / (d[0] * d[0] + d[1] * d[1])
                                                       : std::numeric_limits<double>::quiet_NaN()),
        air(0x1p-48 * reach),
        above{y[0] + air, y[1] + air},
        below{y[0] - air, y[1] - air} {}
};

class TurnedBoxes {
 public:
  /// What lies in the convex hull of four points, given within `size` * 2^-50.
  struct Item {
    std::array<Point2, 4> corner;
    double size;
  };

  TurnedBoxes() = default;
  explicit TurnedBoxes(const std::vector<Item>& items);

  /// Calls item(i) for what the ray may meet at parameters in [0, limit], nearest boxes first; `limit` may fall.
  /// @return boxes looked into.
  template <class Visit>
  std::int64_t visit(const RoundedRay& ray, const double& limit, const Visit& item) const {
    if (node_.empty()) return 0;
    std::int64_t boxes = 1;
    struct Waiting {
      std::int32_t node;
      double entry;
    };
    // Nearest last. Boxes overlap, and to go down into one before a nearer one that waits cost rays that leave at once
    // hundreds of boxes. When many wait, the tree's own order is kept, which needs one place a level: below 32.
    constexpr std::size_t kSorted = 64;
    std::array<Waiting, kSorted + 32> stack;
    std::size_t top = 0;
    const auto push = [&](const Waiting& w) {
      if (!(w.entry < kNever)) return;
      std::size_t at = top++;
      for (; at > 0 && at < kSorted && stack[at - 1].entry < w.entry; --at) stack[at] = stack[at - 1];
      stack[at] = w;
    };
    push({0, entry(node_[0], ray, limit)});
    while (top > 0) {
      const Waiting w = stack[--top];
      if (!(w.entry <= limit)) continue;
      const Node& node = node_[static_cast<std::size_t>(w.node)];
      if (node.right < 0) {
        for (std::int32_t i = node.begin; i < node.end; ++i) item(item_[static_cast<std::size_t>(i)]);
        continue;
      }
      push({node.right, entry(node_[static_cast<std::size_t>(node.right)], ray, limit)});
      push({w.node + 1, entry(node_[static_cast<std::size_t>(w.node) + 1], ray, limit)});
      boxes += 2;
    }
    return boxes;
  }
  [[nodiscard]] std::size_t memory_bytes() const {
    return node_.capacity() * sizeof(Node) + item_.capacity() * sizeof(std::int32_t);
  }

 private:
  static constexpr int kLeafSize = 4;
  struct Node {
    Point2 axis;       ///< of length 1 within 2^-50; {1, 0}: upright
    Point2 low, high;  ///< along the axis, and along its left normal
    std::int32_t begin, end;
    std::int32_t right;  ///< second child; the first one is the next node; -1: a leaf
  };

  static constexpr double kNever = std::numeric_limits<double>::infinity();

  /// A number not above the first parameter in [0, limit] at which the ray may be in the box, or infinity.
  [[nodiscard]] static double entry(const Node& node, const RoundedRay& ray, double limit) {
    double low = 0, high = limit;
    if (node.axis[0] == 1) {
      for (std::size_t k = 0; k < 2; ++k) {
        const double before = node.low[k] - ray.above[k], behind = node.high[k] - ray.below[k];
        if (ray.d[k] != 0) {
          clip(before * ray.inverse[k], behind * ray.inverse[k], low, high);
        } else if (before > 0 || behind < 0) {
          return kNever;
        }
      }
    } else {
      const Point2 &u = node.axis, &y = ray.y, &d = ray.d;
      // Across the axis first: boxes are thin there, and most that are missed are missed so.
      for (const std::size_t k : {std::size_t{1}, std::size_t{0}}) {
        const double from = k == 0 ? u[0] * y[0] + u[1] * y[1] : u[0] * y[1] - u[1] * y[0];
        const double speed = k == 0 ? u[0] * d[0] + u[1] * d[1] : u[0] * d[1] - u[1] * d[0];
        // The speed is within 2^-50 of |d|: below 2^-12 of it nothing is concluded.
        if (std::abs(speed) <= ray.slow) continue;
        const double inverse = 1 / speed;
        clip((node.low[k] - from - ray.air) * inverse, (node.high[k] - from + ray.air) * inverse, low, high);
        if (low > high * (1 + 0x1p-35)) return kNever;
      }
    }
    // Parameters are within 2^-37 of themselves. A `high` below 0 stays there, and the box lies behind.
    low *= 1 - 0x1p-36;
    return low <= high * (1 + 0x1p-36) ? low : kNever;
  }
  /// Cuts [low, high] to the parameters between a and b (or not at all by what is not a number).
  static void clip(double a, double b, double& low, double& high) {
    low = std::max(low, std::min(a, b));
    high = std::min(high, std::max(a, b));
  }

  [[nodiscard]] static double area(const Node& n) { return (n.high[0] - n.low[0]) * (n.high[1] - n.low[1]); }
  [[nodiscard]] Node smaller_box(const std::vector<Item>& items, int begin, int end) const;
  double halve(const std::vector<Item>& items, int begin, int end, const Point2& direction);
  std::int32_t build(const std::vector<Item>& items, int begin, int end);
  [[nodiscard]] Node box_along(const std::vector<Item>& items, int begin, int end, const Point2& axis) const;

  std::vector<Node> node_;
  std::vector<std::int32_t> item_;
};

}  // namespace pd::detail

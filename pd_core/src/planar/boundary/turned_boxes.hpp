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
#include <utility>
#include <vector>

#include "planar/boundary/box_tree.hpp"

namespace pd::detail {

/// A ray from y along d with what bounds its roundings. d != 0.
struct RoundedRay {
  Point2 y, d;
  Point2 inverse;                   ///< 1 / d, infinity for 0
  std::array<std::size_t, 2> near;  ///< the side of upright boxes that the ray meets first: 0 the low one, 1 the high
  double reach;                     ///< |y|_1
  double speed;                     ///< |d|_1
  double slow;                      ///< 2^-12 of that
  double per_square;  ///< 1 / (d . d) but for rounding; not a number where that might be lost below or above doubles
  double air;         ///< more than the roundings of y and of differences with it
  Point2 to_near, to_far;  ///< y moved by it so that near sides come nearer, far ones farther
  RoundedRay(const Point2& from, const Point2& along)
      : y(from),
        d(along),
        inverse{1 / (d[0] + 0.0), 1 / (d[1] + 0.0)},
        near{d[0] < 0 ? std::size_t{1} : 0, d[1] < 0 ? std::size_t{1} : 0},
        reach(std::abs(y[0]) + std::abs(y[1])),
        speed(std::abs(d[0]) + std::abs(d[1])),
        slow(0x1p-12 * speed),
        per_square(speed > 0x1p-400 && speed < 0x1p400 ? 1 / (d[0] * d[0] + d[1] * d[1])
                                                       : std::numeric_limits<double>::quiet_NaN()),
        air(0x1p-48 * reach),
        to_near{y[0] + std::copysign(air, d[0] + 0.0), y[1] + std::copysign(air, d[1] + 0.0)},
        to_far{y[0] - std::copysign(air, d[0] + 0.0), y[1] - std::copysign(air, d[1] + 0.0)} {}
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
    return visit_places(ray, limit, [&](std::size_t place) { item(order_[place]); });
  }
  /// The same by places in order(): items of one box stand side by side there.
  template <class Visit>
  std::int64_t visit_places(const RoundedRay& ray, const double& limit, const Visit& visit_place) const {
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
      std::size_t at = top++;
      for (; at > 0 && at < kSorted && stack[at - 1].entry < w.entry; --at) stack[at] = stack[at - 1];
      stack[at] = w;
    };
    if (const Waiting root{0, entry(node_[0], ray, limit)}; root.entry < kNever) push(root);
    while (top > 0) {
      Waiting w = stack[--top];
      if (!(w.entry <= limit)) continue;
      // Down into the nearer one of two boxes, as long as none that waits is nearer.
      while (true) {
        const Node& node = node_[static_cast<std::size_t>(w.node)];
        if (node.child < 0) {
          for (std::int32_t i = node.begin; i < node.end; ++i) visit_place(static_cast<std::size_t>(i));
          break;
        }
        const auto child = static_cast<std::size_t>(node.child);
        Waiting near{node.child, entry(node_[child], ray, limit)};
        Waiting far{node.child + 1, entry(node_[child + 1], ray, limit)};
        boxes += 2;
        if (far.entry < near.entry) std::swap(near, far);
        if (far.entry < kNever) push(far);
        if (!(near.entry < kNever)) break;
        if (top > 0 && stack[top - 1].entry < near.entry) {
          push(near);
          break;
        }
        w = near;
      }
    }
    return boxes;
  }
  /// The items as they lie in the tree.
  [[nodiscard]] const std::vector<std::int32_t>& order() const { return order_; }
  [[nodiscard]] std::size_t memory_bytes() const {
    return node_.capacity() * sizeof(Node) + order_.capacity() * sizeof(std::int32_t);
  }

 private:
  static constexpr int kLeafSize = 4;
  /// One cache line; both boxes of a parent stand side by side.
  struct alignas(64) Node {
    Point2 axis;                 ///< of length 1 within 2^-50; {1, 0}: upright
    std::array<Point2, 2> side;  ///< low and high, along the axis and along its left normal
    std::int32_t begin, end;     ///< of its items
    std::int32_t child;          ///< first of two; -1: a leaf
  };

  static constexpr double kNever = std::numeric_limits<double>::infinity();

  /// A number not above the first parameter in [0, limit] at which the ray may be in the box, or infinity.
  [[nodiscard]] static double entry(const Node& node, const RoundedRay& ray, double limit) {
    double low = 0, high = limit;
    if (node.axis[0] == 1) {
      // Along a coordinate that stands still the quotients are infinite, or not numbers and without effect.
      for (std::size_t k = 0; k < 2; ++k) {
        const double enter = (node.side[ray.near[k]][k] - ray.to_near[k]) * ray.inverse[k];
        const double leave = (node.side[1 - ray.near[k]][k] - ray.to_far[k]) * ray.inverse[k];
        low = enter > low ? enter : low;
        high = leave < high ? leave : high;
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
        clip((node.side[0][k] - from - ray.air) * inverse, (node.side[1][k] - from + ray.air) * inverse, low, high);
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

  [[nodiscard]] static double width(const Node& n, std::size_t k) { return n.side[1][k] - n.side[0][k]; }
  [[nodiscard]] static double area(const Node& n) { return width(n, 0) * width(n, 1); }
  [[nodiscard]] Node smaller_box(const std::vector<Item>& items, int begin, int end) const;
  double halve(const std::vector<Item>& items, int begin, int end, const Point2& direction);
  void build(const std::vector<Item>& items, int begin, int end, std::size_t index);
  [[nodiscard]] Node box_along(const std::vector<Item>& items, int begin, int end, const Point2& axis) const;

  std::vector<Node> node_;
  std::vector<std::int32_t> order_;
};

}  // namespace pd::detail

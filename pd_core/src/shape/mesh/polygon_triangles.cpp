#include "shape/mesh/polygon_triangles.hpp"

#include <algorithm>

#include "pd/numeric/predicates.hpp"

namespace pd::detail {

namespace {

constexpr std::size_t kMostCorners = 2000;

/// A loop as its shadow on a coordinate plane, seen from the side to which the normal points.
class EarCutter {
 public:
  EarCutter(std::span<const Vec3> points, std::span<const std::int32_t> loop, const Vec3& normal)
      : points_(points), left_(loop.begin(), loop.end()) {
    normal.cwiseAbs().maxCoeff(&axis_);
    mirrored_ = normal[axis_] < 0;
  }

  /// Every corner turns left; a corner in the middle of an edge asks for ears, since a fan leaves it out.
  [[nodiscard]] bool is_convex() const {
    for (std::size_t k = 0; k < left_.size(); ++k) {
      if (turn(at(k), at(k + 1), at(k + 2)) <= 0) return false;
    }
    return true;
  }

  bool cut(std::vector<std::array<std::int32_t, 3>>& triangles) {
    while (left_.size() > 3) {
      // Ears with an area first: what lies on a line shares no edge with its neighbours.
      std::size_t ear = 0;
      while (ear < left_.size() && !is_ear(ear, 1)) ++ear;
      if (ear == left_.size()) ear = 0;
      while (ear < left_.size() && !is_ear(ear, 1) && !is_ear(ear, 0)) ++ear;
      if (ear == left_.size()) return false;
      append(at(ear + left_.size() - 1), at(ear), at(ear + 1), triangles);
      left_.erase(left_.begin() + static_cast<std::ptrdiff_t>(ear));
    }
    append(left_[0], left_[1], left_[2], triangles);
    return true;
  }

 private:
  [[nodiscard]] std::int32_t at(std::size_t k) const { return left_[k % left_.size()]; }
  [[nodiscard]] std::array<double, 2> shadow(std::int32_t v) const {
    const Vec3& p = points_[static_cast<std::size_t>(v)];
    return {p[(axis_ + 1) % 3], p[(axis_ + 2) % 3]};
  }
  [[nodiscard]] int turn(std::int32_t a, std::int32_t b, std::int32_t c) const {
    const int side = orient2d(shadow(a), shadow(b), shadow(c));
    return mirrored_ ? -side : side;
  }
  /// A corner is an ear when it turns left (1), or not at all (0), and no other corner lies in its triangle.
  [[nodiscard]] bool is_ear(std::size_t k, int wanted) const {
    const std::int32_t a = at(k + left_.size() - 1), b = at(k), c = at(k + 1);
    const int here = turn(a, b, c);
    if (here != wanted) return false;
    if (here == 0) return true;
    return std::none_of(left_.begin(), left_.end(), [&](std::int32_t v) {
      return v != a && v != b && v != c && turn(a, b, v) >= 0 && turn(b, c, v) >= 0 && turn(c, a, v) >= 0;
    });
  }
  void append(std::int32_t a, std::int32_t b, std::int32_t c, std::vector<std::array<std::int32_t, 3>>& triangles) {
    const auto point = [&](std::int32_t v) { return points_[static_cast<std::size_t>(v)]; };
    if (!collinear(point(a), point(b), point(c))) triangles.push_back({a, b, c});
  }

  std::span<const Vec3> points_;
  std::vector<std::int32_t> left_;
  int axis_ = 0;
  bool mirrored_ = false;
};

}  // namespace

bool append_triangles(std::span<const Vec3> points, std::span<const std::int32_t> loop, const Vec3& normal,
                      std::vector<std::array<std::int32_t, 3>>& triangles) {
  const auto point = [&](std::size_t k) { return points[static_cast<std::size_t>(loop[k])]; };
  EarCutter cutter(points, loop, normal);
  if (loop.size() == 3 || cutter.is_convex()) {
    for (std::size_t k = 1; k + 1 < loop.size(); ++k) {
      if (!collinear(point(0), point(k), point(k + 1))) triangles.push_back({loop[0], loop[k], loop[k + 1]});
    }
    return true;
  }
  const std::size_t before = triangles.size();
  if (loop.size() <= kMostCorners && cutter.cut(triangles)) return true;
  triangles.resize(before);
  return false;
}

}  // namespace pd::detail

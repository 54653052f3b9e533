#include "contact/manifold_reduce.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace pd::detail {

namespace {

/// Ties among equally deep points are broken along (1, kTieSlope). The slope is that of the golden ratio, the number
/// farthest from all fractions: corners of boxes and of regular faces lie on lines of small rational slope, so that no
/// two of them tie.
constexpr double kTieSlope = 0.618;

}  // namespace

std::size_t deepest_point(const std::vector<ContactPoint>& points, const std::vector<Vec2>& flat, double deepest,
                          double noise) {
  std::size_t chosen = 0;
  double best = -HUGE_VAL;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double along = flat[i].x() + kTieSlope * flat[i].y();
    if (points[i].depth >= deepest - noise && along > best) {
      best = along;
      chosen = i;
    }
  }
  return chosen;
}

void reduce_to_four(std::vector<ContactPoint>& points, std::vector<Vec2>& flat, std::size_t first) {
  const auto move_to = [&](std::size_t slot, std::size_t from) {
    std::swap(points[slot], points[from]);
    std::swap(flat[slot], flat[from]);
  };
  const auto best_after = [&](std::size_t slot, auto&& value) {
    std::size_t best = slot;
    double best_value = value(flat[slot]);
    for (std::size_t i = slot + 1; i < flat.size(); ++i) {
      const double candidate = value(flat[i]);
      if (candidate > best_value) {
        best_value = candidate;
        best = i;
      }
    }
    move_to(slot, best);
  };
  move_to(0, first);
  best_after(1, [&](const Vec2& p) { return (p - flat[0]).squaredNorm(); });
  const Vec2 base = flat[1] - flat[0];
  best_after(2, [&](const Vec2& p) { return std::abs(cross(base, p - flat[0])); });
  // What a fourth point adds to the triangle: its distance beyond the edge visible from it, times that edge.
  const double turn = cross(base, flat[2] - flat[0]) < 0 ? -1 : 1;
  const auto beyond = [&](const Vec2& from, const Vec2& to, const Vec2& p) {
    return -turn * cross(to - from, p - from);
  };
  const std::array<Vec2, 3> triangle{flat[0], flat[1], flat[2]};
  best_after(3, [&](const Vec2& p) {
    return std::max({beyond(triangle[0], triangle[1], p), beyond(triangle[1], triangle[2], p),
                     beyond(triangle[2], triangle[0], p)});
  });
  points.resize(4);
  flat.resize(4);
}

}  // namespace pd::detail

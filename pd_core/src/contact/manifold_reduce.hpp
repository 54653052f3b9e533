/// @file
/// Four of many contact points: as many as a solver takes, spread as far as they go.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>

#include "contact/manifold_clip.hpp"

namespace pd::detail {

/// Two corners closer than this times the size of the intersection are one: a ten-thousandth of a percent of a face is
/// below what a solver can feel, and far above the rounding of a cut.
inline constexpr double kMergeRatio = 1e-6;
/// Of the breaking threshold: depths of a resting contact differ by so much from frame to frame.
inline constexpr double kNoiseRatio = 1e-3;

/// Of the points as deep as the deepest within `noise`, one that stays the same from frame to frame.
/// @param points  anything with a `depth`.
/// @param flat    the points across the normal.
template <class Point>
[[nodiscard]] std::size_t deepest_point(std::span<const Point> points, std::span<const Vec2> flat, double deepest,
                                        double noise) {
  // Ties among equally deep points are broken along (1, kTieSlope). The slope is that of the golden ratio, the number
  // farthest from all fractions: corners of boxes and of regular faces lie on lines of small rational slope, so that no
  // two of them tie.
  constexpr double kTieSlope = 0.618;
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

/// Puts four of the points (at least four there) in front of the others: `first`, the farthest from it, and the two
/// that span most area to either side.
template <class Point>
void reduce_to_four(std::span<Point> points, std::span<Vec2> flat, std::size_t first) {
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
}

}  // namespace pd::detail

/// @file
/// Khachiyan's weights of a small set of points, in a frame in which the set is about a unit box.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pd/dimension/sandwich.hpp"

namespace pd::dimension::detail {

/// An orthogonal frame with a scale an axis: the points of a set have coordinates in [-1, 1] there, and every axis
/// holds one at distance 1 from the span of those before. `rank` < D when the set is flat within rounding.
template <int D>
struct SpanningFrame {
  AffineMap<D> to_frame;
  int rank = 0;
  double largest_scale = 0;
  double smallest_scale = 0;
};

/// Farthest point first, then farthest from the line, and so on.
template <int D>
SpanningFrame<D> spanning_frame(std::span<const Vector<D>> points);

/// The sandwich of the hull of a small full-dimensional set: ratio <= D (1 + eta) by the ascent of [TY] with away
/// steps. Adds to `steps`. False when the set is flat within rounding.
template <int D>
bool core_ellipsoid(std::span<const Vector<D>> points, double eta, Sandwich<D>& sandwich, std::int64_t& steps);

/// A core set of a stream of points, from which every point is within a constant multiple of the core's ellipsoid.
/// Points join, and never leave, so that nothing is lost by one change after another.
template <int D>
class CoreSet {
 public:
  void add(std::span<const Vector<D>> chunk);

  [[nodiscard]] bool full_dimensional() const { return full_; }
  [[nodiscard]] const std::vector<Vector<D>>& points() const { return core_; }
  /// Inner ellipsoid certified (it lies in the hull of the core); `ratio` of the core, not of the stream.
  [[nodiscard]] const Sandwich<D>& sandwich() const { return sandwich_; }
  [[nodiscard]] std::int64_t steps() const { return steps_; }

 private:
  void extend_span(const Vector<D>& p);
  void join(const Vector<D>& p);

  std::vector<Vector<D>> core_;
  Sandwich<D> sandwich_;
  AffineMap<D> to_unit_;
  bool full_ = false;
  std::int64_t steps_ = 0;
};

}  // namespace pd::dimension::detail

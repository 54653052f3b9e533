/// @file
/// Khachiyan's weights of a small set of points, in a frame in which the set is about a unit box.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "dimension/any_dimension.hpp"
#include "pd/dimension/enclosing_ellipsoid.hpp"

namespace pd::dimension::detail {

/// An orthogonal frame with a scale an axis: the points of a set have coordinates in [-1, 1] there, and every axis
/// holds one at distance 1 from the span of those before. `rank` is less than the dimension when the set is flat within
/// rounding.
struct SpanningFrame {
  AnyMap to_frame;
  int rank = 0;
  double largest_scale = 0;
  double smallest_scale = 0;
};

/// Farthest point first, then farthest from the line, and so on.
SpanningFrame spanning_frame(const Points& points);

/// The sandwich of the hull of a small full-dimensional set: ratio <= d (1 + eta) by the ascent of [TY] with away
/// steps. Adds to `steps`. False when the set is flat within rounding.
bool core_ellipsoid(const Points& points, double eta, AnySandwich& sandwich, std::int64_t& steps);

/// `enclosing_ellipsoid` of a dimension known at run time.
Expected<EnclosingEllipsoid<kAnyDimension>> enclosing_ellipsoid_of(const Points& points, double eta);

/// A core set of a stream of points, from which every point is within a constant multiple of the core's ellipsoid.
/// Points join, and never leave, so that nothing is lost by one change after another.
class CoreSet {
 public:
  void add(const Points& chunk);

  [[nodiscard]] bool full_dimensional() const { return full_; }
  [[nodiscard]] const std::vector<AnyVector>& points() const { return core_; }
  /// Inner ellipsoid certified (it lies in the hull of the core); `ratio` of the core, not of the stream.
  [[nodiscard]] const AnySandwich& sandwich() const { return sandwich_; }
  [[nodiscard]] std::int64_t steps() const { return steps_; }

 private:
  void extend_span(const AnyVector& p);
  void join(const AnyVector& p);

  std::vector<AnyVector> core_;
  AnySandwich sandwich_;
  AnyMap to_unit_;
  bool full_ = false;
  std::int64_t steps_ = 0;
};

}  // namespace pd::dimension::detail

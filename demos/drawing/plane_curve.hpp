/// @file
/// Affine maps of the plane, and the curves that drawings are made of as polylines within a stated distance.
#pragma once

#include <array>
#include <vector>

#include "pd/planar/contact.hpp"

namespace pd::drawing {

/// (x, y) -> (a x + c y + e, b x + d y + f), the order of SVG's matrix(a b c d e f).
struct PlaneMap {
  double a = 1, b = 0, c = 0, d = 1, e = 0, f = 0;

  [[nodiscard]] Point2 vector(const Point2& v) const { return {a * v[0] + c * v[1], b * v[0] + d * v[1]}; }
  [[nodiscard]] Point2 point(const Point2& p) const {
    const Point2 v = vector(p);
    return {v[0] + e, v[1] + f};
  }
  /// First `inner`, then this.
  [[nodiscard]] PlaneMap after(const PlaneMap& inner) const;
};

/// A piece of an outline between two of its points.
struct PlaneCurve {
  enum class Kind { line, quadratic, cubic, arc };
  Kind kind = Kind::line;
  Point2 from = {}, to = {};
  /// Control points of a quadratic (one) or cubic (two) Bezier curve; the half axes u, v of an arc.
  std::array<Point2, 2> control = {};
  /// The arc centre + u cos t + v sin t for t from start to start + sweep, in radians.
  Point2 centre = {};
  double start = 0, sweep = 0;

  [[nodiscard]] PlaneCurve mapped(const PlaneMap& map) const;
};

/// Points of a box that holds the curve: its ends, and control points or the corners of an arc's parallelogram.
void append_bounds(const PlaneCurve& curve, std::vector<Point2>& points);

/// Appends the curve's points after `from`, up to and with `to`, so that every point of the curve lies within
/// `distance` of the chord of its part, rounding apart: Bezier curves by |B''| h^2 / 8 over equal parameter steps h,
/// arcs by the longer axis' (1 - cos(h / 2)).
/// @return false when that takes more than `most` points; nothing is appended then.
[[nodiscard]] bool append_flattened(const PlaneCurve& curve, double distance, std::size_t most,
                                    std::vector<Point2>& points);

}  // namespace pd::drawing

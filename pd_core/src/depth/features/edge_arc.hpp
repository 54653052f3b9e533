/// @file
/// The least height of P over the directions of one edge, where P is a polytope and a cylinder or a cone: the edge's
/// arc of the polytope's normal diagram.
///
/// Across the edge everything is planar: P's shadow along it is an ellipse's half, or both halves with a segment
/// between them, or one with an apex, moved by the edge's own point. The height h(phi) of the angle phi is that
/// shadow's support function, whose radius of curvature is h + h''. Along a rim of radius r that is r e^2 / q^3 with
/// the axis' part e along the edge and the direction's part q across the axis. Two bounds from below follow, for any
/// part of the arc in which the radius of curvature is at least `c`:
/// - a disc of radius k <= c may be taken out of the shadow: h - k is convex still, and at least the height of the
///   supports at both ends, of which one or the other is greatest, so that the least is at an end or across their
///   chord;
/// - h(phi) >= c + (h(0) - c) cos(phi) + h'(0) sin(phi) about a direction known, by Sturm's comparison. At a minimum,
///   where c is mostly more than h, it says that there is no lower one nearby.
#pragma once

#include "pd/numeric/vector.hpp"

namespace pd::detail {

/// A cylinder or a cone about an axis through the origin, of either sense.
struct RevolvedCore {
  Vec3 axis;  ///< unit; towards a cone's apex
  double radius;
  double half_height;
  bool pointed;  ///< a cone
  double kink;   ///< <axis, n> of the unit directions n across a line of its mantle; 0 of a cylinder
};

/// The least height so far, and its direction.
struct LeastHeight {
  double height;
  Vec3 normal;
  bool on_mantle = false;  ///< across a line of the mantle
};

class EdgeArc {
 public:
  /// @param point  of the edge. @param along  it, of any length, known to a few u of it. @param from, to  unit normals
  /// of the edge's facets, less than a half turn apart.
  EdgeArc(const RevolvedCore& core, const Vec3& point, const Vec3& along, const Vec3& from, const Vec3& to);

  /// Of P's height on the arc, or of `least.height` - `slack`, the less is returned, or what is certain to be below
  /// both, up to rounding. Lower heights met on the way go to `least`.
  /// @param touches_left  directions that may be looked at; counted down. -infinity is returned where they give out.
  double search(double slack, int& touches_left, LeastHeight& least);

 private:
  enum class Part : unsigned char { lower_rim, upper };  ///< upper: a rim or an apex

  /// A direction in the arc's plane and P's point there.
  struct Touch {
    double x, y;     ///< unit
    double along;    ///< <axis, n>
    double turned;   ///< the axis' part in the plane, a quarter turn ahead of n
    double across;   ///< |n - <axis, n> axis|
    double height;   ///< h
    double slope;    ///< h'
    Part part;       ///< of the core
    bool is_bottom;  ///< Newton's method ended there
  };

  [[nodiscard]] Part part_at(double along, double across) const;
  [[nodiscard]] Touch touch(double x, double y, Part part) const;
  [[nodiscard]] Touch touch(double x, double y) const;
  /// Strictly, of a direction of any length.
  [[nodiscard]] static bool is_between(const Touch& from, const Touch& to, double x, double y);
  [[nodiscard]] double curvature_radius(double across) const;
  [[nodiscard]] double least_curvature_radius(const Touch& from, const Touch& to) const;
  /// At most h between the two; the direction across the chord, not of unit length, goes to `middle`.
  [[nodiscard]] double floor_between(const Touch& from, const Touch& to, double (&middle)[2]) const;
  void note(const Touch& touch, bool on_mantle);
  double between(const Touch& from, const Touch& to);
  double between_parts(const Touch& from, const Touch& to);
  [[nodiscard]] Touch bottom(const Touch& from, const Touch& to);

  const RevolvedCore& core_;
  Vec3 u_, w_;  ///< the plane: `from` and across it
  double point_u_, point_w_;
  double axis_u_, axis_w_, axis_edge_;
  double end_x_, end_y_;  ///< `to`
  double slack_ = 0;
  int* touches_left_ = nullptr;
  LeastHeight* least_ = nullptr;
};

}  // namespace pd::detail

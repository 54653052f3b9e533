/// @file
/// The faces of two bodies across one direction, up to a tolerance, and whether they share more than a point.
#pragma once

#include <array>
#include <vector>

#include "pd/shape/convex_shape.hpp"

namespace pd::detail {

/// A core in the common frame, relative to an origin near it.
class PosedCore {
 public:
  PosedCore(const PosedShape& body, const Vec3& origin);

  /// The point farthest along a direction.
  [[nodiscard]] Vec3 support(const Vec3& direction) const;
  /// Points that span the part of the core within `height` of its supporting plane across the unit vector `outward`:
  /// a polytope's vertices there; of a curved core the supports in 32 directions that lean from `outward` by `lean`.
  void near_face(const Vec3& outward, double height, double lean, std::vector<Vec3>& points) const;
  /// The second derivative of a curved core's support function at `outward`, across the flat directions that the core
  /// has at its point `point` there; 0 for polytopes. Requires that the face there is no disc or polygon of a curved
  /// core. @param flats  how many of those directions there are
  [[nodiscard]] Mat3 curvature(const Vec3& outward, const Vec3& point, int flats) const;
  /// Of a curved core's face across a direction within `lean` of `outward`: 2 a disc or polygon, 1 a line from rim to
  /// rim or apex or between two spheres, 0 a point.
  [[nodiscard]] int straight_dimensions(const Vec3& outward, double lean) const;
  [[nodiscard]] bool curved() const { return polytope_ == nullptr; }

 private:
  const ConvexShape::Core* core_;
  const ConvexPolytope* polytope_;
  Mat3 rotation_;
  Vec3 offset_;
};

using PlanePoint = Eigen::Matrix<double, 2, 1, Eigen::DontAlign>;

/// A convex polygon (or segment, or point) seen along a direction, relative to a point of it.
class PlaneFace {
 public:
  /// @param across  two unit vectors that span the plane.
  PlaneFace(const std::vector<Vec3>& points, const Vec3& centre, const std::array<Vec3, 2>& across);

  /// Corners of the hull, counter-clockwise.
  [[nodiscard]] const std::vector<PlanePoint>& hull() const { return hull_; }
  /// 0, 1 or 2: directions in which it extends farther than `reach`, the longest first.
  [[nodiscard]] int extent(double reach, std::array<PlanePoint, 2>& directions) const;
  /// Distance from the centre to the rim: the nearest end of a face of extent 1, the nearest edge of one of extent 2.
  [[nodiscard]] double inside(int extent, const std::array<PlanePoint, 2>& directions) const;

 private:
  std::vector<PlanePoint> hull_;
};

/// Whether two faces with the same centre share a point farther than `reach` from it, each grown by `sideways`.
[[nodiscard]] bool share_more_than_the_centre(const PlaneFace& a, const PlaneFace& b, double sideways, double reach);

/// The radius of a disc about the centre in the sum of `b` and the point reflection of `a`: of the foot in P's facet.
[[nodiscard]] double disc_in_difference(const PlaneFace& a, const PlaneFace& b);

}  // namespace pd::detail

/// @file
/// P = B + (-A) where at least one core is smooth: supports by formula, in doubles with stated error bounds.
#pragma once

#include <vector>

#include "depth/difference/polytope_difference.hpp"
#include "pd/shape/convex_shape.hpp"

namespace pd::detail {

/// The points of A and B whose difference a support is.
struct PointPair {
  Vec3 a;
  Vec3 b;
  Vec3 local_a = Vec3::Zero();  ///< in the bodies' frames
  Vec3 local_b = Vec3::Zero();
};

/// The point of a core that is farthest in a direction of its own frame (any length; a zero direction gives some
/// point).
[[nodiscard]] Vec3 support_point(const ConvexShape::Core& core, const Vec3& direction);

/// The first of those with the largest radius.
[[nodiscard]] const Sphere& largest_sphere(const SphereHull& hull);

/// A radius of a ball that rolls freely inside a core, rounded down: r_min^2 / r_max of an ellipsoid, its least radius
/// of curvature; 0 of every other core. By Blaschke's rolling theorem h(n) less that radius is the support function of
/// a convex body for unit n: the core is that body swept by the ball (W. Blaschke, Kreis und Kugel, 1916, section 24).
[[nodiscard]] double rolling_radius(const ConvexShape::Core& core);

/// Whether the balls that roll inside the cores are taken out of them.
enum class Rolling : std::uint8_t { kept, taken_out };

/// The same interface as PolytopeDifference; the "ids" of a support are its index in `points`.
///
/// With the rolling balls taken out, A and B stand for the bodies that are left. Balls become points and near-balls
/// small bodies, so that their nearly tied directions fall apart.
class SmoothDifference {
 public:
  /// @param points  buffer, grown by one a support; relative to the translation of A.
  SmoothDifference(const PosedShape& a, const PosedShape& b, std::vector<PointPair>& points,
                   Rolling rolling = Rolling::kept);

  /// The difference after A moved by `way`; both share the buffer of points.
  [[nodiscard]] SmoothDifference moved(const Vec3& way) const;

  /// The difference of two points of the cores, each in its body's frame.
  [[nodiscard]] DifferenceVertex vertex(const Vec3& local_a, const Vec3& local_b) const;
  [[nodiscard]] DifferenceVertex support(const Vec3& direction, const DifferenceVertex* near) const;
  [[nodiscard]] DifferenceVertex support_in_bodies(const Vec3& direction) const { return support(direction, nullptr); }
  /// A formula is within its error of the maximum wherever it is asked.
  [[nodiscard]] DifferenceVertex search_support(const Vec3& direction) const {
    return support(direction / direction.norm(), nullptr);
  }
  [[nodiscard]] DifferenceVertex search_support_along(const Vec3& unit) const { return support(unit, nullptr); }
  void search_supports(const Vec3 (&directions)[4], DifferenceVertex (&supports)[4]) const {
    for (int k = 0; k < 4; ++k) supports[k] = search_support_along(directions[k]);
  }
  [[nodiscard]] DifferenceVertex certified_support(const Vec3&, const DifferenceVertex& s,
                                                   std::vector<std::int32_t>&) const {
    return s;
  }
  [[nodiscard]] const PointPair& points(const DifferenceVertex& s) const {
    return points_[static_cast<std::size_t>(s.a)];
  }
  [[nodiscard]] Vec3 centre() const;
  /// The point of A's core (`of` 0) or B's (1) farthest along a unit vector, and one inside it, both relative to the
  /// body's translation in the caller's axes.
  [[nodiscard]] Vec3 support_of(int of, const Vec3& unit) const {
    const Body& body = of == 0 ? a_ : b_;
    return body.rotation * support_point(*body.core, body.rotation.transpose() * unit);
  }
  [[nodiscard]] Vec3 centre_of(int of) const {
    const Body& body = of == 0 ? a_ : b_;
    return body.rotation * body.centre;
  }
  [[nodiscard]] const ConvexShape::Core& core_of(int of) const { return *(of == 0 ? a_ : b_).core; }
  [[nodiscard]] const Mat3& rotation_of(int of) const { return (of == 0 ? a_ : b_).rotation; }
  /// t_B - t_A.
  [[nodiscard]] const Vec3& offset() const { return offset_; }
  [[nodiscard]] double reach() const { return reach_; }
  /// The radius of the ball taken out of A (`of` 0) or B (1).
  [[nodiscard]] double taken_out(int of) const { return of == 0 ? a_.taken_out : b_.taken_out; }
  /// Rotation by the nearest rotation (orthogonal to a few u), the formula and the sums: below 32u of the reach. A unit
  /// vector errs by 4u, and what is taken out along it by 8u with its sum.
  [[nodiscard]] double point_error() const { return point_error_; }
  [[nodiscard]] double support_error() const { return 32 * kUnitRoundoff * reach_; }

 private:
  struct Body {
    const ConvexShape::Core* core;
    Mat3 rotation;
    Vec3 centre;    ///< local
    double radius;  ///< >= |x| for every local point
    double taken_out;
  };
  static Body body(const PosedShape& posed, Rolling rolling);
  static Vec3 support_of_rest(const Body& body, const Vec3& direction);

  Body a_;
  Body b_;
  Vec3 offset_;
  double reach_;
  double point_error_;
  std::vector<PointPair>& points_;
};

}  // namespace pd::detail

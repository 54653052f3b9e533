/// @file
/// Every convex body of the library: a core (polytope or smooth) swept by a ball.
///
/// A sphere is a point with a margin, a capsule a segment with a margin. They need no code of their own, and their
/// depth is exact: the core's signed distance less the two margins ([A] section 1 on Minkowski sums).
///
/// [A] Agarwal, Guibas, Har-Peled, Rabinovitch, Sharir, "Penetration depth of two convex polytopes in 3D", 2000.
#pragma once

#include <span>
#include <string_view>
#include <variant>

#include "pd/numeric/expected.hpp"
#include "pd/numeric/vector.hpp"
#include "pd/shape/convex_polytope.hpp"
#include "pd/shape/pose.hpp"
#include "pd/shape/sphere_hull.hpp"

namespace pd {

/// Sizes of ellipsoids, cylinders, cones and hulls of spheres lie between these. Queries about them bring a pair to
/// size 1 by a power of two, and give the same bits times that power anywhere in between.
inline constexpr double kMinCurvedSize = 0x1p-900;
inline constexpr double kMaxCurvedSize = 0x1p900;

/// {x : sum (x_i / radii_i)^2 <= 1}.
struct Ellipsoid {
  Vec3 radii;
};

/// Radius about the axis (0, 1, 2 = x, y, z), from -half_height to +half_height along it.
struct Cylinder {
  double radius;
  double half_height;
  int axis;
};

/// Base of the radius at -half_height, apex at +half_height along the axis.
struct Cone {
  double radius;
  double half_height;
  int axis;
};

/// A convex core and a margin >= 0 (the body is the Minkowski sum of the posed core and a ball of that radius). Value
/// type, cheap to copy.
class ConvexShape {
 public:
  using Core = std::variant<ConvexPolytope, Ellipsoid, Cylinder, Cone, SphereHull>;

  ConvexShape(ConvexPolytope polytope)  // NOLINT(google-explicit-constructor): a polytope is a shape
      : core_(std::move(polytope)) {}

  /// Factories refuse sizes that are not finite (`non_finite`), not positive (`bad_value`) or above kMaxCoordinate
  /// (curved ones: outside [kMinCurvedSize, kMaxCurvedSize]) (`out_of_range`); `where` names the parameter ("radius",
  /// "radii[1]", "half_height", "axis").
  static Expected<ConvexShape> sphere(double radius);
  static Expected<ConvexShape> ellipsoid(const Vec3& radii);
  static Expected<ConvexShape> capsule(double radius, double half_height, int axis);
  static Expected<ConvexShape> cylinder(double radius, double half_height, int axis);
  static Expected<ConvexShape> cone(double radius, double half_height, int axis);

  /// The convex hull of spheres, in any order. Repeated ones, and what lies inside the hull of the others, change
  /// nothing. The least radius becomes the margin, exactly; the rest of each radius is rounded to a double. Equal radii
  /// give the polytope of the centres with that margin.
  ///
  /// Refused as above, a radius below 0 as `bad_value`, no spheres as `too_few_points`; `where` is "spheres[i]".
  /// Time: seldom more than O(k) a sphere, at most O(k + 2^18).
  static Expected<ConvexShape> hull_of_spheres(std::span<const Sphere> spheres);

  /// This core with `margin` added to the present one; margin >= 0 ("margin").
  [[nodiscard]] Expected<ConvexShape> with_margin(double margin) const;

  [[nodiscard]] const Core& core() const { return core_; }
  [[nodiscard]] double margin() const { return margin_; }
  /// The polytope core, or nullptr where the core is smooth.
  [[nodiscard]] const ConvexPolytope* polytope() const { return std::get_if<ConvexPolytope>(&core_); }

 private:
  explicit ConvexShape(Core core, double margin) : core_(std::move(core)), margin_(margin) {}

  Core core_;
  double margin_ = 0;
};

/// A shape and where it stands. Refers to the shape: it must outlive the query.
struct PosedShape {
  const ConvexShape* shape;
  Pose pose;
};

}  // namespace pd

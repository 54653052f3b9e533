/// @file
/// The depth of a point in a cylinder or a cone in closed form: both are cut out by the planes of their discs and those
/// that touch the mantle, so that the nearest of these decides, and of the mantle's the one on the point's side.
///
/// An expansion meets all planes of the mantle at once where the point is on the axis.
#pragma once

#include <optional>

#include "pd/numeric/vector.hpp"
#include "pd/shape/convex_shape.hpp"

namespace pd::detail {

/// All in the core's frame.
struct PointInCore {
  double lower = 0;              ///< the ball of this radius around the point lies in the core; 0: nothing is known
  Vec3 outward = Vec3::UnitX();  ///< from the point to the nearest point of the surface, any length
  Vec3 surface = Vec3::Zero();   ///< that point
};

/// Nothing where the point is not inside for certain.
[[nodiscard]] std::optional<PointInCore> point_in_cylinder(const Cylinder& cylinder, const Vec3& point);
[[nodiscard]] std::optional<PointInCore> point_in_cone(const Cone& cone, const Vec3& point);

}  // namespace pd::detail

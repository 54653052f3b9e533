#include "depth/features/point_in_revolution.hpp"

#include <algorithm>
#include <cmath>

#include "numeric/unit_roundoff.hpp"

namespace pd::detail {

namespace {

/// A height over a plane errs by some 8u of radius and height together.
constexpr double kAxisHeightError = 16 * kUnitRoundoff;

/// The point's distance from the axis, and the unit vector to it; on the axis any across.
struct Across {
  Vec3 unit;
  double distance;

  Across(const Vec3& point, int axis) : unit(point) {
    unit[axis] = 0;
    distance = unit.norm();
    unit = distance > 0 ? Vec3(unit / distance) : Vec3(Vec3::Unit((axis + 1) % 3));
  }
};

std::optional<PointInCore> found(const Vec3& point, double depth, const Vec3& unit, double size) {
  const double lower = depth - kAxisHeightError * size;
  if (!(lower > 0)) return std::nullopt;
  return PointInCore{lower, unit, point + depth * unit};
}

}  // namespace

std::optional<PointInCore> point_in_cylinder(const Cylinder& cylinder, const Vec3& point) {
  const double along = point[cylinder.axis];
  const Across across(point, cylinder.axis);
  const double to_disc = cylinder.half_height - std::abs(along);
  const double to_mantle = cylinder.radius - across.distance;
  const Vec3 up = Vec3::Unit(cylinder.axis);
  return found(point, std::min(to_disc, to_mantle), to_mantle < to_disc ? across.unit : (along < 0 ? Vec3(-up) : up),
               cylinder.radius + cylinder.half_height);
}

std::optional<PointInCore> point_in_cone(const Cone& cone, const Vec3& point) {
  const Across across(point, cone.axis);
  const double height = 2 * cone.half_height;
  const double slant = std::sqrt(cone.radius * cone.radius + height * height);
  // The mantle's plane on the point's side: its normal in the half plane through axis and point.
  const double outward = height / slant, upward = cone.radius / slant;
  const double to_base = point[cone.axis] + cone.half_height;
  const double to_mantle = upward * (cone.half_height - point[cone.axis]) - outward * across.distance;
  const Vec3 up = Vec3::Unit(cone.axis);
  return found(point, std::min(to_base, to_mantle),
               to_mantle < to_base ? Vec3(outward * across.unit + upward * up) : Vec3(-up), cone.radius + height);
}

}  // namespace pd::detail

#include "pd/shape/convex_shape.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "numeric/number_text.hpp"
#include "shape/outer_spheres.hpp"

namespace pd {
namespace {

using detail::number_text;

std::optional<Error> refuse_size(double value, const std::string& name, bool zero_allowed = false) {
  if (!std::isfinite(value)) return Error{ErrorCode::non_finite, "a size must be finite", name};
  if (value < 0 || (value == 0 && !zero_allowed)) {
    return Error{ErrorCode::bad_value, number_text(value) + (zero_allowed ? " must be >= 0" : " must be > 0"), name};
  }
  if (value > kMaxCoordinate) {
    return Error{ErrorCode::out_of_range,
                 number_text(value) + " is above the largest size " + number_text(kMaxCoordinate), name};
  }
  return std::nullopt;
}

/// Sizes of curved bodies, whose supports are formulas: brought near 1 they must stay numbers.
std::optional<Error> refuse_curved_size(double value, const std::string& name) {
  if (auto refused = refuse_size(value, name)) return refused;
  if (value >= kMinCurvedSize && value <= kMaxCurvedSize) return std::nullopt;
  return Error{ErrorCode::out_of_range,
               number_text(value) + " is not a size of a curved body, which lies in [" + number_text(kMinCurvedSize) +
                   ", " + number_text(kMaxCurvedSize) + "]",
               name};
}

std::optional<Error> refuse_axial(double radius, double half_height, int axis, bool zero_height_allowed) {
  if (auto refused = refuse_size(radius, "radius")) return refused;
  if (auto refused = refuse_size(half_height, "half_height", zero_height_allowed)) return refused;
  if (axis < 0 || axis > 2) {
    return Error{ErrorCode::bad_value, std::to_string(axis) + " names no axis, must be 0, 1 or 2 (x, y, z)", "axis"};
  }
  return std::nullopt;
}

}  // namespace

Expected<ConvexShape> ConvexShape::sphere(double radius) {
  if (auto refused = refuse_size(radius, "radius")) return *std::move(refused);
  const Vec3 center = Vec3::Zero();
  auto point = ConvexPolytope::from_points({&center, 1});
  if (!point) return point.error();
  return ConvexShape(Core(*std::move(point)), radius);
}

Expected<ConvexShape> ConvexShape::ellipsoid(const Vec3& radii) {
  for (int i = 0; i < 3; ++i) {
    if (auto refused = refuse_curved_size(radii[i], detail::indexed("radii", i))) return *std::move(refused);
  }
  return ConvexShape(Core(Ellipsoid{radii}), 0);
}

Expected<ConvexShape> ConvexShape::capsule(double radius, double half_height, int axis) {
  if (auto refused = refuse_axial(radius, half_height, axis, true)) return *std::move(refused);
  Vec3 ends[2] = {Vec3::Zero(), Vec3::Zero()};
  ends[0][axis] = -half_height;
  ends[1][axis] = half_height;
  auto segment = ConvexPolytope::from_points(ends);
  if (!segment) return segment.error();
  return ConvexShape(Core(*std::move(segment)), radius);
}

Expected<ConvexShape> ConvexShape::cylinder(double radius, double half_height, int axis) {
  if (auto refused = refuse_curved_size(radius, "radius")) return *std::move(refused);
  if (auto refused = refuse_curved_size(half_height, "half_height")) return *std::move(refused);
  if (auto refused = refuse_axial(radius, half_height, axis, false)) return *std::move(refused);
  return ConvexShape(Core(Cylinder{radius, half_height, axis}), 0);
}

Expected<ConvexShape> ConvexShape::cone(double radius, double half_height, int axis) {
  if (auto refused = refuse_curved_size(radius, "radius")) return *std::move(refused);
  if (auto refused = refuse_curved_size(half_height, "half_height")) return *std::move(refused);
  if (auto refused = refuse_axial(radius, half_height, axis, false)) return *std::move(refused);
  return ConvexShape(Core(Cone{radius, half_height, axis}), 0);
}

Expected<ConvexShape> ConvexShape::hull_of_spheres(std::span<const Sphere> spheres) {
  if (spheres.empty()) return Error{ErrorCode::too_few_points, "a hull of spheres needs one sphere or more", "spheres"};
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    const std::string where = detail::indexed("spheres", static_cast<long long>(i));
    if (auto refused = refuse_size(spheres[i].radius, where, true)) return *std::move(refused);
    const double farthest = spheres[i].centre.cwiseAbs().maxCoeff();
    if (!spheres[i].centre.allFinite()) return Error{ErrorCode::non_finite, "a centre must be finite", where};
    if (auto refused = refuse_size(farthest, where, true)) return *std::move(refused);
  }
  const auto thinner = [](const Sphere& x, const Sphere& y) { return x.radius < y.radius; };
  std::vector<Sphere> outer(spheres.begin(), spheres.end());
  const auto equal = [&] {
    const auto [least, most] = std::minmax_element(outer.begin(), outer.end(), thinner);
    return least->radius == most->radius;
  };
  if (!equal()) {
    for (std::size_t i = 0; i < spheres.size(); ++i) {
      const double size = std::max(spheres[i].centre.cwiseAbs().maxCoeff(), spheres[i].radius);
      if (size == 0) continue;
      if (auto refused = refuse_curved_size(size, detail::indexed("spheres", static_cast<long long>(i)))) {
        return *std::move(refused);
      }
    }
    detail::keep_outer_spheres(outer);
  }
  const double margin = std::min_element(outer.begin(), outer.end(), thinner)->radius;
  if (!equal()) {
    for (Sphere& sphere : outer) sphere.radius -= margin;
    return ConvexShape(Core(SphereHull(std::move(outer))), margin);
  }
  std::vector<Vec3> centres;
  for (const Sphere& sphere : outer) centres.push_back(sphere.centre);
  auto polytope = ConvexPolytope::from_points(centres);
  if (!polytope) return polytope.error();
  return ConvexShape(Core(*std::move(polytope)), margin);
}

Expected<ConvexShape> ConvexShape::with_margin(double margin) const {
  if (auto refused = refuse_size(margin, "margin", true)) return *std::move(refused);
  if (auto refused = refuse_size(margin_ + margin, "margin", true)) return *std::move(refused);
  return ConvexShape(core_, margin_ + margin);
}

}  // namespace pd

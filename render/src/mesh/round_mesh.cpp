/// @file
/// Curved bodies for the eye: a profile turned about an axis, 56 steps round, 26 over a sphere's meridian; hulls of
/// spheres by their supports in the directions of a sphere.
#include <cmath>
#include <numbers>

#include "mesh/mesh_builder.hpp"

namespace pd::render {
namespace {

constexpr int kAround = 56;
constexpr int kMeridian = 26;

/// A point of the profile: distance from the axis, height along it, and the normal in that half plane.
struct ProfilePoint {
  double radius;
  double height;
  double normal_radius;
  double normal_height;
};

/// (radial x, radial y, along) to (x, y, z) with the axis given, orientation kept.
Vec3 about_axis(double u, double v, double along, int axis) {
  Vec3 result;
  result[axis] = along;
  result[(axis + 1) % 3] = u;
  result[(axis + 2) % 3] = v;
  return result;
}

double turn(int step) { return 2 * std::numbers::pi * (step % kAround) / kAround; }

/// Joins rows of kAround + 1 vertices, the lowest row first; a pole's row has no triangles of its own.
void add_strips(detail::MeshBuilder& builder, std::uint32_t first, std::uint32_t rows, bool lower_pole,
                bool upper_pole) {
  constexpr std::uint32_t kRow = kAround + 1;
  for (std::uint32_t row = 0; row + 1 < rows; ++row) {
    for (std::uint32_t step = 0; step < kAround; ++step) {
      const std::uint32_t a = first + row * kRow + step;
      if (row > 0 || !lower_pole) {
        builder.add_triangle(a, a + 1, a + kRow);
      }
      if (row + 2 < rows || !upper_pole) {
        builder.add_triangle(a + 1, a + kRow + 1, a + kRow);
      }
    }
  }
}

/// Turns a profile that runs from the lower pole to the upper one.
void add_turned(detail::MeshBuilder& builder, std::span<const ProfilePoint> profile, int axis) {
  std::uint32_t first = 0;
  for (std::size_t row = 0; row < profile.size(); ++row) {
    for (int step = 0; step <= kAround; ++step) {
      const double c = std::cos(turn(step));
      const double s = std::sin(turn(step));
      const ProfilePoint& p = profile[row];
      const std::uint32_t vertex =
          builder.add_vertex(about_axis(p.radius * c, p.radius * s, p.height, axis),
                             about_axis(p.normal_radius * c, p.normal_radius * s, p.normal_height, axis));
      if (row == 0 && step == 0) {
        first = vertex;
      }
    }
  }
  add_strips(builder, first, static_cast<std::uint32_t>(profile.size()), profile.front().radius == 0,
             profile.back().radius == 0);
}

/// The circle where a flat lid (normal `lid` along the axis) meets a side.
void add_rim(detail::MeshBuilder& builder, const ProfilePoint& side, double lid, int axis) {
  for (int step = 0; step < kAround; ++step) {
    const double c = std::cos(turn(step));
    const double s = std::sin(turn(step));
    builder.add_edge(
        about_axis(side.radius * c, side.radius * s, side.height, axis),
        about_axis(side.radius * std::cos(turn(step + 1)), side.radius * std::sin(turn(step + 1)), side.height, axis),
        about_axis(0, 0, lid, axis),
        about_axis(side.normal_radius * c, side.normal_radius * s, side.normal_height, axis));
  }
}

/// Appends a piece of a meridian circle, angles from the lower pole (-90 degrees) upwards.
void add_arc(std::vector<ProfilePoint>& profile, double radius, double centre_height, int from_step, int to_step) {
  for (int i = from_step; i <= to_step; ++i) {
    const double angle = std::numbers::pi * (static_cast<double>(i) / kMeridian - 0.5);
    const bool pole = i == 0 || i == kMeridian;
    const double c = pole ? 0 : std::cos(angle);
    profile.push_back({radius * c, centre_height + radius * std::sin(angle), c, std::sin(angle)});
  }
}

/// A mesh over the directions of a sphere.
/// @param vertex  adds the vertex of a unit vector.
template <class Vertex>
MeshRef over_sphere(Vertex&& vertex) {
  detail::MeshBuilder builder;
  for (int row = 0; row <= kMeridian; ++row) {
    const double angle = std::numbers::pi * (static_cast<double>(row) / kMeridian - 0.5);
    const double c = row == 0 || row == kMeridian ? 0 : std::cos(angle);
    for (int step = 0; step <= kAround; ++step) {
      vertex(builder, Vec3(c * std::cos(turn(step)), c * std::sin(turn(step)), std::sin(angle)));
    }
  }
  add_strips(builder, 0, kMeridian + 1, true, true);
  return builder.finish();
}

}  // namespace

MeshRef sphere_mesh(double radius) { return ellipsoid_mesh(Vec3::Constant(radius)); }

MeshRef ellipsoid_mesh(const Vec3& radii) {
  return over_sphere([&](detail::MeshBuilder& builder, const Vec3& unit) {
    // The gradient of sum (x_i / r_i)^2, scaled so that no component overflows.
    const Vec3 gradient = (radii.minCoeff() * unit).cwiseQuotient(radii);
    builder.add_vertex(unit.cwiseProduct(radii), gradient.normalized());
  });
}

MeshRef sphere_hull_mesh(const SphereHull& hull) {
  return over_sphere(
      [&](detail::MeshBuilder& builder, const Vec3& unit) { builder.add_vertex(hull.support(unit), unit); });
}

MeshRef capsule_mesh(double radius, double half_height, int axis) {
  detail::MeshBuilder builder;
  std::vector<ProfilePoint> profile;
  add_arc(profile, radius, -half_height, 0, kMeridian / 2);
  add_arc(profile, radius, half_height, kMeridian / 2, kMeridian);
  add_turned(builder, profile, axis);
  return builder.finish();
}

MeshRef cylinder_mesh(double radius, double half_height, int axis) {
  detail::MeshBuilder builder;
  const std::array<ProfilePoint, 2> base = {{{0, -half_height, 0, -1}, {radius, -half_height, 0, -1}}};
  const std::array<ProfilePoint, 2> side = {{{radius, -half_height, 1, 0}, {radius, half_height, 1, 0}}};
  const std::array<ProfilePoint, 2> lid = {{{radius, half_height, 0, 1}, {0, half_height, 0, 1}}};
  add_turned(builder, base, axis);
  add_turned(builder, side, axis);
  add_turned(builder, lid, axis);
  add_rim(builder, side[0], -1, axis);
  add_rim(builder, side[1], 1, axis);
  return builder.finish();
}

MeshRef cone_mesh(double radius, double half_height, int axis) {
  detail::MeshBuilder builder;
  const double slant = std::hypot(radius, 2 * half_height);
  const double nr = 2 * half_height / slant;
  const double nh = radius / slant;
  const std::array<ProfilePoint, 2> base = {{{0, -half_height, 0, -1}, {radius, -half_height, 0, -1}}};
  const std::array<ProfilePoint, 2> side = {{{radius, -half_height, nr, nh}, {0, half_height, nr, nh}}};
  add_turned(builder, base, axis);
  add_turned(builder, side, axis);
  add_rim(builder, side[0], -1, axis);
  return builder.finish();
}

MeshRef box_mesh(const Vec3& half_extents) {
  detail::MeshBuilder builder;
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3;
    const int v = (axis + 2) % 3;
    for (const double side : {-1.0, 1.0}) {
      std::array<Vec3, 4> loop;
      for (std::size_t i = 0; i < 4; ++i) {
        Vec3 corner;
        corner[axis] = side * half_extents[axis];
        corner[u] = (i == 1 || i == 2 ? side : -side) * half_extents[u];
        corner[v] = (i >= 2 ? 1 : -1) * half_extents[v];
        loop[i] = corner;
      }
      builder.add_polygon(loop, side * Vec3::Unit(axis));
    }
    for (const double a : {-1.0, 1.0}) {
      for (const double b : {-1.0, 1.0}) {
        Vec3 from;
        from[axis] = -half_extents[axis];
        from[u] = a * half_extents[u];
        from[v] = b * half_extents[v];
        Vec3 to = from;
        to[axis] = half_extents[axis];
        builder.add_edge(from, to, a * Vec3::Unit(u), b * Vec3::Unit(v));
      }
    }
  }
  return builder.finish();
}

}  // namespace pd::render

#include "scenes/world_parts.hpp"

#include <cmath>

namespace pd::scenes {

double Stream::next() {
  state_ ^= state_ << 13;
  state_ ^= state_ >> 7;
  state_ ^= state_ << 17;
  return static_cast<double>(state_ >> 11) * 0x1p-52 - 1;
}

Vec3 Stream::vector() {
  const double x = next();
  const double y = next();
  return {x, y, next()};
}

Vec3 Stream::level_vector() {
  const double y = next();
  return {next(), y, 0};
}

Vec3 Stream::direction() {
  for (;;) {
    const Vec3 v = vector();
    if (v.norm() > 0.1 && v.norm() <= 1) {
      return v.normalized();
    }
  }
}

Eigen::Quaterniond Stream::orientation() {
  const Vec3 axis = direction();
  return Eigen::Quaterniond(Eigen::AngleAxisd(M_PI * next(), axis));
}

WorldBody ground_box(double extent) {
  WorldBody body = box(Vec3(extent, extent, 0.25 * extent), Vec3(0, 0, -0.25 * extent));
  body.mass = 0;
  body.drawn = false;
  return body;
}

WorldBody box(const Vec3& half_extents, const Vec3& at) {
  WorldBody body;
  body.kind = WorldBody::Kind::box;
  body.half_extents = half_extents;
  body.mass = kDensity * 8 * half_extents.prod();
  body.position = at;
  return body;
}

WorldBody cylinder(double radius, double half_height, const Vec3& at) {
  WorldBody body;
  body.kind = WorldBody::Kind::cylinder;
  body.half_extents = Vec3(radius, radius, half_height);
  body.mass = kDensity * M_PI * radius * radius * 2 * half_height;
  body.position = at;
  body.colour = 1;
  return body;
}

WorldBody sphere(double radius, const Vec3& at) {
  WorldBody body;
  body.kind = WorldBody::Kind::sphere;
  body.half_extents = Vec3::Constant(radius);
  body.mass = kDensity * 4.0 / 3 * M_PI * radius * radius * radius;
  body.position = at;
  body.colour = 3;
  return body;
}

WorldBody capsule(double radius, double half_length, const Vec3& at, double mass) {
  WorldBody body;
  body.kind = WorldBody::Kind::capsule;
  body.half_extents = Vec3(radius, radius, half_length);
  body.mass = mass;
  body.position = at;
  body.colour = 4;
  return body;
}

WorldBody stone(Stream& random, double radius, int points, const Vec3& at) {
  WorldBody body;
  const Vec3 radii = radius * (Vec3::Ones() + 0.3 * random.vector());
  for (int i = 0; i < points; ++i) {
    body.points.push_back(radii.cwiseProduct(random.direction()));
  }
  body.mass = kDensity * 4.0 / 3 * M_PI * radii.prod();
  body.position = at;
  body.colour = 2;
  return body;
}

WorldBody graph_mesh(double extent, int cells, const std::function<double(double, double)>& height, bool heightfield) {
  WorldBody body;
  body.kind = heightfield ? WorldBody::Kind::heightfield : WorldBody::Kind::mesh;
  const int side = cells + 1;
  for (int row = 0; row < side; ++row) {
    for (int column = 0; column < side; ++column) {
      const double x = extent * (2.0 * column / cells - 1);
      const double y = extent * (2.0 * row / cells - 1);
      body.points.emplace_back(x, y, height(x, y));
    }
  }
  for (int row = 0; row < cells; ++row) {
    for (int column = 0; column < cells; ++column) {
      const int corner = row * side + column;
      // The diagonal that btHeightfieldTerrainShape takes, so that mesh and heightfield are the same surface.
      body.triangles.push_back({corner, corner + 1, corner + side});
      body.triangles.push_back({corner + 1, corner + side + 1, corner + side});
    }
  }
  return body;
}

WorldBody flat_mesh(double extent, int cells, bool heightfield) {
  return graph_mesh(
      extent, cells, [](double, double) { return 0.0; }, heightfield);
}

void perturb(ContactScene& scene, std::uint64_t seed) {
  if (seed == 0) {
    return;
  }
  Stream random(seed);
  for (WorldBody& body : scene.world.bodies) {
    if (body.mass > 0) {
      body.position += 1e-6 * scene.size * random.vector();
    }
  }
}

}  // namespace pd::scenes

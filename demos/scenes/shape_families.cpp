#include "scenes/shape_families.hpp"

#include <algorithm>
#include <cmath>

namespace pd::scenes {

std::uint64_t Random::next() {
  state_ += 0x9E3779B97F4A7C15ULL;
  std::uint64_t z = state_;
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ULL;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBULL;
  return z ^ (z >> 31);
}

double Random::uniform() { return static_cast<double>(next() >> 11) * 0x1p-53; }

int Random::integer(int low, int high) {
  return low + static_cast<int>(next() % static_cast<std::uint64_t>(high - low + 1));
}

Vec3 Random::point(double low, double high) {
  const double z = uniform(low, high);
  const double y = uniform(low, high);
  return {uniform(low, high), y, z};
}

Vec3 Random::integer_point(int low, int high) {
  const int z = integer(low, high);
  const int y = integer(low, high);
  return {static_cast<double>(integer(low, high)), static_cast<double>(y), static_cast<double>(z)};
}

Vec3 Random::direction() {
  for (;;) {
    const double x = uniform(-1, 1);
    const double y = uniform(-1, 1);
    const double z = uniform(-1, 1);
    const double squared = x * x + y * y + z * z;
    if (squared > 1 || squared < 0.01) continue;
    const double length = std::sqrt(squared);
    return {x / length, y / length, z / length};
  }
}

Vec3 Random::vector(double shortest, double longest) {
  const Vec3 unit = direction();
  return uniform(shortest, longest) * unit;
}

std::array<double, 4> Random::quaternion() {
  for (;;) {
    const double w = uniform(-1, 1);
    const double x = uniform(-1, 1);
    const double y = uniform(-1, 1);
    const double z = uniform(-1, 1);
    const double squared = w * w + x * x + y * y + z * z;
    if (squared > 1 || squared < 0.01) continue;
    const double length = std::sqrt(squared);
    return {w / length, x / length, y / length, z / length};
  }
}

Pose Random::pose(const Vec3& translation) { return *Pose::from_quaternion(quaternion(), translation); }

// Reduced to an eighth of a turn, where Taylor's series to x^19 and x^18 ends below 1e-19.
Turn turn(double fraction) {
  double f = fraction - std::floor(fraction);
  const int eighths = static_cast<int>(f * 8);
  f -= static_cast<double>(eighths) / 8;
  const bool second_half = (eighths & 1) != 0;
  if (second_half) f = 0.125 - f;
  const double x = f * 6.283185307179586;
  const double xx = x * x;
  double s = 1;
  double c = 1;
  for (int k = 19; k >= 3; k -= 2) s = 1 - xx / ((k - 1) * k) * s;
  for (int k = 18; k >= 2; k -= 2) c = 1 - xx / ((k - 1) * k) * c;
  s *= x;
  if (second_half) std::swap(s, c);
  switch (eighths / 2) {
    case 1:
      return {c, -s};
    case 2:
      return {-s, -c};
    case 3:
      return {-c, s};
    default:
      return {s, c};
  }
}

Points box(const Vec3& half_extents) {
  Points points;
  for (int k = 0; k < 8; ++k) {
    points.emplace_back((k & 1) != 0 ? half_extents.x() : -half_extents.x(),
                        (k & 2) != 0 ? half_extents.y() : -half_extents.y(),
                        (k & 4) != 0 ? half_extents.z() : -half_extents.z());
  }
  return points;
}

Points sphere_hull(int n, Random& random) {
  Points points;
  for (int i = 0; i < n; ++i) points.push_back(random.direction());
  return points;
}

Points needle(int n, Random& random) {
  Points points = sphere_hull(n, random);
  for (Vec3& p : points) p = Vec3(p.x(), 0.01 * p.y(), 0.01 * p.z());
  return points;
}

Points prism(int n) {
  Points points;
  const int corners = std::max(3, n / 2);
  for (int i = 0; i < corners; ++i) {
    const Turn t = turn(static_cast<double>(i) / corners);
    points.emplace_back(t.cosine, t.sine, -0.5);
    points.emplace_back(t.cosine, t.sine, 0.5);
  }
  return points;
}

Points lens(int n, double eta) {
  Points points;
  const int upper = std::max(2, (n / 2 + 1) / 2);
  const int lower = std::max(2, n / 2 - upper);
  // Both arcs on circles of radius 1 whose centres lie so that the arcs meet at slope eta.
  const double centre = 1 / std::sqrt(1 + eta * eta);
  const auto arc = [&](int count, double side) {
    for (int i = 0; i < count; ++i) {
      // The two rims belong to the upper arc.
      const double s = side > 0 ? -eta + 2 * eta * i / (count - 1) : -eta + 2 * eta * (i + 1) / (count + 1);
      const double length = std::sqrt(1 + s * s);
      for (const double y : {-1.0, 1.0}) points.emplace_back(s / length, y, side * (1 / length - centre));
    }
  };
  arc(upper, 1);
  arc(lower, -1);
  return points;
}

Points roof(int n, const RoofShape& shape, Random& random) {
  Points points;
  const int ridges = std::max(3, (n - 4) / 2);
  const double step = 2 * shape.eta / (ridges - 1);
  for (int i = 0; i < ridges; ++i) {
    const double slope = -shape.eta + step * i;
    const double length = std::sqrt(1 + slope * slope);
    const double radius = 1 + shape.jitter * step * step * random.uniform(-0.5, 0.5);
    for (const double y : {-4.0, 4.0}) {
      // Tapered ends: the ridges fall off a little away from the middle, so that no end cap is flat.
      const double taper = 1 - 0.01 * random.uniform();
      const double tilt_x = shape.tilt * step * random.uniform(-1, 1);
      const double tilt_z = shape.tilt * step * step * random.uniform(-1, 1);
      points.emplace_back(radius * slope / length + tilt_x, y * taper, radius / length + tilt_z);
    }
  }
  for (const double y : {-5.0, 5.0}) points.emplace_back(0, y, 0.25);
  for (const double y : {-4.0, 4.0}) points.emplace_back(0, y, -3);
  return points;
}

Points sliver(int n, double thickness, Random& random) {
  Points points;
  for (int i = 0; i < n; ++i) {
    points.push_back(random.point(-1, 1));
    points.back().z() *= thickness;
  }
  return points;
}

Points polygon(int n, Random& random) {
  // In a coordinate plane, or in the plane x + y + z = 0 by integer coordinates: exactly flat in either case.
  Points points;
  const int plane = random.integer(0, 3);
  for (int i = 0; i < n; ++i) {
    if (plane == 3) {
      const int x = random.integer(-64, 64);
      const int y = random.integer(-64, 64);
      points.emplace_back(x / 64.0, y / 64.0, -(x + y) / 64.0);
      continue;
    }
    Vec3 p = random.point(-1, 1);
    p[plane] = 0;
    points.push_back(p);
  }
  return points;
}

Points cloud(int n, Random& random) {
  Points points;
  for (int i = 0; i < n; ++i) {
    const int kind = points.size() < 4 ? 0 : random.integer(0, 4);
    const auto pick = [&]() -> const Vec3& { return points[static_cast<std::size_t>(random.integer(0, i - 1))]; };
    if (kind == 1) {
      points.push_back(Vec3(pick()));  // a duplicate
    } else if (kind == 2) {
      const Vec3 end = pick();
      points.push_back(0.5 * (end + pick()));  // often exactly on an edge
    } else if (kind == 3) {
      Vec3 p = random.direction();
      p[random.integer(0, 2)] = random.integer(0, 1) != 0 ? 0.75 : -0.75;  // coplanar with many
      points.push_back(p);
    } else {
      const Vec3 p = random.direction();
      points.emplace_back(std::round(p.x() * 8) / 8, std::round(p.y() * 8) / 8, std::round(p.z() * 8) / 8);
    }
  }
  return points;
}

Points integer_points(int n, int range, Random& random) {
  Points points;
  for (int i = 0; i < n; ++i) points.push_back(random.integer_point(-range, range));
  return points;
}

}  // namespace pd::scenes

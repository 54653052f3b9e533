#include "depth/pair/direction_search.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace pd::detail {

namespace {

struct Triangle {
  std::array<Vec3, 3> corners;
};

/// Of two unit vectors, accurate for small angles.
double angle(const Vec3& u, const Vec3& v) { return 2 * std::asin(std::min(1.0, (u - v).norm() / 2)); }

std::vector<Triangle> octahedron() {
  std::vector<Triangle> faces;
  for (int octant = 0; octant < 8; ++octant) {
    const auto axis = [&](int k) { return Vec3((octant >> k & 1 ? 1.0 : -1.0) * Vec3::Unit(k)); };
    faces.push_back({{axis(0), axis(1), axis(2)}});
  }
  return faces;
}

}  // namespace

double cone_of_disc(double distance, double disc, double limit, double reach) {
  if (!(disc > 0) || !(distance > 0)) return reach;
  const double size = std::hypot(distance, disc);
  if (limit >= size) return reach;
  const double middle = std::atan2(disc, distance), half = std::acos(limit / size);
  // 1e-9 covers the rounding of the arc cosine.
  return middle - half <= reach ? std::max(reach, (middle + half) * (1 - 1e-9) - 1e-9) : reach;
}

bool another_direction_within(const PosedCore& a, const PosedCore& b, const ExcludedCone& cone, double limit,
                              std::int64_t& supports) {
  constexpr std::int64_t kMostTriangles = 200000;
  constexpr double kLeastTriangle = 1e-14;
  std::vector<Triangle> open = octahedron();
  for (std::int64_t seen = 0; !open.empty(); ++seen) {
    if (seen == kMostTriangles) return true;
    const Triangle t = open.back();
    open.pop_back();
    const Vec3 middle = (t.corners[0] + t.corners[1] + t.corners[2]).normalized();
    double radius = 0;
    for (const Vec3& corner : t.corners) radius = std::max(radius, angle(middle, corner));
    const double from_axis = angle(middle, cone.axis);
    if (from_axis + radius <= cone.radians) continue;
    const Vec3 p = b.support(middle) - a.support(-middle);
    ++supports;
    const double height = p.dot(middle);
    if (height <= limit && from_axis > cone.radians) return true;
    const double lean = std::atan2(p.cross(middle).norm(), height);
    if (p.norm() * std::cos(std::min(std::numbers::pi, lean + radius)) > limit) continue;
    if (radius < kLeastTriangle) return true;
    std::array<Vec3, 3> halves;
    for (std::size_t i = 0; i < 3; ++i) halves[i] = (t.corners[i] + t.corners[(i + 1) % 3]).normalized();
    open.push_back({halves});
    for (std::size_t i = 0; i < 3; ++i) open.push_back({{t.corners[i], halves[i], halves[(i + 2) % 3]}});
  }
  return false;
}

}  // namespace pd::detail

#include "contact/sphere_hull_face.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <utility>

namespace pd::detail {

namespace {

/// Of the size: spheres that a plane misses by no more than this touch it.
constexpr double kOnPlane = 1e-9;

/// From one sphere to another, and by how much the first one is larger, times a power of two that brings the way to
/// size 1: between spheres that nearly coincide beside one far away, products of lengths are below the range of
/// doubles.
struct Way {
  Vec3 apart;
  double larger;

  Way(const Sphere& from, const Sphere& to) : apart(to.centre - from.centre), larger(from.radius - to.radius) {
    const double most = apart.cwiseAbs().maxCoeff();
    if (!(most > 0)) return;
    const double scale = std::ldexp(1.0, std::clamp(-std::ilogb(most), -1022, 1022));
    apart *= scale;
    larger *= scale;
  }
};

/// The unit vector nearest to `near` in whose direction two spheres reach equally far; none where the larger one
/// reaches farther everywhere, or `near` runs along the line of their centres.
std::optional<Vec3> tie_of_two(const Sphere& p, const Sphere& q, const Vec3& near) {
  const Way way(p, q);
  const double length = way.apart.norm();
  const Vec3 along = way.apart / length;
  const double sine = way.larger / length;
  const Vec3 across = near - near.dot(along) * along;
  const double cosine_squared = 1 - sine * sine, rest = across.norm();
  if (!(cosine_squared > 0) || !(rest > 0)) return std::nullopt;
  return sine * along + std::sqrt(cosine_squared) / rest * across;
}

/// The same of three: of the two solutions the one nearer to `near`.
std::optional<Vec3> tie_of_three(const Sphere& p, const Sphere& q, const Sphere& r, const Vec3& near) {
  const Way to_q(p, q), to_r(p, r);
  const Vec3 &u = to_q.apart, &v = to_r.apart;
  const Vec3 normal = u.cross(v);
  const double area_squared = normal.squaredNorm();
  if (!(area_squared > kOnPlane * kOnPlane * u.squaredNorm() * v.squaredNorm())) return std::nullopt;
  // n = x + t normal with <u, x> = r_p - r_q, <v, x> = r_p - r_r and x in the span of u and v.
  const Vec3 x = (to_q.larger * v.cross(normal) + to_r.larger * normal.cross(u)) / area_squared;
  const double left = 1 - x.squaredNorm();
  if (!(left > 0)) return std::nullopt;
  return x + (normal.dot(near) < 0 ? -1 : 1) * std::sqrt(left / area_squared) * normal;
}

Vec3 touched(const Sphere& s, const Vec3& unit) { return s.centre + s.radius * unit; }

double height(const Sphere& s, const Vec3& unit) { return s.centre.dot(unit) + s.radius; }

/// Orders points of a plane into their convex loop, counter-clockwise about the normal, and drops the others (Jarvis'
/// march).
void keep_loop(std::vector<FaceVertex>& points, const Vec3& normal) {
  const Vec3 u = normal.unitOrthogonal();
  const auto lower = [&](const FaceVertex& p, const FaceVertex& q) { return p.point.dot(u) < q.point.dot(u); };
  std::iter_swap(points.begin(), std::min_element(points.begin(), points.end(), lower));
  std::size_t corners = 1;
  while (corners < points.size()) {
    const Vec3 from = points[corners - 1].point;
    std::size_t next = 0;
    for (std::size_t i = corners; i < points.size(); ++i) {
      const Vec3 best = points[next].point - from, other = points[i].point - from;
      const double turn = best.cross(other).dot(normal);
      if ((next == 0 && corners == 1) || turn < 0 || (turn == 0 && other.squaredNorm() > best.squaredNorm())) next = i;
    }
    if (next == 0) break;
    std::swap(points[corners++], points[next]);
  }
  points.resize(corners);
}

}  // namespace

void sphere_hull_face(const SphereHull& hull, const Vec3& direction, double edge_sine, double face_cosine,
                      SupportingFace& face) {
  const std::span<const Sphere> spheres = hull.spheres();
  face.vertices.clear();
  const auto push = [&](const Sphere& s, const Vec3& unit) {
    face.vertices.push_back({touched(s, unit), static_cast<std::int32_t>(&s - spheres.data())});
  };
  const auto lower = [&](const Sphere& p, const Sphere& q) { return height(p, direction) < height(q, direction); };
  const Sphere& first = *std::max_element(spheres.begin(), spheres.end(), lower);

  // 1. The sphere to which the surface falls off least.
  const Sphere* second = nullptr;
  double least_sine = edge_sine;
  for (const Sphere& s : spheres) {
    const double length = (s.centre - first.centre).norm();
    if (!(length > 0)) continue;
    const double sine = (height(first, direction) - height(s, direction)) / length;
    if (&s != &first && sine < least_sine) {
      least_sine = sine;
      second = &s;
    }
  }
  const std::optional<Vec3> tie = second != nullptr ? tie_of_two(first, *second, direction) : std::nullopt;
  if (!tie) {
    push(first, direction);
    return;
  }

  // 2. The plane on these two that a third one stops, turned as little as can be.
  std::optional<Vec3> plane;
  double size = 0;
  for (const Sphere& s : spheres) {
    size = std::max(size, (s.centre - first.centre).norm() + s.radius);
    if (&s == &first || &s == second) continue;
    const std::optional<Vec3> candidate = tie_of_three(first, *second, s, *tie);
    if (candidate && (!plane || candidate->dot(*tie) > plane->dot(*tie))) plane = candidate;
  }
  if (plane && plane->dot(direction) >= face_cosine) {
    const Vec3 normal = plane->normalized();
    const double level = height(first, normal) - kOnPlane * size;
    for (const Sphere& s : spheres) {
      if (height(s, normal) >= level) push(s, normal);
    }
    keep_loop(face.vertices, normal);
    face.plane_normal = normal;
    if (face.vertices.size() > 2) return;
    face.vertices.clear();
  }
  push(first, *tie);
  push(*second, *tie);
}

}  // namespace pd::detail

#include "compound/part_bounds.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "depth/difference/smooth_difference.hpp"
#include "pd/structure/direction_grid.hpp"
#include "shape/core_radius.hpp"

namespace pd::detail {

namespace {

/// Of the size: far above rounding, far below every bracket.
constexpr double kAir = 0x1p-40;

/// Unit vectors of a circle, `count` a power of two of at least 4. Bisected, since libraries differ in the last bit of
/// std::cos.
std::vector<Eigen::Vector2d> circle(std::size_t count) {
  std::vector<Eigen::Vector2d> points{{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
  while (points.size() < count) {
    std::vector<Eigen::Vector2d> finer;
    for (std::size_t i = 0; i < points.size(); ++i) {
      finer.push_back(points[i]);
      finer.push_back((points[i] + points[(i + 1) % points.size()]).normalized());
    }
    points = std::move(finer);
  }
  return points;
}

/// Points of a circle of the radius, of which so many leave a gap of at most `gap` between the polygons inside and
/// around it: 16 at most.
std::size_t rim_count(double radius, double gap) {
  constexpr double kGapOfFour = 0.71, kGapOfEight = 0.16;  // of a circle of radius 1: 1 / cos(x) - cos(x)
  return kGapOfFour * radius <= gap ? 4 : kGapOfEight * radius <= gap ? 8 : 16;
}

/// Unit vectors: 12, if they leave a gap of at most `gap` between the polytopes inside and around a ball of the radius,
/// else 42.
std::vector<Vec3> sphere(double radius, double gap) {
  constexpr double kGapOfTwelve = 0.47;               // of a ball of radius 1
  constexpr double kTwelve = 0.27, kFortyTwo = 0.07;  // the relative errors that so many directions leave
  return direction_grid(GridKind::geodesic, kGapOfTwelve * radius <= gap ? kTwelve : kFortyTwo)->directions;
}

Vec3 around(int axis, const Eigen::Vector2d& across, double along) {
  Vec3 v;
  v[axis] = along;
  v[(axis + 1) % 3] = across.x();
  v[(axis + 2) % 3] = across.y();
  return v;
}

}  // namespace

PartBounds::PartBounds(const PosedShape& part, double gap)
    : part_(part),
      gap_(gap),
      exact_(part.shape->polytope() != nullptr && part.shape->margin() == 0),
      rotation_(part.shape->polytope() != nullptr ? part.pose.rotation() : part.pose.nearest_rotation()),
      size_(2 * core_radius(part.shape->core()) + part.shape->margin()) {
  if (exact_) return;
  std::visit([&](const auto& core) { sample(core); }, part.shape->core());
}

void PartBounds::look_along(const Vec3& unit) {
  if (exact_) return;
  // Facets that are nearly parallel would meet in long numbers, and tell nothing new.
  constexpr double kNearlyParallel = 1 - 1e-8;
  const auto parallel = [&](const Halfspace3& plane) { return plane.normal.dot(unit) > kNearlyParallel; };
  if (std::none_of(planes_.begin(), planes_.end(), parallel)) add_direction(unit);
}

void PartBounds::add_direction(const Vec3& unit) {
  const Vec3 local = support_point(part_.shape->core(), rotation_.transpose() * unit);
  add_point(local, unit);
  planes_.push_back({unit, unit.dot(points_.back()) + kAir * size_});
}

void PartBounds::look_along_local(const Vec3& direction) { add_direction((rotation_ * direction).normalized()); }

void PartBounds::add_point(const Vec3& local_core, const Vec3& unit) {
  points_.push_back(rotation_ * local_core + part_.shape->margin() * unit);
}

void PartBounds::sample(const ConvexPolytope& core) {
  for (int f = 0; f < core.num_facets(); ++f) {
    look_along_local(core.facet_normal(f));
    const Vec3 unit = planes_.back().normal;
    for (const std::int32_t v : core.facet_vertices(f)) add_point(core.vertex(v), unit);
  }
  for (const Vec3& direction : sphere(part_.shape->margin(), gap_)) look_along_local(direction);
}

void PartBounds::sample(const Ellipsoid& core) {
  const double least = core.radii.minCoeff();
  const double most = core.radii.maxCoeff() + part_.shape->margin();
  for (const Vec3& direction : sphere(most, gap_)) look_along_local(direction.cwiseQuotient(core.radii / least));
}

void PartBounds::sample(const Cylinder& core) {
  const auto rim = circle(rim_count(core.radius + part_.shape->margin(), gap_));
  for (const double side : {-1.0, 1.0}) {
    look_along_local(side * Vec3::Unit(core.axis));
    const Vec3 unit = planes_.back().normal;
    for (const auto& across : rim) {
      add_point(around(core.axis, core.radius * across, side * core.half_height), unit);
    }
  }
  for (const auto& across : rim) {
    look_along_local(around(core.axis, across, 0));
    const Vec3 unit = planes_.back().normal;
    for (const double side : {-1.0, 1.0}) {
      add_point(around(core.axis, core.radius * across, side * core.half_height), unit);
    }
  }
}

void PartBounds::sample(const Cone& core) {
  const auto rim = circle(rim_count(core.radius + part_.shape->margin(), gap_));
  look_along_local(-Vec3::Unit(core.axis));
  const Vec3 down = planes_.back().normal;
  for (const auto& across : rim) {
    const Vec3 base = around(core.axis, core.radius * across, -core.half_height);
    add_point(base, down);
    look_along_local(around(core.axis, 2 * core.half_height * across, core.radius));
    const Vec3 unit = planes_.back().normal;
    add_point(base, unit);
    add_point(core.half_height * Vec3::Unit(core.axis), unit);
  }
}

void PartBounds::sample(const SphereHull& core) {
  double most = 0;
  for (const Sphere& s : core.spheres()) most = std::max(most, s.radius);
  for (const Vec3& direction : sphere(most + part_.shape->margin(), gap_)) look_along_local(direction);
}

std::optional<Compound::Part> PartBounds::inner() const {
  if (exact_) return Compound::Part{*part_.shape, part_.pose};
  Vec3 centre = Vec3::Zero();
  for (const Vec3& x : points_) centre += x / static_cast<double>(points_.size());
  std::vector<Vec3> inside;
  for (const Vec3& x : points_) inside.push_back(centre + (1 - kAir) * (x - centre));
  auto hull = ConvexPolytope::from_points(inside);
  if (!hull) return std::nullopt;
  return Compound::Part{*std::move(hull), Pose::from_trusted_matrix(Mat3::Identity(), part_.pose.translation())};
}

std::optional<Compound::Part> PartBounds::outer() const {
  if (exact_) return Compound::Part{*part_.shape, part_.pose};
  auto body = polytope_of_halfspaces(planes_);
  if (!body) return std::nullopt;
  return Compound::Part{*std::move(body), Pose::from_trusted_matrix(Mat3::Identity(), part_.pose.translation())};
}

}  // namespace pd::detail

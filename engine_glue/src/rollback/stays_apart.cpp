#include "rollback/stays_apart.hpp"

#include <algorithm>
#include <cmath>

namespace pd::detail {

namespace {

/// Hulls of more corners are left to queries.
constexpr int kMostCorners = 128;
/// Parts of the duration, at the most.
constexpr int kMostParts = 16;

/// The support of a core along a direction in its frame.
struct Support {
  const Vec3& d;

  double operator()(const ConvexPolytope& core) const {
    if (core.num_vertices() > kMostCorners) return HUGE_VAL;
    double most = -HUGE_VAL;
    for (int v = 0; v < core.num_vertices(); ++v) most = std::max(most, core.vertex(v).dot(d));
    return most;
  }
  double operator()(const Ellipsoid& core) const { return core.radii.cwiseProduct(d).norm(); }
  double operator()(const Cylinder& core) const {
    return core.radius * across(core.axis) + core.half_height * std::abs(d[core.axis]);
  }
  double operator()(const Cone& core) const {
    return std::max(core.half_height * d[core.axis], core.radius * across(core.axis) - core.half_height * d[core.axis]);
  }
  double operator()(const SphereHull& core) const {
    double most = -HUGE_VAL;
    for (const Sphere& sphere : core.spheres()) most = std::max(most, sphere.centre.dot(d) + sphere.radius * d.norm());
    return most;
  }

 private:
  [[nodiscard]] double across(int axis) const { return std::hypot(d[(axis + 1) % 3], d[(axis + 2) % 3]); }
};

}  // namespace

double apart_along(const Level& direction, const ConvexShape& shape, const Pose& pose) {
  const Vec3 local = -(pose.rotation().transpose() * direction.normal);
  const double support = std::visit(Support{local}, shape.core()) + shape.margin() * local.norm();
  return direction.normal.dot(pose.translation()) - support - direction.level;
}

bool stays_apart(const Level& direction, const MovingShape& body, double radius, double least, double duration) {
  const auto at = [&](double time) { return apart_along(direction, *body.start.shape, pose_at(body, time)); };
  const double first = at(0), last = at(duration);
  if (!(first >= least && last >= least)) return false;
  const double turn = body.motion.angular_velocity.norm() * duration;
  const double bulge = turn * turn * (body.arm.norm() + radius) / 8;
  for (int parts = 1; parts <= kMostParts; parts *= 2) {
    double lowest = std::min(first, last);
    for (int k = 1; k < parts && lowest >= least; ++k) lowest = std::min(lowest, at(duration * k / parts));
    if (lowest < least) return false;
    if (lowest - bulge / (parts * parts) >= least) return true;
  }
  return false;
}

}  // namespace pd::detail

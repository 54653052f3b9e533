#include "pd/contact/stays_apart.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "depth/difference/smooth_difference.hpp"

namespace pd {

namespace {

/// The point of a core that is the farthest along a direction of its frame; NaN if the direction is.
Vec3 farthest(const MovingShape& body, const Vec3& local) {
  if (!local.allFinite()) return Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
  return detail::support_point(body.start.shape->core(), local);
}

}  // namespace

StaysApart::StaysApart(const MovingShape& body, double duration)
    : body_(body),
      duration_(duration),
      bulge_(curvature_bound(body) * duration * duration / 8),
      normal_(Vec3::Constant(std::numeric_limits<double>::quiet_NaN())) {
  const ConvexShape& shape = *body.start.shape;
  for (int axis = 0; axis < 3; ++axis) {
    upper_[axis] = farthest(body, Vec3::Unit(axis))[axis] + shape.margin();
    lower_[axis] = farthest(body, -Vec3::Unit(axis))[axis] - shape.margin();
  }
}

const Pose& StaysApart::pose(int sixteenths) {
  const auto k = static_cast<std::size_t>(sixteenths);
  if (!posed_[k]) {
    poses_[k] = pose_at(body_, duration_ * sixteenths / kMostParts);
    posed_[k] = true;
  }
  return poses_[k];
}

void StaysApart::turn_to(const Vec3& normal) {
  if (normal == normal_) return;
  normal_ = normal;
  heights_.fill(std::numeric_limits<double>::quiet_NaN());
}

double StaysApart::height(int sixteenths) {
  const auto k = static_cast<std::size_t>(sixteenths);
  if (!std::isnan(heights_[k])) return heights_[k];
  const Pose& then = pose(sixteenths);
  const ConvexShape& shape = *body_.start.shape;
  const Vec3 local = -(then.rotation().transpose() * normal_);
  const double apart =
      normal_.dot(then.translation()) - farthest(body_, local).dot(local) - shape.margin() * local.norm();
  heights_[k] = std::isnan(apart) ? -HUGE_VAL : apart;
  return heights_[k];
}

double StaysApart::at_start(const SupportLevel& direction) {
  turn_to(direction.normal);
  return height(0) - direction.level;
}

Vec3 StaysApart::first_along(const Vec3& direction) const {
  const Pose& start = body_.start.pose;
  const Vec3 local = -(start.rotation().transpose() * direction);
  return start.apply(farthest(body_, local));
}

bool StaysApart::proved(const SupportLevel& direction, double least) {
  turn_to(direction.normal);
  const double needed = direction.level + least;
  const double ends = std::min(height(0), height(kMostParts));
  if (!(ends >= needed)) return false;
  double lowest = ends;
  for (int parts = 1; parts <= kMostParts; parts *= 2) {
    const int step = kMostParts / parts;
    for (int k = step; k < kMostParts && lowest >= needed; k += 2 * step) lowest = std::min(lowest, height(k));
    if (lowest < needed) return false;
    if (lowest - bulge_ / (parts * parts) >= needed) return true;
  }
  return false;
}

StaysApart::Faces StaysApart::beside(const StillTriangle& triangle, int sixteenths) {
  const Pose& then = pose(sixteenths);
  Faces apart;
  apart.fill(HUGE_VAL);
  for (const Vec3& corner : triangle.corners) {
    const Vec3 local = then.rotation().transpose() * (corner - then.translation());
    for (int axis = 0; axis < 3; ++axis) {
      const auto face = static_cast<std::size_t>(2 * axis);
      apart[face] = std::min(apart[face], local[axis] - upper_[axis] - triangle.margin);
      apart[face + 1] = std::min(apart[face + 1], lower_[axis] - local[axis] - triangle.margin);
    }
  }
  return apart;
}

double StaysApart::beside_at_start(const StillTriangle& triangle) {
  const Faces apart = beside(triangle, 0);
  return *std::max_element(apart.begin(), apart.end());
}

bool StaysApart::proved_beside(const StillTriangle& triangle, double least) {
  const Faces first = beside(triangle, 0), last = beside(triangle, kMostParts);
  std::size_t face = 0;
  const auto ends = [&](std::size_t k) { return std::min(first[k], last[k]); };
  for (std::size_t k = 1; k < first.size(); ++k) {
    if (ends(k) > ends(face)) face = k;
  }
  if (!(ends(face) >= least)) return false;
  const Vec3 pivot = body_.start.pose.translation() - body_.arm;
  const double way = body_.motion.linear_velocity.norm() * duration_;
  const double turn = body_.motion.angular_velocity.norm() * duration_;
  double far = way;
  for (const Vec3& corner : triangle.corners) far = std::max(far, (corner - pivot).norm() + way);
  const double bulge = turn * (2 * way + turn * far) / 8;
  double lowest = ends(face);
  for (int parts = 1; parts <= kMostParts; parts *= 2) {
    const int step = kMostParts / parts;
    for (int k = step; k < kMostParts && lowest >= least; k += 2 * step) {
      lowest = std::min(lowest, beside(triangle, k)[face]);
    }
    if (lowest < least) return false;
    if (lowest - bulge / (parts * parts) >= least) return true;
  }
  return false;
}

}  // namespace pd

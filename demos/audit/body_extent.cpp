#include "audit/body_extent.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pd::audit {

namespace {

struct SupportOfCore {
  Vec3 direction;  ///< in the core's frame

  double operator()(const ConvexPolytope& polytope) const {
    double most = -std::numeric_limits<double>::infinity();
    for (int v = 0; v < polytope.num_vertices(); ++v) most = std::max(most, polytope.vertex(v).dot(direction));
    return most;
  }
  double operator()(const Ellipsoid& ellipsoid) const { return ellipsoid.radii.cwiseProduct(direction).stableNorm(); }
  double operator()(const Cylinder& cylinder) const {
    return cylinder.half_height * std::abs(direction[cylinder.axis]) + cylinder.radius * across(cylinder.axis);
  }
  double operator()(const Cone& cone) const {
    const double along = cone.half_height * direction[cone.axis];
    return std::max(along, cone.radius * across(cone.axis) - along);
  }
  double operator()(const SphereHull& hull) const { return hull.support(direction).dot(direction); }

 private:
  [[nodiscard]] double across(int axis) const {
    return std::hypot(direction[(axis + 1) % 3], direction[(axis + 2) % 3]);
  }
};

/// Grows the box by the body turned by `rotation` and moved by `at`.
void enclose(const ConvexPolytope& polytope, double margin, const Mat3& rotation, const Vec3& at, Box& box) {
  const Vec3 sweep = Vec3::Constant(margin);
  for (int v = 0; v < polytope.num_vertices(); ++v) {
    const Vec3 p = rotation * polytope.vertex(v) + at;
    box.low = box.low.cwiseMin(p - sweep);
    box.high = box.high.cwiseMax(p + sweep);
  }
}

}  // namespace

double turned_support(const ConvexShape& shape, const Pose& pose, const Vec3& direction) {
  const Mat3 rotation = shape.polytope() != nullptr ? pose.rotation() : pose.nearest_rotation();
  return std::visit(SupportOfCore{rotation.transpose() * direction}, shape.core()) +
         shape.margin() * direction.stableNorm();
}

double turned_support(const Compound& body, const Pose& pose, const Vec3& direction) {
  const Vec3 local = pose.rotation().transpose() * direction;
  double most = -std::numeric_limits<double>::infinity();
  for (const Compound::Part& part : body.parts()) {
    // Rotations are rotations up to 1e-6: turning the direction twice is as good as turning the body.
    const double core = part.pose == Pose() ? turned_support(part.shape, pose, direction)
                                            : turned_support(part.shape, part.pose, local);
    most = std::max(most, core + part.pose.translation().dot(local));
  }
  return most;
}

Box bounding_box(const Compound& body, const Pose& pose) {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  Box box{Vec3::Constant(kFar), Vec3::Constant(-kFar)};
  for (const Compound::Part& part : body.parts()) {
    if (const ConvexPolytope* polytope = part.shape.polytope()) {
      enclose(*polytope, part.shape.margin(), pose.rotation() * part.pose.rotation(),
              pose.rotation() * part.pose.translation(), box);
      continue;
    }
    const Mat3 turned = pose.rotation() * part.pose.rotation();
    const Pose both = Pose::from_trusted_matrix(turned, Vec3::Zero());
    const Vec3 at = pose.rotation() * part.pose.translation();
    for (int i = 0; i < 3; ++i) {
      box.high[i] = std::max(box.high[i], at[i] + turned_support(part.shape, both, Vec3::Unit(i)));
      box.low[i] = std::min(box.low[i], at[i] - turned_support(part.shape, both, -Vec3::Unit(i)));
    }
  }
  return box;
}

}  // namespace pd::audit

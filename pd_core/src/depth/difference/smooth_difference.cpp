#include "depth/difference/smooth_difference.hpp"

#include <algorithm>
#include <cmath>

#include "shape/core_radius.hpp"

namespace pd::detail {

namespace {

struct SupportOf {
  Vec3 direction;

  Vec3 operator()(const ConvexPolytope& p) const { return p.vertex(support_vertex(p, direction, -1)); }

  /// Gradient of the support function |diag(radii) n|.
  Vec3 operator()(const Ellipsoid& e) const {
    const Vec3 scaled = e.radii.cwiseProduct(direction);
    const double length = scaled.norm();
    return length > 0 ? Vec3(e.radii.cwiseProduct(scaled) / length) : Vec3(e.radii.x(), 0, 0);
  }
  Vec3 operator()(const Cylinder& c) const {
    Vec3 p = rim(c.radius, c.axis);
    p[c.axis] = direction[c.axis] < 0 ? -c.half_height : c.half_height;
    return p;
  }
  /// The apex unless the rim of the base reaches farther.
  Vec3 operator()(const Cone& c) const {
    Vec3 base = rim(c.radius, c.axis);
    base[c.axis] = -c.half_height;
    Vec3 apex = Vec3::Zero();
    apex[c.axis] = c.half_height;
    return base.dot(direction) > apex.dot(direction) ? base : apex;
  }
  Vec3 operator()(const SphereHull& hull) const { return hull.support(direction); }

 private:
  /// The point of the circle about the axis that reaches farthest; the axis itself where the direction runs along it.
  Vec3 rim(double radius, int axis) const {
    Vec3 across = direction;
    across[axis] = 0;
    const double length = across.norm();
    return length > 0 ? Vec3(across * (radius / length)) : Vec3(Vec3::Zero());
  }
};

/// A point inside the core.
struct CentreOf {
  Vec3 operator()(const ConvexPolytope& p) const { return p.centre(); }
  Vec3 operator()(const SphereHull& hull) const { return largest_sphere(hull).centre; }
  template <class Round>
  Vec3 operator()(const Round& /*about its origin*/) const {
    return Vec3::Zero();
  }
};

}  // namespace

const Sphere& largest_sphere(const SphereHull& hull) {
  const auto thinner = [](const Sphere& x, const Sphere& y) { return x.radius < y.radius; };
  return *std::max_element(hull.spheres().begin(), hull.spheres().end(), thinner);
}

Vec3 support_point(const ConvexShape::Core& core, const Vec3& direction) {
  return std::visit(SupportOf{direction}, core);
}

double rolling_radius(const ConvexShape::Core& core) {
  const auto* ellipsoid = std::get_if<Ellipsoid>(&core);
  if (ellipsoid == nullptr) return 0;
  const double least = ellipsoid->radii.minCoeff();
  return least * (least / ellipsoid->radii.maxCoeff()) * (1 - 4 * kUnitRoundoff);
}

SmoothDifference::Body SmoothDifference::body(const PosedShape& posed, Rolling rolling) {
  const ConvexShape::Core& core = posed.shape->core();
  const ConvexPolytope* polytope = posed.shape->polytope();
  return {&core, polytope ? posed.pose.rotation() : posed.pose.nearest_rotation(), std::visit(CentreOf{}, core),
          core_radius(core), rolling == Rolling::taken_out ? rolling_radius(core) : 0.0};
}

SmoothDifference::SmoothDifference(const PosedShape& a, const PosedShape& b, std::vector<PointPair>& points,
                                   Rolling rolling)
    : a_(body(a, rolling)),
      b_(body(b, rolling)),
      offset_(b.pose.translation() - a.pose.translation()),
      reach_(a_.radius + b_.radius + offset_.norm()),
      point_error_(32 * kUnitRoundoff * reach_ + 8 * kUnitRoundoff * (a_.taken_out + b_.taken_out)),
      points_(points) {
  points_.clear();
}

SmoothDifference SmoothDifference::moved(const Vec3& way) const {
  SmoothDifference there = *this;
  const double length = way.norm();
  there.offset_ -= way;
  there.reach_ += length;
  there.point_error_ += 32 * kUnitRoundoff * length;
  return there;
}

DifferenceVertex SmoothDifference::support(const Vec3& direction, const DifferenceVertex*) const {
  return vertex(support_of_rest(a_, -(a_.rotation.transpose() * direction)),
                support_of_rest(b_, b_.rotation.transpose() * direction));
}

Vec3 SmoothDifference::support_of_rest(const Body& body, const Vec3& direction) {
  const Vec3 point = support_point(*body.core, direction);
  if (body.taken_out == 0) return point;
  const double length = direction.norm();
  return length > 0 ? Vec3(point - (body.taken_out / length) * direction) : Vec3(Vec3::Zero());
}

DifferenceVertex SmoothDifference::vertex(const Vec3& local_a, const Vec3& local_b) const {
  const Vec3 pa = a_.rotation * local_a;
  const Vec3 pb = b_.rotation * local_b + offset_;
  points_.push_back({pa, pb, local_a, local_b});
  const auto index = static_cast<std::int32_t>(points_.size() - 1);
  return {pb - pa, index, index};
}

Vec3 SmoothDifference::centre() const { return b_.rotation * b_.centre - a_.rotation * a_.centre + offset_; }

}  // namespace pd::detail

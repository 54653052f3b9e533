#include "depth/pair/scaled_shape.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "shape/core_radius.hpp"
#include "shape/hull/polytope_storage.hpp"

namespace pd::detail {

namespace {

/// Between 2^-kRoom and 2^kRoom eighth powers of the size are ordinary numbers.
constexpr int kRoom = 100;

struct Size {
  double operator()(const ConvexPolytope& p) const { return p.radius(); }
  double operator()(const Ellipsoid& e) const { return e.radii.maxCoeff(); }
  double operator()(const Cylinder& c) const { return std::max(c.radius, c.half_height); }
  double operator()(const Cone& c) const { return std::max(c.radius, c.half_height); }
  double operator()(const SphereHull& hull) const { return core_radius(hull); }
};

double curved(double size, int exponent) { return std::max(std::ldexp(size, exponent), kMinCurvedSize); }

struct Scaled {
  int exponent;

  ConvexShape operator()(const ConvexPolytope& p) const {
    if (auto exact = scaled_exactly(p.storage(), exponent)) return ConvexPolytope(std::move(exact));
    std::vector<Vec3> points;
    for (int v = 0; v < p.num_vertices(); ++v) {
      const Vec3 x = p.vertex(v);
      points.emplace_back(std::ldexp(x.x(), exponent), std::ldexp(x.y(), exponent), std::ldexp(x.z(), exponent));
    }
    return *ConvexPolytope::from_points(points);
  }
  ConvexShape operator()(const Ellipsoid& e) const {
    return *ConvexShape::ellipsoid(
        {curved(e.radii.x(), exponent), curved(e.radii.y(), exponent), curved(e.radii.z(), exponent)});
  }
  ConvexShape operator()(const Cylinder& c) const {
    return *ConvexShape::cylinder(curved(c.radius, exponent), curved(c.half_height, exponent), c.axis);
  }
  ConvexShape operator()(const Cone& c) const {
    return *ConvexShape::cone(curved(c.radius, exponent), curved(c.half_height, exponent), c.axis);
  }
  ConvexShape operator()(const SphereHull& hull) const {
    std::vector<Sphere> spheres;
    const auto raised = [&](double x) { return std::abs(x) < kMinCurvedSize ? 0.0 : x; };
    for (const Sphere& s : hull.spheres()) {
      const Vec3 centre = times_power(s.centre, exponent);
      spheres.push_back({centre.unaryExpr(raised), raised(std::ldexp(s.radius, exponent))});
    }
    return *ConvexShape::hull_of_spheres(spheres);
  }
};

}  // namespace

int extreme_exponent(const PosedShape& a, const PosedShape& b) {
  const double bodies = std::max(
      {std::visit(Size{}, a.shape->core()), std::visit(Size{}, b.shape->core()), a.shape->margin(), b.shape->margin()});
  const double size = std::max(bodies, (b.pose.translation() - a.pose.translation()).cwiseAbs().maxCoeff());
  if (!(size > 0)) return 0;
  const int exponent = std::ilogb(size);
  return std::abs(exponent) > kRoom ? exponent : 0;
}

ConvexShape scaled(const ConvexShape& shape, int exponent) {
  const ConvexShape core = std::visit(Scaled{exponent}, shape.core());
  return *core.with_margin(std::ldexp(shape.margin(), exponent));
}

ScaledPair::ScaledPair(const PosedShape& a, const PosedShape& b, int exponent)
    : a_(scaled(*a.shape, -exponent)),
      b_(scaled(*b.shape, -exponent)),
      pose_a_(Pose::from_trusted_matrix(a.pose.rotation(), Vec3::Zero())),
      pose_b_(Pose::from_trusted_matrix(b.pose.rotation(),
                                        times_power(b.pose.translation() - a.pose.translation(), -exponent))) {}

Vec3 times_power(const Vec3& v, int exponent) {
  return {std::ldexp(v.x(), exponent), std::ldexp(v.y(), exponent), std::ldexp(v.z(), exponent)};
}

double times_power_down(double x, int exponent) {
  const double scaled = std::ldexp(x, exponent);
  return std::ldexp(scaled, -exponent) > x ? std::nextafter(scaled, 0.0) : scaled;
}

double times_power_up(double x, int exponent) {
  const double scaled = std::ldexp(x, exponent);
  return std::ldexp(scaled, -exponent) < x ? std::nextafter(scaled, HUGE_VAL) : scaled;
}

void scale_answer(PenetrationDepth& answer, int exponent) {
  answer.lower = times_power_down(answer.lower, exponent);
  answer.distance_lower = times_power_down(answer.distance_lower, exponent);
  for (double* x : {&answer.depth, &answer.upper, &answer.distance, &answer.distance_upper}) {
    *x = times_power_up(*x, exponent);
  }
  for (Vec3* v : {&answer.translation, &answer.witness_a, &answer.witness_b}) *v = times_power(*v, exponent);
}

}  // namespace pd::detail

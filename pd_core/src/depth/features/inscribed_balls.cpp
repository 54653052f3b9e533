#include "depth/features/inscribed_balls.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "depth/features/point_in_ellipsoid.hpp"
#include "depth/features/point_in_revolution.hpp"

namespace pd::detail {

namespace {

struct Ball {
  Vec3 centre = Vec3::Zero();
  double radius = -1;  ///< negative: none at hand
};

struct InscribedBall {
  Ball operator()(const ConvexPolytope& p) const { return p.num_vertices() == 1 ? Ball{p.vertex(0), 0} : Ball{}; }
  Ball operator()(const Ellipsoid& e) const { return {Vec3::Zero(), e.radii.minCoeff()}; }
  Ball operator()(const Cylinder& c) const { return {Vec3::Zero(), std::min(c.radius, c.half_height)}; }
  /// It touches the base and the mantle: r h / (r + sqrt(r^2 + h^2)) for the radius r and the height h.
  Ball operator()(const Cone& c) const {
    const double height = 2 * c.half_height;
    const double slant = std::sqrt(c.radius * c.radius + height * height);
    Ball ball;
    ball.radius = c.radius * (height / (c.radius + slant));
    ball.centre[c.axis] = ball.radius - c.half_height;
    return ball;
  }
  /// The largest of the spheres, which need not be the largest ball.
  Ball operator()(const SphereHull& hull) const {
    const Sphere& sphere = largest_sphere(hull);
    return {sphere.centre, sphere.radius};
  }
};

int axis_of_revolution(const ConvexShape::Core& core) {
  if (const auto* cylinder = std::get_if<Cylinder>(&core)) return cylinder->axis;
  if (const auto* cone = std::get_if<Cone>(&core)) return cone->axis;
  return -1;
}

}  // namespace

std::optional<InscribedBallsDepth> inscribed_balls_depth(const PosedShape& a, const PosedShape& b,
                                                         const SmoothDifference& difference,
                                                         std::int64_t& support_calls) {
  const Ball ball_a = std::visit(InscribedBall{}, a.shape->core());
  const Ball ball_b = std::visit(InscribedBall{}, b.shape->core());
  if (ball_a.radius < 0 || ball_b.radius < 0) return std::nullopt;
  const Mat3 rotation_a = a.shape->polytope() ? a.pose.rotation() : a.pose.nearest_rotation();
  const Mat3 rotation_b = b.shape->polytope() ? b.pose.rotation() : b.pose.nearest_rotation();
  const Vec3 centre_a = rotation_a * ball_a.centre;
  const Vec3 centre_b = rotation_b * ball_b.centre + (b.pose.translation() - a.pose.translation());
  const Vec3 apart = centre_b - centre_a;
  InscribedBallsDepth out;
  // The centres err as points do, the radii by the rounding of their formula.
  out.lower = ball_a.radius + ball_b.radius - apart.norm() - difference.point_error();
  if (!(out.lower > 0)) return std::nullopt;
  out.lower -= difference.taken_out(0) + difference.taken_out(1);
  out.upper = std::numeric_limits<double>::infinity();
  const double error = support_plane_error(difference);
  const auto try_along = [&](const Vec3& direction) {
    const double length = direction.norm();
    if (!(length > 0)) return;
    const Vec3 unit = direction / length;
    ++support_calls;
    const double height = difference.support(unit, nullptr).x.dot(unit) + error;
    if (height < out.upper) {
      out.upper = height;
      out.normal = unit;
    }
  };
  // The origin is nearest to the boundary on the side away from the centre of P's ball.
  try_along(-apart);
  for (const Mat3* rotation : {&rotation_a, &rotation_b}) {
    for (int axis = 0; axis < 3; ++axis) {
      try_along(rotation->col(axis));
      try_along(-rotation->col(axis));
    }
  }
  const int axis_a = axis_of_revolution(a.shape->core()), axis_b = axis_of_revolution(b.shape->core());
  if (axis_a >= 0 && axis_b >= 0) {
    const Vec3 across = rotation_a.col(axis_a).cross(rotation_b.col(axis_b));
    try_along(across);
    try_along(-across);
  }
  out.lower = std::min(out.lower, out.upper);
  out.on_a = centre_a - ball_a.radius * out.normal;
  out.on_b = centre_b + ball_b.radius * out.normal;
  return out;
}

namespace {

/// Farther from a ball, the search that the ball would spare is short.
constexpr double kMaxBallRatio = 1 + 1e-4;

/// The ball around a point of a core that lies in it, in the core's frame; nothing where the point is not inside.
struct BallInCore {
  Vec3 point;

  std::optional<PointInCore> operator()(const ConvexPolytope& /*polytope*/) const { return std::nullopt; }
  std::optional<PointInCore> operator()(const SphereHull& /*no closed form*/) const { return std::nullopt; }
  std::optional<PointInCore> operator()(const Ellipsoid& e) const {
    if (!(point.cwiseQuotient(e.radii).squaredNorm() < 1)) return std::nullopt;
    const PointInEllipsoid found = point_in_ellipsoid(e.radii, point);
    return PointInCore{found.lower, found.outward, support_point(e, found.outward)};
  }
  std::optional<PointInCore> operator()(const Cylinder& c) const { return point_in_cylinder(c, point); }
  std::optional<PointInCore> operator()(const Cone& c) const { return point_in_cone(c, point); }
};

std::optional<InscribedBallsDepth> ball_of_one_in_other(const PosedShape& inner, const PosedShape& outer,
                                                        bool outer_is_a, const SmoothDifference& difference) {
  if (outer.shape->polytope() != nullptr) return std::nullopt;
  const auto* round = std::get_if<Ellipsoid>(&inner.shape->core());
  if (round != nullptr && round->radii.maxCoeff() > kMaxBallRatio * round->radii.minCoeff()) return std::nullopt;
  if (round == nullptr && (inner.shape->polytope() == nullptr || inner.shape->polytope()->num_vertices() > 1)) {
    return std::nullopt;
  }
  const Ball ball = std::visit(InscribedBall{}, inner.shape->core());
  const Mat3 turn_inner = inner.shape->polytope() ? inner.pose.rotation() : inner.pose.nearest_rotation();
  const Mat3 turn_outer = outer.pose.nearest_rotation();
  const Vec3 offset = inner.pose.translation() - outer.pose.translation();
  const Vec3 local = turn_outer.transpose() * (turn_inner * ball.centre + offset);
  const std::optional<PointInCore> found = std::visit(BallInCore{local}, outer.shape->core());
  if (!found) return std::nullopt;
  const Vec3 outward = turn_outer * found->outward;
  const double length = outward.norm();
  if (!(found->lower > 0) || !(length > 0)) return std::nullopt;
  InscribedBallsDepth out;
  out.normal = outward / (outer_is_a ? -length : length);
  // The centre errs as points do.
  out.lower = ball.radius + found->lower - difference.point_error() - difference.taken_out(0) - difference.taken_out(1);
  out.upper = difference.support(out.normal, nullptr).x.dot(out.normal) + support_plane_error(difference);
  out.lower = std::min(out.lower, out.upper);
  const Vec3 centre = turn_inner * ball.centre;
  const Vec3 surface = turn_outer * found->surface;
  const Vec3 between = outer_is_a ? offset : Vec3(-offset);  // t_B - t_A
  out.on_a = outer_is_a ? surface : Vec3(centre - ball.radius * out.normal);
  out.on_b = between + (outer_is_a ? Vec3(centre + ball.radius * out.normal) : surface);
  return out;
}

}  // namespace

std::optional<InscribedBallsDepth> ball_in_core_depth(const PosedShape& a, const PosedShape& b,
                                                      const SmoothDifference& difference, std::int64_t& support_calls) {
  std::optional<InscribedBallsDepth> in_a = ball_of_one_in_other(b, a, true, difference);
  std::optional<InscribedBallsDepth> in_b = ball_of_one_in_other(a, b, false, difference);
  support_calls += (in_a ? 1 : 0) + (in_b ? 1 : 0);
  if (!in_a || !in_b) return in_a ? in_a : in_b;
  return in_a->upper - in_a->lower <= in_b->upper - in_b->lower ? in_a : in_b;
}

}  // namespace pd::detail

#include "pd/depth/difference_queries.hpp"

#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "depth/certificate/exact_answer.hpp"
#include "depth/difference/direction_signs.hpp"
#include "depth/difference/exact_support.hpp"
#include "depth/difference/smooth_difference.hpp"
#include "depth/expansion/exact_expanding_polytope.hpp"
#include "depth/pair/scaled_shape.hpp"
#include "depth/rays/portal.hpp"
#include "depth/rays/ray_shooting.hpp"
#include "numeric/floating_point_guard.hpp"
#include "numeric/length.hpp"
#include "numeric/root_sum.hpp"
#include "numeric/unit_roundoff.hpp"
#include "pd/depth/scratch.hpp"
#include "shape/refused_vector.hpp"

namespace pd {

namespace {

using detail::Dyadic;
using detail::Dyadic3;
using detail::PairVector;
using detail::PosedPair;

DifferenceSupport polytope_support(const ConvexPolytope& a, const Pose& pose_a, const ConvexPolytope& b,
                                   const Pose& pose_b, double margin, const Vec3& direction) {
  const PosedPair pair(a, pose_a, b, pose_b);
  const detail::DirectionSigns signs(pair, direction);
  const auto sign = [&](const PairVector& edge) { return signs.along(edge); };
  const detail::VertexPair found = support_exactly(pair, {signs.scaled(), 0}, {-1, -1}, sign);
  std::vector<std::int32_t> stack;
  DifferenceSupport support;
  support.vertex_a = detail::lowest_of_face(
      a, found.a, [&](int from, int to) { return sign(PairVector::edge_a(from, to)); }, stack);
  support.vertex_b = detail::lowest_of_face(
      b, found.b, [&](int from, int to) { return sign(PairVector::edge_b(from, to)); }, stack);
  // Largest exponents kept in range by the scaled direction; the product may still exceed the range of doubles.
  const detail::Vec3DD x = pair.approximate_dd(PairVector::point(support.vertex_a, support.vertex_b));
  const Vec3& d = signs.scaled();
  const detail::DoubleDouble product = x.x * d.x() + x.y * d.y() + x.z * d.z();
  const int exponent = std::ilogb(direction.cwiseAbs().maxCoeff());
  support.value = std::ldexp(detail::to_double(product), exponent + pair.scale_exponent());
  if (margin > 0) support.value += margin * detail::length(direction);
  return support;
}

/// max <R x + t, n> of a core, with a vertex where it has any.
double smooth_support(const PosedShape& body, const Vec3& n, std::int32_t& vertex) {
  if (const ConvexPolytope* polytope = body.shape->polytope()) {
    vertex = detail::support_vertex(*polytope, body.pose.rotation().transpose() * n, -1);
    return body.pose.apply(polytope->vertex(vertex)).dot(n);
  }
  const Mat3 rotation = body.pose.nearest_rotation();
  const Vec3 local = detail::support_point(body.shape->core(), rotation.transpose() * n);
  return (rotation * local + body.pose.translation()).dot(n);
}

/// x + y where the sum is a triple of doubles that a pose may hold.
std::optional<Vec3> exact_sum(const Vec3& x, const Vec3& y) {
  Vec3 sum;
  for (int i = 0; i < 3; ++i) {
    const detail::DoubleDouble s = detail::two_sum(x[i], y[i]);
    if (s.lo != 0 || !(std::abs(s.hi) <= kMaxCoordinate)) return std::nullopt;
    sum[i] = s.hi;
  }
  return sum;
}

/// The pose with another translation. Requires one within kMaxCoordinate.
Pose moved(const Pose& pose, const Vec3& translation) {
  if (pose.is_quaternion()) return *Pose::from_quaternion(pose.quaternion_wxyz(), translation);
  return Pose::from_trusted_matrix(pose.rotation(), translation);
}

ContactClass exact_class(const PosedShape& a, const PosedShape& b, const Vec3& point) {
  const PosedPair pair(*a.shape->polytope(), a.pose, *b.shape->polytope(), b.pose, point);
  const detail::VertexPair start{0, 0};
  const detail::ExactClosestPoint nearest = exact_closest_point(pair, &start, 1);
  const detail::Margins margins{a.shape->margin(), b.shape->margin()};
  const bool rounded = margins.a > 0 || margins.b > 0;
  if (nearest.apart) {
    if (!rounded) return ContactClass::separated;
    PenetrationDepth answer;
    answer_separated(pair, nearest, margins, answer);
    return answer.contact;
  }
  if (rounded) return ContactClass::overlapping;
  return exact_expanding_polytope(pair, nearest.simplex.data(), nearest.count, std::numeric_limits<int>::max()).contact;
}

}  // namespace

Expected<DifferenceSupport> support_of_difference(const PosedShape& a, const PosedShape& b, const Vec3& direction) {
  const detail::FloatingPointGuard guard;
  if (const auto error = detail::refuse_direction(direction)) return *error;
  const ConvexPolytope* const polytope_a = a.shape->polytope();
  const ConvexPolytope* const polytope_b = b.shape->polytope();
  const double margin = a.shape->margin() + b.shape->margin();
  if (polytope_a && polytope_b) {
    return polytope_support(*polytope_a, a.pose, *polytope_b, b.pose, margin, direction);
  }
  DifferenceSupport support;
  if (const int exponent = detail::extreme_exponent(a, b); exponent != 0) {
    const detail::ScaledPair near(a, b, exponent);
    support = *support_of_difference(near.a(), near.b(), direction);
    support.value = std::ldexp(support.value, exponent);
    return support;
  }
  const double scale = direction.cwiseAbs().maxCoeff();
  const Vec3 n = direction / scale;
  const double on_b = smooth_support(b, n, support.vertex_b);
  const double on_a = smooth_support(a, -n, support.vertex_a);
  support.value = (on_a + on_b + margin * n.norm()) * scale;
  return support;
}

Expected<ContactClass> point_in_difference(const PosedShape& a, const PosedShape& b, const Vec3& point,
                                           Scratch& scratch) {
  const detail::FloatingPointGuard guard;
  if (const auto error = detail::refuse_point(point)) return *error;
  // x lies in P where the origin lies in B + (-(A + x)).
  const std::optional<Vec3> exact = exact_sum(a.pose.translation(), point);
  const bool polytopes = a.shape->polytope() && b.shape->polytope();
  const Vec3 sum = exact ? *exact : Vec3(a.pose.translation() + point);
  if (sum.cwiseAbs().maxCoeff() <= kMaxCoordinate) {
    DepthSettings roughly;
    roughly.delta = 1;
    const PenetrationDepth answer = penetration_depth({a.shape, moved(a.pose, sum)}, b, scratch, roughly);
    if (exact || !polytopes) return answer.contact;
    // The move was rounded: the signed depth changes by at most as much.
    const double slack = 2 * detail::kUnitRoundoff * sum.cwiseAbs().sum();
    if (answer.contact == ContactClass::overlapping && answer.lower > slack) return answer.contact;
    if (answer.contact == ContactClass::separated && answer.distance_lower > slack) return answer.contact;
  } else if (!polytopes) {
    return Error{ErrorCode::out_of_range, "the point and the translation of a add up to more than 1e300", "point"};
  }
  return exact_class(a, b, point);
}

Expected<LineCrossing> line_in_difference(const PosedShape& a, const PosedShape& b, const Vec3& point,
                                          const Vec3& direction) {
  const detail::FloatingPointGuard guard;
  if (const auto error = detail::refuse_direction(direction)) return *error;
  if (const auto error = detail::refuse_point(point)) return *error;
  const ConvexPolytope* const polytope_a = a.shape->polytope();
  const ConvexPolytope* const polytope_b = b.shape->polytope();
  if (!polytope_a || !polytope_b || a.shape->margin() > 0 || b.shape->margin() > 0) {
    return Error{ErrorCode::unsupported, "lines are cut with the difference of polytopes without a margin", ""};
  }
  // Relative to the point, so that the line passes through the origin.
  const PosedPair pair(*polytope_a, a.pose, *polytope_b, b.pose, point);
  const double length = detail::length(direction);
  LineCrossing crossing;
  Dyadic levels[2], slopes[2];
  for (const double sense : {1.0, -1.0}) {
    const detail::DirectionSigns ray(pair, sense * direction);
    const std::optional<detail::Portal> portal = find_line_portal(ray);
    if (!portal) return LineCrossing();
    const auto& v = portal->corners;
    const auto to = [&](const detail::VertexPair& q) {
      return pair.exact(PairVector::difference(v[0].a, v[0].b, q.a, q.b));
    };
    const Dyadic3 normal = cross(to(v[1]), to(v[2]));
    const int side = sense > 0 ? 0 : 1;
    levels[side] = dot(pair.exact(PairVector::point(v[0].a, v[0].b)), normal);
    slopes[side] = dot(ray.exact(), normal);
    const double t = sense * length * detail::ratio(levels[side], slopes[side] * pair.homogeneous_factor());
    const double error = 0x1p-46 * std::abs(t);
    (sense > 0 ? crossing.leave_lower : crossing.enter_lower) = t - error;
    (sense > 0 ? crossing.leave_upper : crossing.enter_upper) = t + error;
  }
  // A flat P is left where it is entered.
  if ((levels[0] * slopes[1] + levels[1] * slopes[0]).sign() == 0) return LineCrossing();
  crossing.crosses = true;
  return crossing;
}

}  // namespace pd

/// @file
/// Queries of `pdepth.h` about one pair or one body.

#include <algorithm>
#include <cmath>

#include "c_interface/answers.hpp"
#include "c_interface/handles.hpp"
#include "c_interface/reading.hpp"
#include "depth/difference/smooth_difference.hpp"
#include "depth/pair/scaled_shape.hpp"
#include "numeric/length.hpp"
#include "pd/compound/compound_depth.hpp"
#include "pd/contact/time_of_impact.hpp"
#include "pd/depth/difference_queries.hpp"
#include "pd/depth/directional_depth.hpp"
#include "pd/depth/penetration_depth.hpp"
#include "pd/depth/width.hpp"

namespace pd::c_interface {

namespace {

/// Squares of speeds stay in the range of doubles.
constexpr double kMaxSpeed = 1e150;
/// Beyond about this many radians the rounding of an angle moves a body by 1e-9 of its size.
constexpr double kMaxAngle = 1e6;

pdepth_directional directional_of(const auto& answer, std::int32_t part_a, std::int32_t part_b) {
  pdepth_directional out{};
  out.size = sizeof out;
  require_finite(is_finite(answer));
  out.contact = static_cast<std::int32_t>(answer.contact);
  out.depth = answer.depth;
  out.lower = answer.lower;
  out.upper = answer.upper;
  write_vector(answer.normal, out.normal);
  out.feature_a = feature_of(answer.feature_a, part_a);
  out.feature_b = feature_of(answer.feature_b, part_b);
  return out;
}

pdepth_directional ask_directional(const Question& question, const Vec3& direction, Workspace& space) {
  if (question.is_convex()) {
    return directional_of(value_of(directional_depth(question.posed_a, question.posed_b, direction, space.scratch), ""),
                          0, 0);
  }
  const UnionDirectionalDepth found =
      value_of(directional_depth(PosedCompound{&question.a.whole("question.a"), question.posed_a.pose},
                                 PosedCompound{&question.b.whole("question.b"), question.posed_b.pose}, direction,
                                 space.scratch),
               "question");
  return directional_of(found, found.part_a, found.part_b);
}

MovingShape read_motion(const pdepth_motion& motion, const PosedShape& start, double duration, bool is_a) {
  MovingShape moving{
      start,
      {read_vector(motion.linear_velocity, is_a ? "movement.a.linear_velocity" : "movement.b.linear_velocity"),
       read_vector(motion.angular_velocity, is_a ? "movement.a.angular_velocity" : "movement.b.angular_velocity")},
      read_vector(motion.arm, is_a ? "movement.a.arm" : "movement.b.arm")};
  const char* const where = is_a ? "movement.a" : "movement.b";
  const double speed = moving.motion.linear_velocity.cwiseAbs().maxCoeff();
  const double turn = moving.motion.angular_velocity.cwiseAbs().maxCoeff();
  if (!(speed <= kMaxSpeed) || !(turn <= kMaxSpeed)) refuse(PDEPTH_OUT_OF_RANGE, "speeds go up to 1e150", where);
  const double reach = start.pose.translation().cwiseAbs().maxCoeff() + 2 * moving.arm.cwiseAbs().maxCoeff();
  if (!(speed * duration + 2 * reach <= kMaxCoordinate)) {
    refuse(PDEPTH_OUT_OF_RANGE, "within the duration the body moves past 1e300", where);
  }
  if (!(moving.motion.angular_velocity.stableNorm() * duration <= kMaxAngle)) {
    refuse(PDEPTH_OUT_OF_RANGE, "within the duration the body turns by more than 1e6 radians", where);
  }
  return moving;
}

TimeOfImpactSettings read_impact_settings(const pdepth_movement& movement, const DepthSettings& depth) {
  require_length(movement.duration, "movement.duration");
  require_length(movement.distance_tolerance, "movement.distance_tolerance");
  require_length(movement.allowed_depth, "movement.allowed_depth");
  if (movement.max_queries < 0) refuse(PDEPTH_BAD_VALUE, "must be 0 or more", "movement.max_queries");
  TimeOfImpactSettings settings;
  if (movement.distance_tolerance > 0) settings.distance_tolerance = movement.distance_tolerance;
  if (movement.max_queries > 0) settings.max_queries = movement.max_queries;
  settings.allowed_depth = movement.allowed_depth;
  settings.depth = depth;
  return settings;
}

/// The support of one convex body: that of its difference with the point at the origin.
pdepth_support_answer ask_support(const PosedShape& body, const Vec3& direction) {
  const PosedShape origin{&origin_shape(), Pose()};
  pdepth_support_answer out{};
  out.size = sizeof out;
  const DifferenceSupport found = value_of(support_of_difference(origin, body, direction), "");
  out.value = found.value;
  const ConvexPolytope* const polytope = body.shape->polytope();
  out.vertex = polytope == nullptr ? -1 : found.vertex_b;
  // Formulas of curved bodies square their sizes.
  const int exponent = polytope == nullptr ? detail::extreme_exponent(origin, body) : 0;
  if (exponent != 0) {
    const detail::ScaledPair near(origin, body, exponent);
    const pdepth_support_answer scaled = ask_support(near.b(), direction);
    for (int k = 0; k < 3; ++k) out.point[k] = std::ldexp(scaled.point[k], exponent);
    return out;
  }
  const Vec3 unit = detail::unit_vector(direction);
  const Mat3 rotation = polytope == nullptr ? body.pose.nearest_rotation() : body.pose.rotation();
  const Vec3 local = polytope == nullptr ? detail::support_point(body.shape->core(), rotation.transpose() * unit)
                                         : polytope->vertex(found.vertex_b);
  write_vector(rotation * local + body.pose.translation() + body.shape->margin() * unit, out.point);
  return out;
}

void require_finite_support(const pdepth_support_answer& answer) {
  const Vec3 point(answer.point[0], answer.point[1], answer.point[2]);
  require_finite(all_finite(answer.value, point));
}

}  // namespace

}  // namespace pd::c_interface

using namespace pd;               // NOLINT(google-build-using-namespace): the functions of C stand in no namespace
using namespace pd::c_interface;  // NOLINT(google-build-using-namespace)

pdepth_status pdepth_depth(pdepth_context* context, const pdepth_question* question, pdepth_answer* answer) {
  return at_border(context, [&] {
    pdepth_answer& out = answer_struct(answer, "answer");
    SettingsRoom room;
    ask_depth(read_question(question, room), workspace_of(*context), out);
  });
}

pdepth_status pdepth_apart(pdepth_context* context, const pdepth_question* question, double distance, int32_t* apart) {
  return at_border(context, [&] {
    given(apart, "apart");
    require_length(distance, "distance");
    SettingsRoom room;
    const Question read = read_question(question, room);
    Settings settings = read.settings;
    if (question->settings == nullptr) settings.depth.bracket = Bracket::contact;
    settings.depth.beyond = distance;
    pdepth_answer answer{};
    answer.size = sizeof answer;
    ask_depth({read.a, read.b, read.posed_a, read.posed_b, settings, read.pair}, workspace_of(*context), answer);
    *apart = answer.contact == PDEPTH_SEPARATED && answer.distance_lower > distance ? 1 : 0;
  });
}

pdepth_status pdepth_depth_along(pdepth_context* context, const pdepth_question* question, const double direction[3],
                                 pdepth_directional* answer) {
  return at_border(context, [&] {
    pdepth_directional& out = answer_struct(answer, "answer");
    SettingsRoom room;
    const Question read = read_question(question, room);
    write_answer(ask_directional(read, read_vector(direction, "direction"), workspace_of(*context)), out);
  });
}

pdepth_status pdepth_contact_manifold(pdepth_context* context, const pdepth_question* question,
                                      double breaking_threshold, pdepth_manifold* manifold) {
  return at_border(context, [&] {
    pdepth_manifold& out = answer_struct(manifold, "manifold");
    SettingsRoom room;
    ask_manifold(read_question(question, room), breaking_threshold, workspace_of(*context), out);
  });
}

pdepth_status pdepth_time_of_impact(pdepth_context* context, const pdepth_question* question,
                                    const pdepth_movement* movement, pdepth_impact* impact, pdepth_answer* contact) {
  return at_border(context, [&] {
    const pdepth_movement& moves = read_struct(movement, "movement");
    pdepth_impact& out = answer_struct(impact, "impact");
    if (contact != nullptr) answer_struct(contact, "contact");
    SettingsRoom room;
    const Question read = read_question(question, room);
    read.require_convex();
    require_supported(read);
    const TimeOfImpactSettings settings = read_impact_settings(moves, read.settings.depth);
    const TimeOfImpact found = time_of_impact(read_motion(moves.a, read.posed_a, moves.duration, true),
                                              read_motion(moves.b, read.posed_b, moves.duration, false), moves.duration,
                                              workspace_of(*context).scratch, settings);
    if (contact != nullptr) write_depth(found.contact, *contact);
    write_answer({sizeof out, found.hit ? 1 : 0, found.reached ? 1 : 0, found.queries, found.time, found.certified},
                 out);
  });
}

pdepth_status pdepth_depth_derivatives(pdepth_context* context, const pdepth_question* question,
                                       pdepth_derivatives* derivatives, pdepth_answer* answer) {
  return at_border(context, [&] {
    pdepth_derivatives& out = answer_struct(derivatives, "derivatives");
    if (answer != nullptr) answer_struct(answer, "answer");
    SettingsRoom room;
    ask_derivatives(read_question(question, room), workspace_of(*context), out, answer);
  });
}

pdepth_status pdepth_width(pdepth_context* context, const pdepth_shape* shape, const pdepth_pose* pose,
                           const pdepth_settings* settings, pdepth_width_answer* answer) {
  return at_border(context, [&] {
    pdepth_width_answer& out = answer_struct(answer, "answer");
    SettingsRoom room;
    const DepthSettings& read = read_settings(settings, room).depth;
    const Method method = read.method;
    if (method != Method::automatic && method != Method::overlay && method != Method::expansion &&
        method != Method::grid) {
      refuse(PDEPTH_UNSUPPORTED, "a width is found by the methods automatic, overlay, expansion and grid",
             "settings.method");
    }
    const ConvexShape* const body = given(shape, "shape").convex();
    if (body == nullptr) refuse(PDEPTH_UNSUPPORTED, "a width is that of a convex shape", "shape");
    const Width found = width({body, read_pose(pose, "pose")}, workspace_of(*context).scratch, method, read.delta);
    require_finite(all_finite(found.width, found.lower, found.upper, found.normal));
    pdepth_width_answer result{sizeof out, found.bracket_reached ? 1 : 0, found.width, found.lower, found.upper, {}};
    write_vector(found.normal, result.normal);
    write_answer(result, out);
  });
}

pdepth_status pdepth_support(pdepth_context* context, const pdepth_shape* shape, const pdepth_pose* pose,
                             const double direction[3], pdepth_support_answer* answer) {
  return at_border(context, [&] {
    pdepth_support_answer& out = answer_struct(answer, "answer");
    const pdepth_shape& body = given(shape, "shape");
    const Vec3 along = read_vector(direction, "direction");
    const Pose place = read_pose(pose, "pose");
    if (const ConvexShape* const convex = body.convex()) {
      const pdepth_support_answer found = ask_support({convex, place}, along);
      require_finite_support(found);
      write_answer(found, out);
      return;
    }
    const std::vector<PosedShape> parts = value_of(body.whole("shape").posed(place), "");
    pdepth_support_answer best{};
    for (std::size_t i = 0; i < parts.size(); ++i) {
      pdepth_support_answer found = ask_support(parts[i], along);
      found.part = static_cast<std::int32_t>(i);
      if (i == 0 || found.value > best.value) best = found;
    }
    require_finite_support(best);
    write_answer(best, out);
  });
}

/// @file
/// time_of_impact: when two moving bodies first touch; of compounds, the earliest of their pairs of parts.
#include <algorithm>
#include <utility>

#include "pd/compound/compound_depth.hpp"
#include "pd/contact/time_of_impact.hpp"
#include "protocol/body_reader.hpp"
#include "protocol/pair_reader.hpp"
#include "protocol/union_queries.hpp"

namespace pd::query {

namespace {

void allow_fields(const Node& line) {
  allow_only(line, {"id", "query", "a", "pose_a", "b", "pose_b", "velocity_a", "angular_velocity_a", "velocity_b",
                    "angular_velocity_b", "duration", "tolerance"});
}

/// Squares of speeds stay in the range of doubles.
constexpr double kMaxSpeed = 1e150;
/// Beyond about this many radians the rounding of an angle moves a body by 1e-9 of its size.
constexpr double kMaxAngle = 1e6;
/// The default tolerance, as a share of the two bodies' radii about their origins.
constexpr double kDefaultTolerance = 1e-9;

Vec3 read_velocity(const Node& line, std::string_view key) {
  const auto node = line.find(key);
  if (!node) return Vec3::Zero();
  const Vec3 velocity = read_vector(*node);
  if (!(velocity.cwiseAbs().maxCoeff() <= kMaxSpeed)) node->refuse("out_of_range", "speeds go up to 1e150");
  return velocity;
}

/// What the line says about the motion.
struct Motions {
  RigidMotion a;
  RigidMotion b;
  double duration = 0;
};

void require_in_range(const Node& line, const RigidMotion& motion, const Pose& pose, double duration) {
  const double way = motion.linear_velocity.cwiseAbs().maxCoeff() * duration;
  if (!(way + pose.translation().cwiseAbs().maxCoeff() <= kMaxCoordinate)) {
    line.at("duration").refuse("out_of_range", "within the duration a body moves past 1e300");
  }
  if (!(motion.angular_velocity.stableNorm() * duration <= kMaxAngle)) {
    line.at("duration").refuse("out_of_range", "within the duration a body turns by more than 1e6 radians");
  }
}

Motions read_motions(const Node& line, const Pose& pose_a, const Pose& pose_b) {
  Motions motions{{read_velocity(line, "velocity_a"), read_velocity(line, "angular_velocity_a")},
                  {read_velocity(line, "velocity_b"), read_velocity(line, "angular_velocity_b")},
                  0};
  const Node node = line.at("duration");
  motions.duration = read_number(node);
  if (motions.duration < 0) node.refuse("bad_value", "a duration must be 0 or greater");
  require_in_range(line, motions.a, pose_a, motions.duration);
  require_in_range(line, motions.b, pose_b, motions.duration);
  return motions;
}

double read_tolerance(const Node& line, double radius) {
  const auto node = line.find("tolerance");
  // Two points have no size of their own; any length serves that a double holds.
  if (!node) return radius > 0 ? kDefaultTolerance * radius : kDefaultTolerance;
  const double tolerance = read_number(*node);
  if (!(tolerance > 0)) node->refuse("bad_value", "a tolerance must be greater than 0");
  return tolerance;
}

void write_time(bool hit, double time, double certified, JsonWriter& answer) {
  answer.key("hit").boolean(hit);
  answer.key("time").number(time);
  answer.key("certified").number(certified);
}

double radius_of(std::span<const PosedShape> parts, const Pose& pose) {
  double radius = 0;
  for (const PosedShape& part : parts) {
    const Vec3 arm = part.pose.translation() - pose.translation();
    radius = std::max(radius, arm.stableNorm() + bounding_radius(*part.shape));
  }
  return radius;
}

std::vector<PosedShape> posed_or_refuse(const Compound& body, const Pose& pose, const Node& node) {
  auto parts = body.posed(pose);
  if (!parts) node.refuse(parts.error());
  return std::move(parts).value();
}

/// The earliest of all pairs of parts; `certified` holds for all of them.
TimeOfImpact earliest(const std::vector<PosedShape>& parts_a, const Pose& pose_a,
                      const std::vector<PosedShape>& parts_b, const Pose& pose_b, const Motions& motions,
                      Session& session, TimeOfImpactSettings settings) {
  settings.contact_at_end = false;
  TimeOfImpact first;
  first.time = first.certified = motions.duration;
  for (const PosedShape& a : parts_a) {
    for (const PosedShape& b : parts_b) {
      const TimeOfImpact found = time_of_impact({a, motions.a, a.pose.translation() - pose_a.translation()},
                                                {b, motions.b, b.pose.translation() - pose_b.translation()}, first.time,
                                                session.scratch, settings);
      if (!found.hit || (first.hit && found.time >= first.time)) continue;
      const double certified = std::min(first.certified, found.certified);
      first = found;
      first.certified = certified;
    }
  }
  return first;
}

/// A gap at the first contact was to be within the tolerance, and not to be known in proportion to itself.
void tell_reached(const TimeOfImpact& found, PenetrationDepth& contact) {
  const bool gap = found.hit && contact.contact != ContactClass::overlapping;
  contact.bracket_reached = found.reached && (gap || contact.bracket_reached);
}

}  // namespace

void answer_time_of_impact(const Node& line, Session& session, JsonWriter& answer) {
  allow_fields(line);
  const Pair pair = read_pair(line, session.limits);
  const Motions motions = read_motions(line, pair.pose_a, pair.pose_b);
  TimeOfImpactSettings settings;
  settings.distance_tolerance = read_tolerance(line, bounding_radius(pair.a.shape) + bounding_radius(pair.b.shape));
  const Stopwatch watch;
  TimeOfImpact found = time_of_impact({pair.posed_a(), motions.a}, {pair.posed_b(), motions.b}, motions.duration,
                                      session.scratch, settings);
  const std::int64_t nanoseconds = watch.nanoseconds();
  tell_reached(found, found.contact);
  write_time(found.hit, found.time, found.certified, answer);
  write_depth_answer(found.contact, pair.a, pair.b, nanoseconds, answer);
}

void answer_union_time_of_impact(const Node& line, Session& session, JsonWriter& answer) {
  allow_fields(line);
  const BodyPair pair = read_bodies(line, session.limits);
  const Motions motions = read_motions(line, pair.pose_a, pair.pose_b);
  const std::vector<PosedShape> parts_a = posed_or_refuse(pair.a.compound, pair.pose_a, line.at("a"));
  const std::vector<PosedShape> parts_b = posed_or_refuse(pair.b.compound, pair.pose_b, line.at("b"));
  TimeOfImpactSettings settings;
  settings.distance_tolerance = read_tolerance(line, radius_of(parts_a, pair.pose_a) + radius_of(parts_b, pair.pose_b));
  const Stopwatch watch;
  const TimeOfImpact found = earliest(parts_a, pair.pose_a, parts_b, pair.pose_b, motions, session, settings);
  // A pose is all of a shape that a motion moves, so that any part's shape serves to move a body.
  const Pose pose_a = pose_at({{parts_a.front().shape, pair.pose_a}, motions.a}, found.time);
  const Pose pose_b = pose_at({{parts_b.front().shape, pair.pose_b}, motions.b}, found.time);
  auto solved = penetration_depth(PosedCompound{&pair.a.compound, pose_a}, PosedCompound{&pair.b.compound, pose_b},
                                  session.scratch, UnionSettings{});
  if (!solved) line.refuse(solved.error());
  UnionDepth contact = std::move(solved).value();
  tell_reached(found, contact);
  write_time(found.hit, found.time, found.certified, answer);
  write_union_answer(contact, pair, watch.nanoseconds(), answer);
}

}  // namespace pd::query

#include "oracle/moving_pair.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <random>
#include <vector>

#include "oracle/impact_oracle.hpp"

namespace pd::oracle {

namespace {

class Dice {
 public:
  explicit Dice(std::uint64_t seed) : random_(seed) {}

  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  Vec3 vector() { return {normal_(random_), normal_(random_), normal_(random_)}; }
  Vec3 unit() { return vector().normalized(); }
  Vec3 vector(double shortest, double longest) {
    const Vec3 direction = unit();
    return uniform(shortest, longest) * direction;
  }
  Mat3 rotation() {
    const Vec3 axis = unit();
    return Eigen::AngleAxisd(uniform(0, 3), axis).toRotationMatrix();
  }
  ConvexShape hull(double size) {
    std::vector<Vec3> points(static_cast<std::size_t>(uniform(4, 12)));
    for (Vec3& p : points) p = size * vector();
    return ConvexPolytope::from_points(points).value();
  }
  ConvexShape box(const Vec3& half) { return ConvexPolytope::box(half).value(); }

 private:
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
};

/// Drawn in this order.
struct Thrown {
  Vec3 w = Vec3::Zero();
  Vec3 v = Vec3::Zero();
  Vec3 at = Vec3::Zero();
  Mat3 rotation = Mat3::Identity();
};

MovingShape moving(const ConvexShape& shape, const Thrown& thrown) {
  return {{&shape, Pose::from_trusted_matrix(thrown.rotation, thrown.at)}, {thrown.v, thrown.w}};
}

}  // namespace

MovingCase moving_case(std::uint64_t seed, std::uint64_t index) {
  Dice dice(seed * 0x9e3779b97f4a7c15ULL + index);
  MovingCase pair;
  const auto hold = [&](ConvexShape a, ConvexShape b) {
    pair.shape_a = std::make_unique<ConvexShape>(std::move(a));
    pair.shape_b = std::make_unique<ConvexShape>(std::move(b));
  };
  switch (index % 5) {
    case 0: {
      pair.family = "hulls thrown at each other";
      ConvexShape b = dice.hull(0.5);
      hold(dice.hull(0.5), std::move(b));
      const Vec3 from = 5 * dice.unit();
      pair.a = moving(*pair.shape_a, {.w = 3 * dice.vector(),
                                      .v = -7 * from.normalized() + dice.vector(),
                                      .at = from,
                                      .rotation = dice.rotation()});
      pair.b = moving(*pair.shape_b, {.w = 3 * dice.vector(), .v = dice.vector(), .rotation = dice.rotation()});
      break;
    }
    case 1: {
      pair.family = "a spinning rod beside a thin wall";
      const double half = dice.uniform(0.5, 2);
      hold(dice.box(Vec3(half, 0.02, 0.02)), dice.box(Vec3(5, 0.0005, 5)));
      pair.a = moving(*pair.shape_a, {.w = dice.vector(1, 20),
                                      .v = 0.3 * dice.vector(),
                                      .at = Vec3(0, half * dice.uniform(0.3, 1.1), 0),
                                      .rotation = dice.rotation()});
      pair.b = moving(*pair.shape_b, {});
      break;
    }
    case 2: {
      pair.family = "a fast small body and a thin wall";
      hold(dice.hull(0.02), dice.box(Vec3(0.0005, 3, 3)));
      Thrown body{.w = 20 * dice.vector(), .v = 5 * dice.vector()};
      body.v.x() -= dice.uniform(20, 1000);
      body.at.z() = dice.uniform(-2, 2);
      body.at.y() = dice.uniform(-2, 2);
      body.at.x() = dice.uniform(2, 10);
      body.rotation = dice.rotation();
      pair.a = moving(*pair.shape_a, body);
      pair.b = moving(*pair.shape_b, {.w = 0.1 * dice.vector(), .rotation = dice.rotation()});
      break;
    }
    case 3: {
      pair.family = "grazing passes";
      // A corner of the spinning box comes as near to the wall as its way allows: heights around its largest reach.
      const double half_z = dice.uniform(0.2, 1), half_y = dice.uniform(0.2, 1);
      const Vec3 half(dice.uniform(0.2, 1), half_y, half_z);
      hold(dice.box(half), dice.box(Vec3(10, 1, 10)));
      const double share = dice.uniform(-1, 1);
      const double nearly = 1 + share * std::pow(10, -dice.uniform(1, 7));
      pair.a = moving(*pair.shape_a, {.w = Vec3(0, 0, dice.uniform(2, 12)),
                                      .v = Vec3(dice.uniform(-2, 2), 0, 0),
                                      .at = Vec3(0, 1 + half.head<2>().norm() * nearly, 0),
                                      .rotation = dice.rotation()});
      pair.b = moving(*pair.shape_b, {});
      // Turned about z only, so that the corner's reach is the half of the diagonal.
      pair.a.start.pose = Pose::from_trusted_matrix(
          Eigen::AngleAxisd(dice.uniform(0, 6), Vec3::UnitZ()).toRotationMatrix(), pair.a.start.pose.translation());
      break;
    }
    default: {
      pair.family = "parts that turn about a far point";
      ConvexShape b = dice.hull(0.3);
      hold(dice.hull(0.3), std::move(b));
      pair.a =
          moving(*pair.shape_a,
                 {.w = 3 * dice.vector(), .v = 2 * dice.vector(), .at = 3 * dice.unit(), .rotation = dice.rotation()});
      pair.a.arm = 2 * dice.vector();
      pair.b = moving(*pair.shape_b, {.w = 2 * dice.vector(), .rotation = dice.rotation()});
      pair.b.arm = dice.vector();
    }
  }
  return pair;
}

namespace {

/// Whether the bodies meet between two times: the reference leaves spans open in which the gap is below what the bodies
/// move in them, contact or not.
bool meet_between(const MovingCase& pair, double from, double to) {
  constexpr int kSamples = 64;
  for (int i = 0; i <= kSamples; ++i) {
    if (axis_separation(pair.a, pair.b, from + (to - from) * i / kSamples) <= 0) return true;
  }
  return false;
}

}  // namespace

ImpactJudgement judge(const MovingCase& pair, double tolerance, Scratch& scratch, double resolution) {
  ImpactJudgement result;
  TimeOfImpactSettings settings;
  settings.distance_tolerance = tolerance;
  result.answer = time_of_impact(pair.a, pair.b, pair.duration, scratch, settings);
  const TimeOfImpact& answer = result.answer;
  const FirstImpact reference = first_impact(pair.a, pair.b, pair.duration, resolution * pair.duration);
  result.reference_hit = reference.hit;
  // The reference's own rounding: separations of size 10 to 1e-15 of that, at speeds of a metre a second and more.
  const double slack = 4 * resolution * pair.duration;
  const double gap = axis_separation(pair.a, pair.b, answer.time);
  if (!answer.reached) {
    result.complaint = "the tolerance was not reached";
  } else if (reference.hit && !answer.hit) {
    result.complaint = "missed";
  } else if (answer.certified > reference.time + slack && meet_between(pair, reference.time, answer.certified)) {
    result.complaint = "certified past the first contact";
  } else if (answer.time < answer.certified) {
    result.complaint = "time before what is certified";
  } else if (answer.hit && answer.time > 0 && !(gap > 0 || answer.time + slack >= reference.time)) {
    result.complaint = "not apart at the time";
  } else if (answer.hit && answer.time > 0 && !(answer.contact.distance <= tolerance && gap <= tolerance)) {
    result.complaint = "a gap above the tolerance";
  } else if (answer.hit != (answer.time < pair.duration) && answer.hit) {
    result.complaint = "a hit at the end";
  }
  if (reference.hit && answer.hit) result.lead = reference.time - answer.time;
  result.graze = answer.hit && !reference.hit;
  return result;
}

}  // namespace pd::oracle

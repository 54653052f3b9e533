// First contacts that are known in closed form, and by stepping.
#include "pd/contact/time_of_impact.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>

#include "oracle/moving_pair.hpp"
#include "pd/depth/scratch.hpp"

namespace {

using pd::ConvexPolytope;
using pd::ConvexShape;
using pd::MovingShape;
using pd::Pose;
using pd::Vec3;

Pose at(double x, double y, double z) { return Pose::from_trusted_matrix(pd::Mat3::Identity(), Vec3(x, y, z)); }

TEST(TimeOfImpact, BallsHeadOn) {
  const ConvexShape ball = ConvexShape::sphere(0.5).value();
  pd::Scratch scratch;
  const MovingShape a{{&ball, at(3, 0, 0)}, {Vec3(-4, 0, 0), Vec3(1, 2, 3)}};
  const MovingShape b{{&ball, at(0, 0, 0)}, {Vec3(1, 0, 0), Vec3::Zero()}};
  const auto hit = pd::time_of_impact(a, b, 1, scratch);
  ASSERT_TRUE(hit.hit);
  EXPECT_NEAR(hit.time, 0.4, 1e-9);
  EXPECT_LE(hit.certified, hit.time);
  EXPECT_GT(hit.certified, 0.39);
  EXPECT_EQ(hit.contact.contact, pd::ContactClass::separated);
  EXPECT_FALSE(pd::time_of_impact(a, b, 0.39, scratch).hit);
}

TEST(TimeOfImpact, PassingByAndParting) {
  const ConvexShape ball = ConvexShape::sphere(0.5).value();
  pd::Scratch scratch;
  const MovingShape still{{&ball, Pose()}, {}};
  const auto near_miss =
      pd::time_of_impact({{&ball, at(3, 1.001, 0)}, {Vec3(-6, 0, 0), Vec3::Zero()}}, still, 1, scratch);
  EXPECT_FALSE(near_miss.hit);
  EXPECT_EQ(near_miss.time, 1);
  EXPECT_FALSE(pd::time_of_impact({{&ball, at(3, 0, 0)}, {Vec3(6, 0, 0), Vec3::Zero()}}, still, 1, scratch).hit);
  const auto grazing =
      pd::time_of_impact({{&ball, at(3, 0.999, 0)}, {Vec3(-6, 0, 0), Vec3::Zero()}}, still, 1, scratch);
  ASSERT_TRUE(grazing.hit);
  EXPECT_NEAR(grazing.time, (3 - std::sqrt(1 - 0.999 * 0.999)) / 6, 1e-7);
}

TEST(TimeOfImpact, ThinWallIsNotMissed) {
  const ConvexShape ball = ConvexShape::sphere(0.05).value();
  const ConvexShape wall(ConvexPolytope::box(Vec3(0.001, 5, 5)).value());
  pd::Scratch scratch;
  const auto hit = pd::time_of_impact({{&ball, at(-10, 0.3, 0)}, {Vec3(1000, 0, 0), Vec3::Zero()}},
                                      {{&wall, Pose()}, {}}, 1, scratch);
  ASSERT_TRUE(hit.hit);
  EXPECT_NEAR(hit.time, (10 - 0.051) / 1000, 1e-10);
}

TEST(TimeOfImpact, SpinningBarAgainstAWall) {
  // A bar of half length 1 turning at 2 rad/s about its centre, 0.6 in front of a wall: its tip at height sin(2t) =
  // 0.6.
  const ConvexShape bar(ConvexPolytope::from_points(std::vector<Vec3>{Vec3(-1, 0, 0), Vec3(1, 0, 0)}).value());
  const ConvexShape wall(ConvexPolytope::box(Vec3(5, 1, 5)).value());
  pd::Scratch scratch;
  const auto hit =
      pd::time_of_impact({{&bar, at(0, 1.6, 0)}, {Vec3::Zero(), Vec3(0, 0, 2)}}, {{&wall, Pose()}, {}}, 2, scratch);
  ASSERT_TRUE(hit.hit);
  EXPECT_NEAR(hit.time, std::asin(0.6) / 2, 1e-8);
  EXPECT_LT(hit.queries, 60);
}

TEST(TimeOfImpact, StartsInside) {
  const ConvexShape ball = ConvexShape::sphere(0.5).value();
  pd::Scratch scratch;
  const auto hit = pd::time_of_impact({{&ball, at(0.5, 0, 0)}, {}}, {{&ball, Pose()}, {}}, 1, scratch);
  EXPECT_TRUE(hit.hit);
  EXPECT_EQ(hit.time, 0);
}

TEST(TimeOfImpact, AFaceThatRocksOnAnEdgeIsProvedAlongItself) {
  // The lower face turns about a point 3e-5 above the edge, so that the bodies stay 3e-5 apart. A direction that stands
  // still proves that for a turn of 1e-4 only.
  const ConvexShape box(ConvexPolytope::box(Vec3(0.3, 0.3, 0.3)).value());
  const ConvexShape roof(
      ConvexPolytope::from_points(std::vector<Vec3>{Vec3(0, 0, -1), Vec3(0, 0, 1), Vec3(-1, -1, -1), Vec3(-1, -1, 1),
                                                    Vec3(1, -1, -1), Vec3(1, -1, 1)})
          .value());
  pd::Scratch scratch;
  MovingShape rocking{{&box, at(0.05, 0.3 + 3e-5, 0.02)}, {Vec3::Zero(), Vec3(0, 0, 0.2)}};
  rocking.arm = Vec3(0.05, 0.3 + 3e-5, 0);
  for (const bool swapped : {false, true}) {
    const MovingShape still{{&roof, Pose()}, {}};
    const auto found = swapped
                           ? pd::time_of_impact(still, rocking, 1, scratch, {.distance_tolerance = 1e-5, .depth = {}})
                           : pd::time_of_impact(rocking, still, 1, scratch, {.distance_tolerance = 1e-5, .depth = {}});
    EXPECT_FALSE(found.hit);
    EXPECT_EQ(found.certified, 1);
    EXPECT_LE(found.queries, 4);
  }
}

TEST(TimeOfImpact, TakesAnAnswerAtTheStart) {
  const ConvexShape ball = ConvexShape::sphere(0.5).value();
  pd::Scratch scratch;
  const MovingShape a{{&ball, at(3, 0, 0)}, {Vec3(-4, 0, 0), Vec3::Zero()}};
  const MovingShape b{{&ball, at(0, 0, 0)}, {Vec3(1, 0, 0), Vec3::Zero()}};
  const auto asked = pd::time_of_impact(a, b, 1, scratch);
  const auto start = pd::penetration_depth(a.start, b.start, scratch);
  pd::TimeOfImpactSettings settings;
  settings.at_start = &start;
  const auto told = pd::time_of_impact(a, b, 1, scratch, settings);
  EXPECT_EQ(told.time, asked.time);
  EXPECT_EQ(told.certified, asked.certified);
  EXPECT_EQ(told.queries, asked.queries - 1);
}

/// The least coordinate of a moving shape along n at a time.
double least_along(const MovingShape& body, const Vec3& n, double time, pd::Scratch& scratch) {
  const ConvexShape far(ConvexPolytope::box(Vec3(1e3, 1e3, 1e3)).value());
  const Eigen::Quaterniond turn = Eigen::Quaterniond::FromTwoVectors(Vec3::UnitY(), n);
  const Pose below = Pose::from_trusted_matrix(turn.toRotationMatrix(), -1010 * n);
  return pd::penetration_depth({body.start.shape, pd::pose_at(body, time)}, {&far, below}, scratch).signed_distance() -
         10;
}

TEST(TimeOfImpact, SupportsStayWithinTheCurvatureBound) {
  const ConvexShape shapes[] = {ConvexShape::cylinder(0.4, 0.1, 2).value(), ConvexShape::cone(0.3, 0.5, 0).value(),
                                ConvexShape(ConvexPolytope::box(Vec3(0.3, 0.1, 0.5)).value())};
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  const auto vector = [&] { return Vec3{normal(random), normal(random), normal(random)}; };
  pd::Scratch scratch;
  double closest = 0;
  for (int i = 0; i < 60; ++i) {
    MovingShape body{{&shapes[i % 3], at(0, 0, 0)}, {vector(), vector()}};
    // The axis of the cylinder nearly keeps its direction in half of the cases.
    if (i % 2 == 0) body.motion.angular_velocity = Vec3{0.01 * normal(random), 0.01 * normal(random), 2};
    if (i % 4 >= 2) body.arm = 0.3 * vector();
    const Vec3 n = vector().normalized();
    const double h = 0.1;
    const double chord = 0.5 * (least_along(body, n, 0, scratch) + least_along(body, n, 2 * h, scratch));
    const double bulge = 0.5 * pd::curvature_bound(body) * h * h;
    const double below = chord - least_along(body, n, h, scratch);
    EXPECT_LE(below, bulge + 1e-9) << i;
    if (bulge > 1e-6) closest = std::max(closest, below / bulge);
  }
  EXPECT_GT(closest, 0.3);
  const MovingShape wheel{{&shapes[0], at(0, 0, 0)}, {Vec3(1, 0, 0), Vec3(0, 0, 12)}};
  EXPECT_LT(pd::curvature_bound(wheel), 1e-10);
}

TEST(TimeOfImpact, AgainstSmallSteps) {
  std::mt19937 random(23);
  std::normal_distribution<double> normal;
  const auto vector = [&] { return Vec3{normal(random), normal(random), normal(random)}; };
  pd::Scratch scratch;
  int hits = 0;
  for (int i = 0; i < 30; ++i) {
    std::vector<Vec3> points(10);
    for (Vec3& p : points) {
      p = 0.5 * vector();
    }
    const ConvexShape a(ConvexPolytope::from_points(points).value());
    const ConvexShape b =
        i % 2 ? ConvexShape(ConvexPolytope::box(Vec3(1, 0.2, 0.6)).value()) : ConvexShape::capsule(0.3, 0.8, 1).value();
    const MovingShape moving_a{{&a, at(4, 0, 0)}, {Vec3(-6, 0, 0) + vector(), 3 * vector()}};
    const MovingShape moving_b{{&b, Pose()}, {vector(), 3 * vector()}};
    const auto found = pd::time_of_impact(moving_a, moving_b, 1, scratch);
    double first = HUGE_VAL;
    for (int k = 0; k <= 2000 && first == HUGE_VAL; ++k) {
      const double t = k / 2000.0;
      const auto answer =
          pd::penetration_depth({&a, pd::pose_at(moving_a, t)}, {&b, pd::pose_at(moving_b, t)}, scratch);
      if (answer.contact != pd::ContactClass::separated) {
        first = t;
      }
    }
    if (first < HUGE_VAL) {
      ASSERT_TRUE(found.hit) << i;
      EXPECT_LE(found.time, first + 1e-9) << i;
      EXPECT_GT(found.time, first - 0.02) << i;
      ++hits;
    }
    if (found.hit) {
      EXPECT_LE(found.contact.distance, 1e-9) << i;
    }
  }
  EXPECT_GT(hits, 15);
}

TEST(TimeOfImpact, WithinItsBracketByBisectionOfTime) {
  pd::Scratch scratch;
  int hits = 0;
  for (std::uint64_t i = 0; i < 30; ++i) {
    const pd::oracle::MovingCase pair = pd::oracle::moving_case(1, i);
    const pd::oracle::ImpactJudgement judged = judge(pair, 1e-9, scratch, 1e-7);
    EXPECT_EQ(judged.complaint, "") << pair.family << ", pair " << i;
    EXPECT_EQ(judged.answer.certified, judged.answer.time);
    hits += judged.reference_hit ? 1 : 0;
  }
  EXPECT_GT(hits, 10);
}

TEST(TimeOfImpact, APartTurnsAboutItsBody) {
  // A point one to the right of the pivot, a quarter turn a second; the wall's face is 0.5 above the pivot.
  const ConvexShape point(ConvexPolytope::from_points(std::vector<Vec3>{Vec3(1, 0, 0)}).value());
  const ConvexShape wall(ConvexPolytope::box(Vec3(5, 1, 5)).value());
  pd::Scratch scratch;
  const MovingShape arm{{&point, at(0, 0, 0)}, {Vec3::Zero(), Vec3(0, 0, 2)}};
  const MovingShape part{
      {&point, at(3, 0, 0)}, {Vec3::Zero(), Vec3(0, 0, 2)}, Vec3(3, 0, 0)};  // the point is 4 from its pivot
  const MovingShape still{{&wall, at(0, 1.5, 0)}, {}};
  EXPECT_NEAR(pd::time_of_impact(arm, still, 2, scratch).time, std::asin(0.5) / 2, 1e-8);
  EXPECT_NEAR(pd::time_of_impact(part, still, 2, scratch).time, std::asin(0.125) / 2, 1e-8);
  EXPECT_LT((pd::pose_at(part, 0.7).translation() - 3 * Vec3(std::cos(1.4), std::sin(1.4), 0)).norm(), 1e-14);
}

TEST(TimeOfImpact, StartsWithinTheTolerance) {
  const ConvexShape ball = ConvexShape::sphere(0.5).value();
  pd::Scratch scratch;
  const MovingShape still{{&ball, Pose()}, {}};
  const MovingShape parting{{&ball, at(1 + 1e-10, 0, 0)}, {Vec3(1, 0, 0), Vec3::Zero()}};
  const MovingShape closing{{&ball, at(1 + 1e-10, 0, 0)}, {Vec3(-1, 0, 0), Vec3::Zero()}};
  EXPECT_FALSE(pd::time_of_impact(parting, still, 1, scratch).hit);
  const auto hit = pd::time_of_impact(closing, still, 1, scratch);
  EXPECT_TRUE(hit.hit);
  EXPECT_GT(hit.time, 0);
  EXPECT_LE(hit.time, 1e-10);
}

// The bodies meet early in a duration whose end lies far away, so that doubles tell little there.
TEST(TimeOfImpact, TellsAsMuchWhateverTheDuration) {
  const ConvexShape box(ConvexPolytope::box(Vec3(1, 1, 1)).value());
  const MovingShape still{{&box, Pose()}, {}};
  pd::Scratch scratch;
  for (const double speed : {1.0, 1e4, 1e6, 1e20}) {
    for (const double duration : {5.0, 1e3, 1e9}) {
      SCOPED_TRACE(testing::Message() << speed << " for " << duration);
      const auto hit =
          pd::time_of_impact({{&box, at(-4, 0.3, 0)}, {Vec3(speed, 0, 0), Vec3::Zero()}}, still, duration, scratch);
      ASSERT_TRUE(hit.hit);
      EXPECT_TRUE(hit.reached);
      EXPECT_NEAR(hit.time, 2 / speed, 2e-9 / speed);
      EXPECT_LE(hit.contact.distance, 1e-9);
      EXPECT_EQ(hit.certified, hit.time);
      const auto past =
          pd::time_of_impact({{&box, at(-4, 2.3, 0)}, {Vec3(speed, 0, 0), Vec3::Zero()}}, still, duration, scratch);
      EXPECT_FALSE(past.hit);
      EXPECT_EQ(past.certified, duration);
    }
  }
  // A turning body sees each direction move, and meets after a hundred turns.
  const ConvexShape bar(ConvexPolytope::box(Vec3(1, 0.1, 0.1)).value());
  const MovingShape spinning{{&bar, at(-102, 0, 0)}, {Vec3(1, 0, 0), Vec3(0, 0, 6)}};
  const auto early = pd::time_of_impact(spinning, still, 110, scratch);
  ASSERT_TRUE(early.hit);
  EXPECT_TRUE(early.reached);
  const auto late = pd::time_of_impact(spinning, still, 1e9, scratch);
  ASSERT_TRUE(late.hit);
  EXPECT_TRUE(late.reached);
  EXPECT_NEAR(late.time, early.time, 1e-8);
}

TEST(TimeOfImpact, SaysWhereDoublesCannotTell) {
  // Coordinates of 1e9 are 1e-7 apart: a gap of 1e-12 cannot be had.
  const ConvexShape box(ConvexPolytope::box(Vec3(1, 1, 1)).value());
  pd::Scratch scratch;
  pd::TimeOfImpactSettings settings;
  settings.distance_tolerance = 1e-12;
  const auto far = pd::time_of_impact({{&box, at(1e9 + 10, 0, 0)}, {Vec3(-16, 0.1, 0), Vec3(0.1, 0.2, 0.3)}},
                                      {{&box, at(1e9, 0, 0)}, {Vec3(0, 0, 0), Vec3(0, 0.1, 0)}}, 1, scratch, settings);
  EXPECT_TRUE(far.hit);
  EXPECT_FALSE(far.reached);
  EXPECT_GT(far.contact.distance, 0);
  EXPECT_LT(far.contact.distance, 1e-4);
  EXPECT_LE(far.certified, far.time + 1e-5);
}

// A pose of doubles may touch where the motion is proved apart: the span before it is halved until the gap is small.
TEST(TimeOfImpact, HitsAreWithinTheToleranceAsked) {
  struct ConeAndCapsule {
    double cone_radius, cone_half_height, capsule_radius, capsule_half_height;
    Vec3 from, velocity;
  };
  const ConeAndCapsule cases[] = {{0.70201104524289093,
                                   0.31640766047773461,
                                   0.87693563962742105,
                                   0.26407411858852892,
                                   {-1.3579143239123197, 1.9754595338640852, 1.8037816716496589},
                                   {1.9254633938049419, -2.8011156163662889, -2.5576838818307968}},
                                  {0.6108426254794419,
                                   0.94064909931937835,
                                   0.55701237947305871,
                                   0.24980435580069557,
                                   {2.0676765643107546, 2.1319479156197927, -0.42368822320722394},
                                   {-3.0014835946692657, -3.0947812650549666, 0.61503490108713532}}};
  pd::Scratch scratch;
  for (const ConeAndCapsule& pair : cases) {
    const ConvexShape cone = *ConvexShape::cone(pair.cone_radius, pair.cone_half_height, 1);
    const ConvexShape capsule = *ConvexShape::capsule(pair.capsule_radius, pair.capsule_half_height, 2);
    const MovingShape moving{{&cone, Pose::from_trusted_matrix(pd::Mat3::Identity(), pair.from)}, {pair.velocity}};
    const auto hit = pd::time_of_impact(moving, {{&capsule, Pose()}, {}}, 2, scratch);
    ASSERT_TRUE(hit.hit);
    EXPECT_GT(hit.time, 0);
    EXPECT_TRUE(hit.reached);
    EXPECT_LE(hit.contact.distance, 1e-9);
    EXPECT_EQ(hit.contact.contact, pd::ContactClass::separated);
    EXPECT_GE(hit.certified, hit.time);
  }
}

}  // namespace

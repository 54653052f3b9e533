/// @file
/// `Bracket::contact`: the interval that an engine asks for, judged by exact answers; no exact sign, whatever the pair.

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <vector>

#include "oracle/contact_check.hpp"
#include "oracle/judged_pair.hpp"
#include "oracle/resting_pair.hpp"
#include "pd/depth/warm_certificate.hpp"

namespace pd {
namespace {

using oracle::check_contact;
using oracle::size_of_numbers;

/// As an engine in single precision has it: 1/64 of what a pose leaves uncertain.
double tolerance_of(const PosedShape& a, const PosedShape& b, double smaller_radius) {
  return std::ldexp(std::max(a.pose.translation().norm(), b.pose.translation().norm()) + smaller_radius, -30);
}
DepthSettings contact(double tolerance) { return {.bracket = Bracket::contact, .contact_tolerance = tolerance}; }

bool same_bits(const Vec3& x, const Vec3& y) { return std::memcmp(x.data(), y.data(), sizeof(Vec3)) == 0; }

/// Checks one pair cold, warm, again and the other way round.
class Judge {
 public:
  void ask(const PosedShape& a, const PosedShape& b, double tolerance, const std::string& name) {
    const DepthSettings settings = contact(tolerance);
    const PenetrationDepth exact = penetration_depth(a, b, scratch_);
    const PenetrationDepth answer = penetration_depth(a, b, scratch_, settings);
    const double allowed = std::max(2e-14 * size_of_numbers(a, b), tolerance);
    EXPECT_EQ(check_contact(a, b, answer, exact, allowed, scratch_), "") << name;
    ++pairs;
    missed += !answer.bracket_reached;
    EXPECT_TRUE(answer.bracket_reached) << name << ": " << answer.lower << " " << answer.upper << " "
                                        << answer.distance_lower << " " << answer.distance_upper;
    ++classes[static_cast<int>(answer.contact)];

    const PenetrationDepth again = penetration_depth(a, b, other_scratch_, settings);
    expect_same(again, answer, name + ", again");
    PenetrationDepth swapped = penetration_depth(b, a, scratch_, settings);
    // Two equal bodies in one place are one another's mirror: nothing tells them apart.
    if (swapped.normal != answer.normal) {
      EXPECT_EQ(swapped.normal, Vec3(-answer.normal)) << name << ", swapped";
    } else {
      swapped.translation = -answer.translation;
      std::swap(swapped.witness_a, swapped.witness_b);
    }
    swapped.normal = answer.normal;
    std::swap(swapped.witness_a, swapped.witness_b);
    expect_same(swapped, answer, name + ", swapped");

    WarmCertificate memory;
    (void)penetration_depth(a, b, scratch_, settings, &memory);
    const PenetrationDepth warm = penetration_depth(a, b, scratch_, settings, &memory);
    EXPECT_EQ(check_contact(a, b, warm, exact, allowed, scratch_), "") << name << ", warm";
  }
  int pairs = 0;
  int missed = 0;
  int classes[3] = {};

 private:
  static void expect_same(const PenetrationDepth& x, const PenetrationDepth& y, const std::string& name) {
    EXPECT_TRUE(x.contact == y.contact && x.lower == y.lower && x.upper == y.upper &&
                x.distance_lower == y.distance_lower && x.distance_upper == y.distance_upper &&
                same_bits(x.normal, y.normal) && same_bits(x.witness_a, y.witness_a) &&
                same_bits(x.witness_b, y.witness_b))
        << name;
  }
  Scratch scratch_;
  Scratch other_scratch_;
};

ConvexShape hull(const std::vector<Vec3>& points, double margin = 0) {
  return *ConvexShape(*ConvexPolytope::from_points(points)).with_margin(margin);
}

TEST(ContactBracket, FamiliesOfPairs) {
  Judge judge;
  for (int f = 0; f < scenes::kPairFamilies; ++f) {
    for (int d = 0; d < scenes::kDepthClasses; ++d) {
      // Sizes beyond 2^100 are left to exact numbers.
      if (static_cast<scenes::PairFamily>(f) == scenes::PairFamily::scales) continue;
      for (const int n : {8, 24}) {
        const oracle::JudgedPair pair = oracle::JudgedPair::of_family(static_cast<scenes::PairFamily>(f), n,
                                                                      static_cast<scenes::DepthClass>(d), 11);
        judge.ask(pair.a(), pair.b(), tolerance_of(pair.a(), pair.b(), 1), pair.name());
      }
    }
  }
  EXPECT_EQ(judge.missed, 0);
  EXPECT_GT(judge.classes[static_cast<int>(ContactClass::overlapping)], 20);
}

TEST(ContactBracket, WithinAHairOfContact) {
  Judge judge;
  Scratch scratch;
  for (std::uint64_t seed = 1; seed <= 120; ++seed) {
    const oracle::RestingPair rest = oracle::make_resting_pair(seed, scratch);
    for (const bool sharp : {false, true}) {
      const ConvexShape a = hull(rest.cores.a, sharp ? 0 : rest.margin_a);
      const ConvexShape b = hull(rest.cores.b, sharp ? 0 : rest.margin_b);
      const PosedShape posed_a{&a, rest.cores.pose_a}, posed_b{&b, rest.cores.pose_b};
      judge.ask(posed_a, posed_b, tolerance_of(posed_a, posed_b, 0.01), "seed " + std::to_string(seed));
    }
  }
  EXPECT_EQ(judge.missed, 0);
  EXPECT_GT(judge.classes[static_cast<int>(ContactClass::touching)], 20);
}

/// A box, a hull, a ball and a capsule that stand on floors within 1e-12 to 1e-5 of contact, sharp and rounded.
TEST(ContactBracket, OnFloorsOfAnyWidth) {
  Judge judge;
  scenes::Random random(3);
  const std::vector<std::vector<Vec3>> bodies = {scenes::box({0.5, 0.5, 0.5}),
                                                 {{0, -0.5, 0}, {0.4, 0.3, 0}, {-0.3, 0.2, 0.5}, {-0.2, 0.4, -0.5}},
                                                 {Vec3(0, -0.5, 0)},
                                                 {{-0.5, -0.5, 0}, {0.5, -0.5, 0}}};
  for (const double width : {1.0, 20.0, 200.0, 1e4}) {
    for (std::size_t k = 0; k < bodies.size(); ++k) {
      for (const double margin : {0.0, 0.04}) {
        for (const double gap : {0.0, 1e-12, -1e-12, 1e-9, -1e-9, 1e-5, -1e-5}) {
          const ConvexShape body = hull(bodies[k], margin);
          const ConvexShape floor = hull(scenes::box({width, 1, width}), margin);
          const auto [sine, cosine] = scenes::turn(random.uniform());
          const Pose pose = *Pose::from_quaternion({cosine, 0, sine, 0}, {0.3, 0.5 + 2 * margin + gap, -0.1});
          const PosedShape posed_a{&body, pose}, posed_b{&floor, *Pose::from_matrix(Mat3::Identity(), {0, -1, 0})};
          judge.ask(posed_a, posed_b, tolerance_of(posed_a, posed_b, 0.5),
                    "body " + std::to_string(k) + " on " + std::to_string(width) + ", gap " + std::to_string(gap));
        }
      }
    }
  }
  EXPECT_EQ(judge.missed, 0);
}

/// Bricks that lie flush on each other as a world in single precision has them: turned against each other by its noise,
/// from overlap to apart, sharp and rounded; faces that cross, lie within each other, or share an edge.
TEST(ContactBracket, FlushBoxes) {
  Judge judge;
  Scratch scratch;
  scenes::Random random(9);
  int by_axes = 0, asked = 0;
  const auto single = [](const Mat3& m) { return Mat3(m.cast<float>().cast<double>()); };
  const Vec3 sizes[] = {{0.5, 0.25, 0.5}, {0.5, 0.25, 0.5}, {0.2, 0.1, 0.9}, {20, 1, 20}};
  const Vec3 places[] = {{0.5, 0, 0}, {0, 0, 0}, {0.5, 0, 0.5}, {0.3, 0, 0.1}};
  for (const double noise : {0.0, 1e-7, 1e-5, 1e-3}) {
    for (const double turn : {0.0, 0.3}) {
      for (const double gap : {0.0, 1e-9, -1e-9, 1e-5, -1e-5, 1e-2, -1e-2}) {
        for (int k = 0; k < 4; ++k) {
          const double margin = k % 2 == 0 ? 0 : 0.04;
          const ConvexShape upper = hull(scenes::box(sizes[k]), margin);
          const ConvexShape lower = hull(scenes::box(sizes[3 - k]), margin);
          const auto pose = [&](double yaw, const Vec3& at) {
            const Mat3 level{{std::cos(yaw), 0, std::sin(yaw)}, {0, 1, 0}, {-std::sin(yaw), 0, std::cos(yaw)}};
            const Vec3 tip{noise * random.uniform(-1, 1), noise * random.uniform(-1, 1), noise * random.uniform(-1, 1)};
            Mat3 tipped = level;
            for (int c = 0; c < 3; ++c) tipped.col(c) += tip.cross(level.col(c));
            return Pose::from_trusted_matrix(single(tipped), at.cast<float>().cast<double>());
          };
          const Vec3 above = places[k] + Vec3(0, sizes[k].y() + sizes[3 - k].y() + 2 * margin + gap, 0);
          const PosedShape a{&upper, pose(turn, Vec3(3, 7, -2) + above)}, b{&lower, pose(0, {3, 7, -2})};
          const double tolerance = tolerance_of(a, b, 0.5);
          judge.ask(a, b, tolerance, "noise " + std::to_string(noise) + ", gap " + std::to_string(gap));
          const PenetrationDepth answer = penetration_depth(a, b, scratch, contact(tolerance));
          by_axes += answer.method == Method::overlay && answer.statistics.support_calls == 0;
          ++asked;
        }
      }
    }
  }
  EXPECT_EQ(judge.missed, 0);
  // Without a search; the rest are corners that stand beside an edge.
  EXPECT_GT(by_axes, asked * 5 / 6) << by_axes << " of " << asked;
}

/// Cores of spheres and capsules against each other: parallel and crossed, end to end, close and far.
TEST(ContactBracket, PointsAndSegments) {
  Judge judge;
  Scratch scratch;
  scenes::Random random(21);
  int at_once = 0, asked = 0;
  const auto vector = [&] { return random.point(-1, 1); };
  for (int i = 0; i < 300; ++i) {
    const Vec3 along = vector();
    const double turn = i % 5 == 0 ? 0 : std::ldexp(1.0, -(i % 50));
    const double gap = std::ldexp(1.0, -(i % 20));
    const double margin = i % 3 == 0 ? 0 : 0.5 * gap + (i % 3 == 1 ? 1e-9 : 0.1);
    const std::vector<Vec3> first = i % 4 == 0 ? std::vector<Vec3>{vector()} : std::vector<Vec3>{-along, along};
    const Vec3 other = along + turn * vector();
    const std::vector<Vec3> second = i % 7 == 0 ? std::vector<Vec3>{vector()} : std::vector<Vec3>{-other, other};
    const ConvexShape a = hull(first, margin), b = hull(second, margin);
    const double shift = (i % 11 == 0 ? 2.5 : 0.2) * random.uniform();
    const Vec3 beside = gap * along.cross(vector()).normalized() + shift * along;
    const PosedShape posed_a{&a, *Pose::from_matrix(Mat3::Identity(), {3, 1, 2})};
    const PosedShape posed_b{&b, *Pose::from_matrix(Mat3::Identity(), Vec3(3, 1, 2) + beside)};
    const std::string name = "pair " + std::to_string(i);
    judge.ask(posed_a, posed_b, tolerance_of(posed_a, posed_b, 0.5), name);
    const PenetrationDepth exact = penetration_depth(posed_a, posed_b, scratch);
    const PenetrationDepth certified = penetration_depth(posed_a, posed_b, scratch, {.bracket = Bracket::certified});
    const auto own = oracle::signed_distance(certified), truth = oracle::signed_distance(exact);
    EXPECT_EQ(certified.contact, exact.contact) << name;
    EXPECT_LE(own.lower, truth.upper) << name;
    EXPECT_GE(own.upper, truth.lower) << name;
    EXPECT_LE(own.upper - own.lower, 2e-14 * size_of_numbers(posed_a, posed_b)) << name;
    at_once += certified.statistics.support_calls == 1;
    ++asked;
  }
  EXPECT_EQ(judge.missed, 0);
  EXPECT_GT(at_once, asked * 2 / 3) << at_once << " of " << asked << " in closed form";
}

/// Points and segments over every face, edge and corner of a box, near and far, and inside of it.
TEST(ContactBracket, PointsAndSegmentsOnBoxes) {
  Judge judge;
  scenes::Random random(22);
  const ConvexShape boxes[] = {hull(scenes::box({0.5, 0.4, 0.3})), hull(scenes::box({100, 1, 100}), 0.04)};
  for (int i = 0; i < 300; ++i) {
    const auto vector = [&] { return random.point(-1, 1); };
    const double margin = i % 3 == 0 ? 0 : 0.1;
    const std::vector<Vec3> core =
        i % 2 == 0 ? std::vector<Vec3>{0.1 * vector()} : std::vector<Vec3>{0.3 * vector(), 0.3 * vector()};
    const ConvexShape body = hull(core, margin);
    const ConvexShape& box = boxes[i % 5 == 0];
    const Vec3 way = vector().cwiseProduct(Vec3(1, 0.9, 0.8));
    const Vec3 spot = (1 + (i % 7 == 0 ? 1e-7 : 0.5 * random.uniform())) * way;
    const Vec3 tip = 1e-6 * vector();
    Mat3 turned{{0.8, 0, 0.6}, {0, 1, 0}, {-0.6, 0, 0.8}};
    for (int c = 0; c < 3; ++c) turned.col(c) += tip.cross(Vec3(turned.col(c)));
    const PosedShape posed_a{&body, *Pose::from_matrix(Mat3::Identity(), Vec3(1, 2, 3) + spot)};
    const PosedShape posed_b{&box, Pose::from_trusted_matrix(turned.cast<float>().cast<double>(), {1, 2, 3})};
    judge.ask(posed_a, posed_b, tolerance_of(posed_a, posed_b, 0.3), "pair " + std::to_string(i));
  }
  EXPECT_EQ(judge.missed, 0);
  EXPECT_GT(judge.classes[static_cast<int>(ContactClass::overlapping)], 50);
  EXPECT_GT(judge.classes[static_cast<int>(ContactClass::separated)], 50);
}

/// What spans no volume: the Minkowski difference is flat, a segment or a point, and holds the origin.
TEST(ContactBracket, FlatBodiesThroughEachOther) {
  Judge judge;
  const std::vector<std::vector<Vec3>> bodies = {{Vec3::Zero()},
                                                 {{-1, 0, 0}, {1, 0, 0}},
                                                 {{0, 0, -1}, {0, 0, 1}},
                                                 {{-1, 0, -1}, {1, 0, -1}, {0, 0, 1}},
                                                 {{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}}};
  for (const double margin : {0.0, 0.25}) {
    for (const double turn : {0.0, 0.1}) {
      for (std::size_t i = 0; i < bodies.size(); ++i) {
        for (std::size_t k = i; k < bodies.size(); ++k) {
          const ConvexShape a = hull(bodies[i], margin), b = hull(bodies[k], margin);
          const auto [sine, cosine] = scenes::turn(turn);
          const Pose pose = *Pose::from_quaternion({cosine, sine, 0, 0}, {5, 6, 7});
          const PosedShape posed_a{&a, pose}, posed_b{&b, pose};
          judge.ask(posed_a, posed_b, tolerance_of(posed_a, posed_b, 1),
                    std::to_string(i) + " in " + std::to_string(k) + ", margin " + std::to_string(margin));
        }
      }
    }
  }
  EXPECT_EQ(judge.missed, 0);
}

/// Curved bodies: against the interval of a much narrower search.
/// Corners that lie an ulp apart fall together once they are moved: no side of the facet is left to lie inside of.
TEST(ContactBracket, SliversWhoseCornersFallTogether) {
  const double most_of_1 = std::nextafter(1.0, 0.0), most_of_2 = std::nextafter(2.0, 0.0);
  const ConvexShape box(*ConvexPolytope::box({3, 2, 2}));
  const ConvexShape sliver(*ConvexPolytope::from_points(
      std::vector<Vec3>{{-1, 2, most_of_1}, {-1, 2, 1}, {-most_of_1, most_of_2, most_of_1}}));
  const ConvexShape speck(*ConvexPolytope::from_points(std::vector<Vec3>{{0, 0, 0}, {1e-17, 0, 0}, {0, 1e-17, 0}}));
  const ConvexShape ball = *ConvexShape::sphere(1);
  const auto at = [](const Vec3& place) { return Pose::from_trusted_matrix(Mat3::Identity(), place); };
  Scratch scratch;
  const PosedShape posed_box{&box, at({2, -2, -1})}, posed_ball{&ball, at({2, -2, -1})};
  for (const PosedShape& other : {posed_box, posed_ball}) {
    for (const PosedShape& thin : {PosedShape{&sliver, at({-1.5, 0, 2})}, PosedShape{&speck, at({-1.5, 4, 2})}}) {
      const PenetrationDepth exact = penetration_depth(thin, other, scratch);
      ASSERT_EQ(exact.contact, ContactClass::separated);
      for (const double tolerance : {0.0, 1e-6}) {
        const PenetrationDepth answer = penetration_depth(thin, other, scratch, contact(tolerance));
        EXPECT_EQ(answer.contact, ContactClass::separated);
        EXPECT_NEAR(answer.distance, exact.distance, 1e-6 * exact.distance);
      }
    }
  }
}

/// A point with a margin in a sliver that no double tells from a segment: every bound comes from the axes.
TEST(ContactBracket, FlatBodiesWithoutADirectionAcross) {
  const std::vector<Vec3> corners{
      {-5, 3, -0x1.ba42df6c31716p-544}, {-2, 3, -0x1.26d73f9d764b9p-544}, {-2, 3, 0x1.ba42df6c31716p-544}};
  const ConvexShape sliver(*ConvexPolytope::from_points(corners));
  const ConvexShape ball = *ConvexShape(*ConvexPolytope::from_points(std::vector<Vec3>{Vec3::Zero()})).with_margin(3);
  const auto at = [](const Vec3& place) { return Pose::from_trusted_matrix(Mat3::Identity(), place); };
  Scratch scratch;
  const PenetrationDepth answer =
      penetration_depth({&ball, at({-3, 2, 2})}, {&sliver, at({-1, -1, 2})}, scratch, contact(0));
  EXPECT_EQ(answer.contact, ContactClass::overlapping);
  EXPECT_TRUE(answer.lower <= 3 && answer.upper >= 3 && answer.upper <= 3 + 1e-12)
      << answer.lower << " " << answer.upper;
  EXPECT_TRUE(answer.translation.allFinite());
}

TEST(ContactBracket, CurvedBodiesOnFloors) {
  // Three feet of their own radii, all half a unit below the origin, and a head.
  const std::vector<Sphere> kFeet{
      {{0.4, -0.2, 0}, 0.3}, {{-0.4, -0.4, 0.3}, 0.1}, {{-0.4, -0.3, -0.3}, 0.2}, {{0, 0.3, 0}, 0.2}};
  Scratch scratch;
  scenes::Random random(5);
  int touching = 0;
  for (const double width : {1.0, 20.0, 1e4}) {
    const ConvexShape floor = hull(scenes::box({width, 1, width}), 0.04);
    const PosedShape posed_floor{&floor, *Pose::from_matrix(Mat3::Identity(), {0, -1.04, 0})};
    for (const double margin : {0.0, 0.04}) {
      const ConvexShape bodies[] = {*ConvexShape::cylinder(0.4, 0.5, 1)->with_margin(margin),
                                    *ConvexShape::cone(0.4, 0.5, 1)->with_margin(margin),
                                    *ConvexShape::ellipsoid({0.3, 0.5, 0.4})->with_margin(margin),
                                    *ConvexShape::hull_of_spheres(kFeet)->with_margin(margin)};
      for (const ConvexShape& body : bodies) {
        WarmCertificate memory;
        for (const double gap : {1e-5, -1e-5, 1e-8, -1e-8, 0.0, 0.1, -0.1}) {
          const double tip = 1e-6 * random.uniform(-1, 1);
          const Pose pose = *Pose::from_quaternion({std::sqrt(1 - tip * tip), 0, 0, tip}, {0.1, 0.5 + margin + gap, 0});
          const PosedShape posed{&body, pose};
          const double tolerance = tolerance_of(posed, posed_floor, 0.5);
          const double allowed = std::max(1e-12 * (2 * width + 2), tolerance);
          const PenetrationDepth fine = penetration_depth(posed, posed_floor, scratch, {.delta = 1e-12});
          for (WarmCertificate* warm : {static_cast<WarmCertificate*>(nullptr), &memory}) {
            const PenetrationDepth answer = penetration_depth(posed, posed_floor, scratch, contact(tolerance), warm);
            const oracle::SignedInterval own = oracle::signed_distance(answer), truth = oracle::signed_distance(fine);
            // The reference takes what lies within 1e-12 L of contact for touching.
            const double slack = fine.contact == ContactClass::touching ? 1e-12 * (2 * width + 2) : 0;
            EXPECT_LE(own.lower, truth.upper + slack) << width << " " << gap;
            EXPECT_GE(own.upper, truth.lower - slack) << width << " " << gap;
            EXPECT_TRUE(answer.bracket_reached) << width << " " << gap << " " << own.upper - own.lower;
            EXPECT_LE(own.upper - own.lower, std::max(allowed, 1.01e-6 * std::abs(own.lower)));
            touching += answer.contact == ContactClass::touching;
          }
        }
      }
    }
  }
  EXPECT_GT(touching, 4);
}

/// Anyhow deep in each other: the budget of steps leaves a bracket of a thousandth, seldom.
TEST(ContactBracket, CurvedBodiesDeepInEachOther) {
  Scratch scratch;
  scenes::Random random(1);
  const ConvexShape shapes[] = {*ConvexShape::cylinder(0.4, 0.5, 1), *ConvexShape::cone(0.4, 0.5, 1),
                                *ConvexShape::ellipsoid({0.3, 0.5, 0.4}), hull({{-0.4, 0, 0}, {0.4, 0, 0}}, 0.2),
                                *ConvexShape::hull_of_spheres(std::vector<Sphere>{
                                    {{-0.4, 0, 0}, 0.3}, {{0.4, 0.1, 0}, 0.1}, {{0, 0.4, 0.2}, 0.2}})};
  int overlapping = 0;
  int missed = 0;
  for (int i = 0; i < 300; ++i) {
    const ConvexShape& a = shapes[i % 5];
    const ConvexShape& b = shapes[(i / 5) % 5];
    if (a.polytope() && b.polytope()) continue;
    const Pose pose_a = random.pose(Vec3::Zero());
    const Pose pose_b = random.pose({random.uniform(-0.6, 0.6), random.uniform(-0.6, 0.6), random.uniform(-0.6, 0.6)});
    const PenetrationDepth answer = penetration_depth({&a, pose_a}, {&b, pose_b}, scratch, contact(0x1p-30));
    const PenetrationDepth fine = penetration_depth({&a, pose_a}, {&b, pose_b}, scratch);
    const oracle::SignedInterval own = oracle::signed_distance(answer), truth = oracle::signed_distance(fine);
    EXPECT_LE(own.lower, truth.upper + 2e-12) << i;
    EXPECT_GE(own.upper, truth.lower - 2e-12) << i;
    EXPECT_LE(own.upper - own.lower, std::max(1e-9, 2e-3 * std::abs(own.lower))) << i;
    overlapping += answer.contact == ContactClass::overlapping;
    missed += !answer.bracket_reached;
  }
  EXPECT_GT(overlapping, 100);
  EXPECT_LE(missed, 30);
}

}  // namespace
}  // namespace pd

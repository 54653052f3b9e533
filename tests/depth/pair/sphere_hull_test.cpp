/// @file
/// Hulls of spheres: bodies whose depth is known, and the laws of every depth. Brackets against the direction sweep
/// stand in smooth_depth_test.cpp.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "oracle/contact_check.hpp"
#include "pd/depth/penetration_depth.hpp"
#include "pd/depth/scratch.hpp"
#include "pd/depth/warm_certificate.hpp"
#include "scenes/shape_families.hpp"

namespace pd {
namespace {

std::vector<Sphere> some_spheres(scenes::Random& random) {
  std::vector<Sphere> spheres(static_cast<std::size_t>(random.integer(2, 8)));
  for (Sphere& s : spheres) s = {random.direction(), random.uniform(0.05, 0.7)};
  return spheres;
}

ConvexShape hull_of(const std::vector<Sphere>& spheres) { return *ConvexShape::hull_of_spheres(spheres); }

ConvexShape other_body(int kind, scenes::Random& random) {
  switch (kind % 4) {
    case 0:
      return *ConvexPolytope::box({0.5, 0.3, 0.4});
    case 1:
      return *ConvexShape::cylinder(0.4, 0.6, 2);
    case 2:
      return *ConvexShape::capsule(0.2, 0.5, 0);
    default:
      return hull_of(some_spheres(random));
  }
}

void expect_same_bits(const PenetrationDepth& x, const PenetrationDepth& y, double scale = 1) {
  EXPECT_EQ(x.contact, y.contact);
  EXPECT_EQ(x.depth, scale * y.depth);
  EXPECT_EQ(x.lower, scale * y.lower);
  EXPECT_EQ(x.upper, scale * y.upper);
  EXPECT_EQ(x.distance_lower, scale * y.distance_lower);
  EXPECT_EQ(x.distance_upper, scale * y.distance_upper);
  EXPECT_EQ(x.normal, y.normal);
  EXPECT_EQ(x.witness_a, Vec3(scale * y.witness_a));
  EXPECT_EQ(x.witness_b, Vec3(scale * y.witness_b));
}

TEST(SphereHull, ClubsOnABox) {
  // Its side touches the plane y = 0 along a line when it leans by asin((R - r) / 2): lowered by x, it is x deep.
  Scratch scratch;
  const ConvexShape club = hull_of({{{-1, 0, 0}, 0.5}, {{1, 0, 0}, 0.25}});
  const ConvexShape box = *ConvexPolytope::box({5, 1, 5});
  const double half = 0.5 * std::asin(0.125);
  for (const double sink : {0.3, 1e-3, 1e-9, 0.0, -1e-9, -1e-3, -2.0}) {
    const Pose pose_a = *Pose::from_quaternion({std::cos(half), 0, 0, -std::sin(half)}, {0, 0.375 - sink, 0});
    const PosedShape a{&club, pose_a}, b{&box, *Pose::from_matrix(Mat3::Identity(), {0, -1, 0})};
    const PenetrationDepth answer = penetration_depth(a, b, scratch);
    const oracle::SignedInterval found = oracle::signed_distance(answer);
    EXPECT_LE(found.lower, -sink + 1e-11) << sink;
    EXPECT_GE(found.upper, -sink - 1e-11) << sink;
    EXPECT_LE(found.upper - found.lower, 1.1e-6 * std::abs(sink) + 1e-10) << sink;
    EXPECT_NEAR(answer.normal.y(), 1, 1e-5) << sink;
    const ContactClass expected = sink > 1e-10    ? ContactClass::overlapping
                                  : sink < -1e-10 ? ContactClass::separated
                                                  : ContactClass::touching;
    EXPECT_EQ(answer.contact, expected) << sink;
  }
}

TEST(SphereHull, ABallInItsThickEnd) {
  // The nearest way out is through the thick end, away from the thin one, in a whole cap of directions.
  Scratch scratch;
  const ConvexShape club = hull_of({{{0, 0, 0}, 1}, {{3, 0, 0}, 0.25}});
  const ConvexShape ball = *ConvexShape::sphere(0.125);
  const PenetrationDepth centred = penetration_depth({&ball, Pose()}, {&club, Pose()}, scratch);
  EXPECT_LE(centred.lower, 1.125);
  EXPECT_GE(centred.upper, 1.125);
  EXPECT_LE(centred.upper, 1.125 * (1 + 1.001e-6));
  const PenetrationDepth aside =
      penetration_depth({&ball, *Pose::from_matrix(Mat3::Identity(), {-0.5, 0, 0})}, {&club, Pose()}, scratch);
  EXPECT_NEAR(aside.depth, 0.625, 1e-6);
  EXPECT_NEAR(aside.normal.x(), -1, 1e-5);
}

TEST(SphereHull, NearlyEqualRadiiAreNearlyARoundedPolytope) {
  Scratch scratch;
  scenes::Random random(41);
  for (int i = 0; i < 60; ++i) {
    std::vector<Sphere> spheres = some_spheres(random);
    std::vector<Vec3> centres;
    const double noise = std::pow(10.0, -3 - i % 12);
    for (Sphere& s : spheres) {
      s.radius = 0.25 + noise * random.uniform(0, 1);
      centres.push_back(s.centre);
    }
    const ConvexShape rounded = *ConvexShape(*ConvexPolytope::from_points(centres)).with_margin(0.25);
    const ConvexShape hull = hull_of(spheres), b = other_body(i, random);
    const Pose pose = random.pose(random.vector(0, 2.5));
    const auto like = oracle::signed_distance(penetration_depth({&rounded, Pose()}, {&b, pose}, scratch));
    const auto own = oracle::signed_distance(penetration_depth({&hull, Pose()}, {&b, pose}, scratch));
    EXPECT_LE(own.lower, like.upper + 1e-12) << i;
    EXPECT_GE(own.upper, like.lower - noise - 1e-12) << i;
  }
}

TEST(SphereHull, Laws) {
  Scratch scratch, used;
  scenes::Random random(7);
  int classes[3] = {};
  for (int i = 0; i < 160; ++i) {
    std::vector<Sphere> spheres = some_spheres(random);
    const ConvexShape a = hull_of(spheres), b = other_body(i, random);
    const auto turn_a = random.quaternion(), turn_b = random.quaternion();
    const Vec3 offset = random.vector(0, 3);
    const PosedShape posed_a{&a, *Pose::from_quaternion(turn_a, Vec3::Zero())};
    const PosedShape posed_b{&b, *Pose::from_quaternion(turn_b, offset)};
    SCOPED_TRACE(i);
    const PenetrationDepth answer = penetration_depth(posed_a, posed_b, scratch);
    ++classes[static_cast<int>(answer.contact)];
    Scratch fresh;
    expect_same_bits(penetration_depth(posed_a, posed_b, fresh), answer);

    PenetrationDepth swapped = penetration_depth(posed_b, posed_a, scratch);
    swapped.normal = -swapped.normal;
    std::swap(swapped.witness_a, swapped.witness_b);
    expect_same_bits(swapped, answer);

    // The order of the spheres, and what lies inside.
    std::rotate(spheres.begin(), spheres.begin() + 1, spheres.end());
    const Sphere& first = spheres.front();
    if (first.radius > 0.1) spheres.push_back({first.centre, 0.5 * first.radius});
    const ConvexShape again = hull_of(spheres);
    expect_same_bits(penetration_depth({&again, posed_a.pose}, posed_b, scratch), answer);

    for (const int k : {-700, -101, -3, 5, 102, 700}) {
      if (b.polytope() == nullptr && std::get_if<SphereHull>(&b.core()) == nullptr) break;
      const double s = std::ldexp(1, k);
      const auto times = [&](const ConvexShape& shape) {
        if (const auto* polytope = shape.polytope()) {
          std::vector<Vec3> points;
          for (int v = 0; v < polytope->num_vertices(); ++v) points.push_back(s * polytope->vertex(v));
          return *ConvexShape(*ConvexPolytope::from_points(points)).with_margin(s * shape.margin());
        }
        std::vector<Sphere> scaled;
        for (const Sphere& sphere : std::get<SphereHull>(shape.core()).spheres()) {
          scaled.push_back({s * sphere.centre, s * sphere.radius});
        }
        return *hull_of(scaled).with_margin(s * shape.margin());
      };
      const ConvexShape scaled_a = times(a), scaled_b = times(b);
      const PosedShape far_a{&scaled_a, posed_a.pose}, far_b{&scaled_b, *Pose::from_quaternion(turn_b, s * offset)};
      SCOPED_TRACE(k);
      expect_same_bits(penetration_depth(far_a, far_b, scratch), answer, s);
    }

    // A margin on either body deepens by itself; a memory of the pair changes no promise.
    const ConvexShape thicker = *a.with_margin(0.25);
    const auto thin = oracle::signed_distance(answer);
    const auto thick = oracle::signed_distance(penetration_depth({&thicker, posed_a.pose}, posed_b, scratch));
    EXPECT_LE(thick.lower, thin.upper - 0.25 + 1e-12);
    EXPECT_GE(thick.upper, thin.lower - 0.25 - 1e-12);
    WarmCertificate warm;
    for (int frame = 0; frame < 2; ++frame) {
      const auto kept = oracle::signed_distance(penetration_depth(posed_a, posed_b, used, {}, &warm));
      EXPECT_LE(kept.lower, thin.upper);
      EXPECT_GE(kept.upper, thin.lower);
    }
  }
  EXPECT_GT(classes[static_cast<int>(ContactClass::overlapping)], 40);
  EXPECT_GT(classes[static_cast<int>(ContactClass::separated)], 30);
}

/// Moved to contact by their own answer and a hair beyond it.
TEST(SphereHull, AboutContact) {
  Scratch scratch;
  scenes::Random random(19);
  int touching = 0;
  for (int i = 0; i < 60; ++i) {
    const ConvexShape a = hull_of(some_spheres(random)), b = other_body(i, random);
    const auto turn = random.quaternion();
    const Pose pose_b = random.pose(0.5 * random.direction());
    const PenetrationDepth first =
        penetration_depth({&a, *Pose::from_quaternion(turn, Vec3::Zero())}, {&b, pose_b}, scratch, {.delta = 1e-12});
    if (first.contact != ContactClass::overlapping) continue;
    for (const double beyond : {0.0, 1e-9, -1e-9, 1e-6, -1e-6}) {
      const PosedShape moved{&a, *Pose::from_quaternion(turn, (first.depth + beyond) * first.normal)};
      const PenetrationDepth answer = penetration_depth(moved, {&b, pose_b}, scratch);
      const auto found = oracle::signed_distance(answer);
      EXPECT_GE(found.upper, beyond - 1e-11) << i;
      EXPECT_LE(found.lower, std::max(beyond, 0.0) + 1e-11) << i;
      EXPECT_LT(answer.statistics.support_calls, 2000) << i;
      touching += answer.contact == ContactClass::touching;
    }
  }
  EXPECT_GT(touching, 20);
}

}  // namespace
}  // namespace pd

// Contact points of pairs whose contact is known.
#include "pd/contact/manifold.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>
#include <set>

#include "pd/depth/scratch.hpp"

namespace {

using pd::ContactManifold;
using pd::ConvexPolytope;
using pd::ConvexShape;
using pd::Pose;
using pd::Vec3;

ConvexShape box(double x, double y, double z) { return ConvexShape(ConvexPolytope::box(Vec3(x, y, z)).value()); }

Pose pose(const Vec3& at, const Vec3& axis = Vec3::UnitX(), double angle = 0) {
  return Pose::from_trusted_matrix(Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix(), at);
}

struct Contact {
  pd::PenetrationDepth answer;
  ContactManifold manifold;
};

Contact touch(const ConvexShape& a, const Pose& pose_a, const ConvexShape& b, const Pose& pose_b,
              double threshold = 0.02, const pd::DepthSettings& settings = {},
              pd::DeepestPoint deepest = pd::DeepestPoint::on_bodies) {
  pd::Scratch scratch;
  pd::ManifoldScratch buffers;
  Contact result;
  result.answer = pd::penetration_depth({&a, pose_a}, {&b, pose_b}, scratch, settings);
  result.manifold = pd::contact_manifold({&a, pose_a}, {&b, pose_b}, result.answer, threshold, buffers, deepest);
  const double signed_depth =
      result.answer.contact == pd::ContactClass::separated ? -result.answer.distance : result.answer.depth;
  for (int i = 0; i < result.manifold.count; ++i) {
    const auto& point = result.manifold.points[i];
    EXPECT_NEAR((point.position_b - point.position_a - point.depth * result.manifold.normal).norm(), 0, 1e-12);
    EXPECT_LE(point.depth, signed_depth + 1e-12);
    EXPECT_GE(point.depth, -threshold);
  }
  return result;
}

double area(const ContactManifold& manifold) {
  // Twice the largest triangle with the first point: enough to tell a face from a line.
  double best = 0;
  for (int i = 1; i < manifold.count; ++i) {
    for (int j = i + 1; j < manifold.count; ++j) {
      best = std::max(best, (manifold.points[i].position_b - manifold.points[0].position_b)
                                .cross(manifold.points[j].position_b - manifold.points[0].position_b)
                                .norm());
    }
  }
  return best;
}

TEST(Manifold, BoxOnBoxHasItsFourCorners) {
  const ConvexShape small = box(0.5, 0.5, 0.5);
  const ConvexShape large = box(3, 1, 3);
  const Contact contact = touch(small, pose(Vec3(0.2, 1.4, -0.3)), large, Pose());
  ASSERT_EQ(contact.manifold.count, 4);
  EXPECT_NEAR(contact.manifold.normal.y(), 1, 1e-15);
  for (int i = 0; i < 4; ++i) {
    EXPECT_NEAR(contact.manifold.points[i].depth, 0.1, 1e-12);
    EXPECT_NEAR(contact.manifold.points[i].position_b.y(), 1, 1e-12);
    EXPECT_NEAR(contact.manifold.points[i].position_a.y(), 0.9, 1e-12);
  }
  EXPECT_NEAR(area(contact.manifold), 1, 1e-12);
  std::set<std::int64_t> ids;
  for (int i = 0; i < 4; ++i) {
    ids.insert(contact.manifold.points[i].feature_id);
  }
  EXPECT_EQ(ids.size(), 4u);
}

TEST(Manifold, FeatureIdsStayWhileTheFaceTurns) {
  const ConvexShape small = box(0.5, 0.5, 0.5);
  const ConvexShape large = box(3, 1, 3);
  std::set<std::int64_t> first;
  for (int step = 0; step < 20; ++step) {
    const Contact contact =
        touch(small, pose(Vec3(0.01 * step, 1.49, 0), Vec3(0.02, 1, 0.01), 0.02 * step), large, Pose(), 0.1);
    ASSERT_EQ(contact.manifold.count, 4) << step;
    std::set<std::int64_t> ids;
    for (int i = 0; i < 4; ++i) {
      ids.insert(contact.manifold.points[i].feature_id);
    }
    if (step == 0) {
      first = ids;
    }
    EXPECT_EQ(ids, first) << step;
  }
}

TEST(Manifold, EightCornersBecomeFourThatSpanTheFace) {
  const ConvexShape cube = box(1, 1, 1);
  const Contact contact = touch(cube, pose(Vec3(0, 1.9, 0), Vec3::UnitY(), M_PI / 4), cube, Pose());
  ASSERT_EQ(contact.manifold.count, 4);
  EXPECT_GT(area(contact.manifold), 1.6);
}

TEST(Manifold, CrossedEdgesMeetInOnePoint) {
  const ConvexShape bar = box(2, 0.5, 0.5);
  // Both bars lie on an edge, one along x and one along z: two edges cross at a right angle.
  const Contact contact = touch(
      bar,
      Pose::from_trusted_matrix(
          (Eigen::AngleAxisd(M_PI / 2, Vec3::UnitY()) * Eigen::AngleAxisd(M_PI / 4, Vec3::UnitX())).toRotationMatrix(),
          Vec3(0, std::sqrt(2.0) - 0.1, 0)),
      bar, pose(Vec3::Zero(), Vec3::UnitX(), M_PI / 4));
  ASSERT_EQ(contact.manifold.count, 1);
  EXPECT_NEAR(contact.manifold.points[0].depth, 0.1, 1e-12);
  EXPECT_NEAR(contact.manifold.points[0].position_b.x(), 0, 1e-9);
}

/// Within three degrees of each other, whatever their lengths, two edges share a stretch for an engine. The ends of the
/// stretch lie beside one of the edges, so that those who judge are given the point that both share.
TEST(Manifold, NearlyParallelEdgesShareAStretch) {
  for (const double half : {0.1, 1.0, 10.0}) {
    const ConvexShape rod = ConvexShape::capsule(0.25, half, 0).value();
    const pd::Pose turned = pose(Vec3(0, 0.49, 0), Vec3::UnitY(), 0.02);
    const Contact along = touch(rod, turned, rod, Pose(), 0.02, {}, pd::DeepestPoint::at_depth);
    EXPECT_EQ(touch(rod, turned, rod, Pose()).manifold.count, 1) << half;
    EXPECT_EQ(touch(rod, pose(Vec3(0, 0.49, 0)), rod, Pose()).manifold.count, 2) << half;
    ASSERT_EQ(along.manifold.count, 2) << half;
    EXPECT_NEAR((along.manifold.points[0].position_b - along.manifold.points[1].position_b).norm(), 2 * half,
                1e-3 * half);
    EXPECT_EQ(touch(rod, pose(Vec3(0, 0.49, 0), Vec3::UnitY(), 0.1), rod, Pose()).manifold.count, 1) << half;
  }
}

TEST(Manifold, CornersThatNearlyMeetAreOne) {
  // A triangle on a face whose border cuts off a tip of a billionth.
  std::vector<Vec3> corners;
  for (int k = 0; k < 3; ++k) {
    for (const double y : {-1.0, 1.0}) corners.emplace_back(std::cos(2 * M_PI * k / 3), y, std::sin(2 * M_PI * k / 3));
  }
  const ConvexShape prism(ConvexPolytope::from_points(corners).value());
  for (const double cut : {0.0, 1e-12, 1e-9}) {
    const Contact contact = touch(prism, pose(Vec3(1 + cut, 1.99, 0)), box(2, 1, 2), Pose());
    EXPECT_EQ(contact.manifold.count, 3) << cut;
  }
}

TEST(Manifold, EdgeOnFaceHasTwoEnds) {
  const ConvexShape bar = box(1, 0.5, 0.5);
  const ConvexShape floor = box(5, 1, 5);
  const Contact contact =
      touch(bar, pose(Vec3(0, 1 + std::sqrt(0.5) - 0.01, 0), Vec3::UnitX(), M_PI / 4), floor, Pose());
  ASSERT_EQ(contact.manifold.count, 2);
  EXPECT_NEAR((contact.manifold.points[0].position_b - contact.manifold.points[1].position_b).norm(), 2, 1e-9);
}

TEST(Manifold, RoundedBodiesStandOnTheirMargins) {
  const ConvexShape capsule = ConvexShape::capsule(0.25, 1, 0).value();
  const ConvexShape floor = box(5, 1, 5);
  const Contact lying = touch(capsule, pose(Vec3(0, 1.2, 0)), floor, Pose());
  ASSERT_EQ(lying.manifold.count, 2);
  for (int i = 0; i < 2; ++i) {
    EXPECT_NEAR(lying.manifold.points[i].depth, 0.05, 1e-12);
    EXPECT_NEAR(lying.manifold.points[i].position_a.y(), 0.95, 1e-12);
    EXPECT_NEAR(std::abs(lying.manifold.points[i].position_a.x()), 1, 1e-12);
  }
  const ConvexShape ball = ConvexShape::sphere(0.5).value();
  const Contact resting = touch(ball, pose(Vec3(0.3, 1.5 - 0.01, 0)), floor, Pose());
  ASSERT_EQ(resting.manifold.count, 1);
  EXPECT_NEAR(resting.manifold.points[0].depth, 0.01, 1e-12);

  const ConvexShape rounded = box(0.4, 0.4, 0.4).with_margin(0.1).value();
  const Contact soft = touch(rounded, pose(Vec3(0, 1.45, 0)), floor, Pose());
  ASSERT_EQ(soft.manifold.count, 4);
  EXPECT_NEAR(area(soft.manifold), 0.64, 1e-12);
}

TEST(Manifold, CylindersAndConesStandOnTheirDiscs) {
  const ConvexShape floor = box(5, 1, 5);
  const ConvexShape cylinder = ConvexShape::cylinder(0.5, 0.5, 1).value();
  const Contact standing = touch(cylinder, pose(Vec3(0, 1.49, 0)), floor, Pose());
  ASSERT_EQ(standing.manifold.count, 4);
  EXPECT_GT(area(standing.manifold), 0.45);  // a square in the disc has 0.5
  const Contact lying = touch(cylinder, pose(Vec3(0, 1.49, 0), Vec3::UnitZ(), M_PI / 2), floor, Pose());
  ASSERT_EQ(lying.manifold.count, 2);
  const ConvexShape cone = ConvexShape::cone(0.5, 0.5, 1).value();
  EXPECT_EQ(touch(cone, pose(Vec3(0, 1.49, 0)), floor, Pose()).manifold.count, 4);
  EXPECT_EQ(touch(cone, pose(Vec3(0, 1.49, 0), Vec3::UnitZ(), M_PI), floor, Pose()).manifold.count, 1);
}

TEST(Manifold, HullsOfSpheresStandOnTheirPolygonsAndLines) {
  const ConvexShape floor = box(5, 1, 5);
  // A table: a plane at y = -1 touches all four feet, whatever their radii; a fifth sphere between them does not show.
  const std::vector<pd::Sphere> table{{{1, -0.5, 1}, 0.5},    {{-1, -0.75, 1}, 0.25},   {{-1, -0.875, -1}, 0.125},
                                      {{1, -0.75, -1}, 0.25}, {{0.1, -0.5, 0.1}, 0.25}, {{0, 0.5, 0}, 0.25}};
  const ConvexShape chair = pd::ConvexShape::hull_of_spheres(table).value();
  for (const double turn : {0.0, 0.3, 1.0, 2.5}) {
    const Contact standing = touch(chair, pose(Vec3(0, 1.99, 0), Vec3::UnitY(), turn), floor, Pose());
    ASSERT_EQ(standing.manifold.count, 4);
    EXPECT_NEAR(area(standing.manifold), 4, 1e-9);
    for (int i = 0; i < 4; ++i) EXPECT_NEAR(standing.manifold.points[i].depth, 0.01, 1e-9);
  }
  // On the head alone.
  EXPECT_EQ(touch(chair, pose(Vec3(0, 1.74, 0), Vec3::UnitZ(), M_PI), floor, Pose()).manifold.count, 1);
  // A club lies on both its ends.
  const std::vector<pd::Sphere> ends{{{-1, 0, 0}, 0.5}, {{1, 0, 0}, 0.25}};
  const ConvexShape club = pd::ConvexShape::hull_of_spheres(ends).value();
  const Contact lying = touch(club, pose(Vec3(0, 1.36, 0), Vec3::UnitZ(), -std::asin(0.125)), floor, Pose());
  ASSERT_EQ(lying.manifold.count, 2);
  EXPECT_NEAR((lying.manifold.points[0].position_b - lying.manifold.points[1].position_b).norm(),
              2 * std::sqrt(1 - 0.125 * 0.125), 1e-9);
}

TEST(Manifold, HullsOfSpheresOfSizesFarApartHaveContactPoints) {
  // Brought to size 1, three of the spheres nearly coincide: the area between them is below the range of doubles.
  const ConvexShape point(ConvexPolytope::from_points(std::vector<Vec3>{Vec3::Zero()}).value());
  int asked = 0;
  for (const double far : {1e100, 1e160, 1e200, 1e300}) {
    for (const double unit : {1e-100, 1e-30, 1.0, 1e30}) {
      const std::vector<pd::Sphere> spheres{{unit * Vec3(-7, 0, 0), 2 * unit},
                                            {unit * Vec3(0, 0.0625, 0.75), 3 * unit},
                                            {{0, unit, -far}, 0},
                                            {unit * Vec3(4, -7.375, 4), 3 * unit}};
      const auto hull = pd::ConvexShape::hull_of_spheres(spheres);
      if (!hull) continue;
      const ConvexShape& needle = *hull;
      ++asked;
      pd::Scratch scratch;
      pd::ManifoldScratch buffers;
      const pd::PenetrationDepth answer = pd::penetration_depth({&needle, Pose()}, {&point, Pose()}, scratch);
      const ContactManifold manifold =
          pd::contact_manifold({&needle, Pose()}, {&point, Pose()}, answer, 0.1 * unit, buffers);
      EXPECT_GE(manifold.count, 1) << far << ' ' << unit;
      for (int i = 0; i < manifold.count; ++i) {
        EXPECT_TRUE(manifold.points[i].position_a.allFinite()) << far << ' ' << unit;
        EXPECT_TRUE(manifold.points[i].position_b.allFinite()) << far << ' ' << unit;
      }
    }
  }
  EXPECT_GE(asked, 8);
}

TEST(Manifold, TiltedFaceKeepsOnlyWhatIsNear) {
  const ConvexShape cube = box(0.5, 0.5, 0.5);
  const ConvexShape floor = box(5, 1, 5);
  // Tilted by 0.2 about z: the far edge is 0.2 above the near one.
  const Contact contact = touch(cube, pose(Vec3(0, 1.58, 0), Vec3::UnitZ(), 0.2), floor, Pose(), 0.02);
  ASSERT_EQ(contact.manifold.count, 2);
}

TEST(Manifold, ApartWithinTheThresholdAndBeyondIt) {
  const ConvexShape cube = box(0.5, 0.5, 0.5);
  const Contact near = touch(cube, pose(Vec3(0, 1.01, 0)), cube, Pose(), 0.02);
  ASSERT_EQ(near.manifold.count, 4);
  EXPECT_NEAR(near.manifold.points[0].depth, -0.01, 1e-12);
  EXPECT_EQ(touch(cube, pose(Vec3(0, 1.05, 0)), cube, Pose(), 0.02).manifold.count, 0);
}

TEST(Manifold, DeepestPairIsThePenetrationDepth) {
  std::mt19937 random(17);
  std::normal_distribution<double> normal;
  const auto cloud = [&](int n) {
    std::vector<Vec3> points;
    for (int i = 0; i < n; ++i) {
      points.push_back({normal(random), normal(random), normal(random)});
    }
    return ConvexShape(ConvexPolytope::from_points(points).value());
  };
  for (int i = 0; i < 300; ++i) {
    const ConvexShape a = cloud(8 + i % 20);
    const ConvexShape b = i % 3 ? cloud(12) : ConvexShape::cylinder(1, 1, i % 2).value();
    const Vec3 place{normal(random), normal(random), normal(random)};
    const Vec3 axis{normal(random), normal(random), normal(random)};
    const Pose pa = pose(place, axis, normal(random));
    const Contact contact = touch(a, pa, b, Pose(), 0.05);
    const double signed_depth =
        contact.answer.contact == pd::ContactClass::separated ? -contact.answer.distance : contact.answer.depth;
    if (signed_depth < -0.05) {
      EXPECT_EQ(contact.manifold.count, 0);
      continue;
    }
    ASSERT_GE(contact.manifold.count, 1) << i;
    double deepest = -HUGE_VAL;
    for (int k = 0; k < contact.manifold.count; ++k) {
      deepest = std::max(deepest, contact.manifold.points[k].depth);
    }
    EXPECT_NEAR(deepest, signed_depth, 1e-3 * 0.05 + 1e-5) << i;
  }
}

TEST(Manifold, DeepestPointIsAsDeepAsTheBodies) {
  // Faces tilted by less than the noise of a resting contact: their corners alone miss the depth by up to it.
  std::mt19937_64 random(9);
  std::uniform_real_distribution<double> place(-1, 1);
  int met = 0;
  for (int round = 0; round < 2000; ++round) {
    const ConvexShape a = box(1, 0.7, 0.8), b = box(2, 1, 2);
    const double tilt = 1e-6 * place(random);
    const Vec3 centre{place(random), 1.69 + 0.02 * place(random), place(random)};
    const Vec3 axis{place(random), 1e-3, place(random)};
    const Pose at = pose(centre, axis, tilt);
    const Contact contact = touch(a, at, b, pose(Vec3::Zero()), round % 2 == 0 ? 0.0 : 0.02);
    if (contact.manifold.count == 0) continue;
    ++met;
    double deepest = -HUGE_VAL;
    for (int i = 0; i < contact.manifold.count; ++i) deepest = std::max(deepest, contact.manifold.points[i].depth);
    const bool apart = contact.answer.contact == pd::ContactClass::separated;
    EXPECT_GE(deepest, apart ? -contact.answer.distance_upper : contact.answer.lower);
    EXPECT_LE(deepest, apart ? -contact.answer.distance_lower : contact.answer.upper);
  }
  EXPECT_GT(met, 500);
}

TEST(Manifold, BoxThatTouchesASlopeHasItsFourCorners) {
  // Placed to touch exactly: rounding decides, and the simplex that an answer for contacts ends with may hold corners
  // of facets that do not touch.
  const ConvexShape slope = box(20, 20, 5), cube = box(0.5, 0.5, 0.5);
  for (int k = 1; k <= 200; ++k) {
    const double angle = 0.003 * k;
    const Pose ground = pose(Vec3::Zero(), Vec3::UnitY(), angle);
    const Pose at = pose(ground.rotation() * Vec3(-3, 0.3, 5.5), Vec3::UnitY(), angle);
    for (const double tolerance : {0.0, 0x1p-57, 0x1p-40, 0x1p-26}) {
      const Contact contact =
          touch(slope, ground, cube, at, 0.02, {.bracket = pd::Bracket::contact, .contact_tolerance = tolerance});
      ASSERT_EQ(contact.manifold.count, 4) << angle << ", " << tolerance;
      EXPECT_NEAR(area(contact.manifold), 1, 1e-9) << angle << ", " << tolerance;
      for (int i = 0; i < 4; ++i) EXPECT_NEAR(contact.manifold.points[i].depth, 0, 1e-13 + tolerance);
    }
  }
}

TEST(Manifold, FeaturesThatTheBodiesDoNotHaveCountAsNone) {
  const ConvexShape small = box(0.5, 0.5, 0.5), large = box(3, 1, 3);
  const pd::PosedShape a{&small, pose(Vec3(0.2, 1.4, -0.3))}, b{&large, Pose()};
  pd::Scratch scratch;
  pd::ManifoldScratch buffers;
  const pd::PenetrationDepth answer = pd::penetration_depth(a, b, scratch);
  const ContactManifold known = pd::contact_manifold(a, b, answer, 0.02, buffers);
  ASSERT_EQ(known.count, 4);
  for (int kind = 0; kind < 6; ++kind) {
    for (const std::int32_t first : {INT32_MIN, -7, 0, 5, 8, 1 << 20, INT32_MAX}) {
      for (const std::int32_t second : {-1, 0, 9, INT32_MAX}) {
        pd::PenetrationDepth garbled = answer;
        garbled.feature_a = garbled.feature_b = {static_cast<pd::Feature::Kind>(kind), first, second};
        const ContactManifold found = pd::contact_manifold(a, b, garbled, 0.02, buffers);
        EXPECT_EQ(found.normal, known.normal);
        if (first >= 0 && first < 8) continue;  // a feature that the bodies have, far from the contact
        ASSERT_EQ(found.count, 4) << kind << " " << first << " " << second;
        for (int i = 0; i < 4; ++i) EXPECT_NEAR(found.points[static_cast<std::size_t>(i)].depth, 0.1, 1e-12);
      }
    }
  }
}

}  // namespace

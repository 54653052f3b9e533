/// @file
/// What is called out of a body's reach is out of reach by the exact distance, and little that is goes unnoticed.
#include "shapes/rounded_box.hpp"

#include <BulletCollision/CollisionShapes/btUniformScalingShape.h>
#include <btBulletCollisionCommon.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <memory>
#include <utility>

#include "pd/bullet/scalar.hpp"
#include "pd/bullet/shape_conversion.hpp"
#include "pd/depth/penetration_depth.hpp"
#include "pd/depth/scratch.hpp"
#include "scenes/shape_families.hpp"

namespace pd::test {
namespace {

btVector3 random_vector(scenes::Random& random, double most) { return to_bullet(most * random.point(-1, 1)); }

btTransform random_pose(scenes::Random& random, double most) {
  const auto q = random.quaternion();
  const btQuaternion turn(static_cast<btScalar>(q[1]), static_cast<btScalar>(q[2]), static_cast<btScalar>(q[3]),
                          static_cast<btScalar>(q[0]));
  return btTransform(turn, random_vector(random, most));
}

std::unique_ptr<btConvexHullShape> random_hull(scenes::Random& random) {
  auto hull = std::make_unique<btConvexHullShape>();
  for (int i = 0; i < 12; ++i) hull->addPoint(random_vector(random, 0.6), false);
  hull->recalcLocalAabb();
  return hull;
}

constexpr int kKinds = 10;

/// @param child  keeps what the body is made of
std::unique_ptr<btConvexShape> random_body(scenes::Random& random, int kind, std::unique_ptr<btConvexShape>& child) {
  const auto size = [&] { return static_cast<btScalar>(random.uniform(0.2, 0.6)); };
  struct Axial {
    btScalar radius;
    btScalar height;
  };
  const auto axial = [&] { return Axial{size(), size()}; };
  switch (kind) {
    case 0:
      return std::make_unique<btSphereShape>(size());
    case 1: {
      const Axial sizes = axial();
      return std::make_unique<btCapsuleShape>(sizes.radius, sizes.height);
    }
    case 2: {
      const Axial sizes = axial();
      return std::make_unique<btCapsuleShapeX>(sizes.radius, sizes.height);
    }
    case 3:
      return std::make_unique<btBoxShape>(btVector3{size(), size(), size()});
    case 4:
      return std::make_unique<btCylinderShapeZ>(btVector3(btScalar(0.3), btScalar(0.3), size()));
    case 5: {
      const Axial sizes = axial();
      return std::make_unique<btConeShape>(sizes.radius, sizes.height);
    }
    case 6: {
      const std::array<btVector3, 2> centres{random_vector(random, 0.5), random_vector(random, 0.5)};
      const std::array<btScalar, 2> radii{size(), size()};
      return std::make_unique<btMultiSphereShape>(centres.data(), radii.data(), 2);
    }
    case 7: {
      auto hull = random_hull(random);
      hull->setLocalScaling(btVector3{size(), size(), size()} * btScalar(2));
      return hull;
    }
    case 8: {
      auto hull = random_hull(random);
      auto scaled = std::make_unique<btUniformScalingShape>(hull.get(), size());
      child = std::move(hull);
      return scaled;
    }
    default: {
      const std::array<btVector3, 4> corners{random_vector(random, 0.6), random_vector(random, 0.6),
                                             random_vector(random, 0.6), random_vector(random, 0.6)};
      return std::make_unique<btBU_Simplex1to4>(corners[0], corners[1], corners[2], corners[3]);
    }
  }
}

/// Of triangles near a body: how many are farther than a reach, and of how many of them that was noticed.
struct Judged {
  int apart = 0;
  int noticed = 0;
};

Judged judge(int kind, double triangle_size, std::uint64_t seed) {
  scenes::Random random(seed);
  Scratch scratch;
  Judged judged;
  for (int i = 0; i < 2000; ++i) {
    std::unique_ptr<btConvexShape> child;
    const auto body = random_body(random, kind, child);
    const btTransform pose = random_pose(random, 3);
    const double reach = random.uniform(0, 0.05);
    Vec3 corners[3];
    const Vec3 about = to_pd(pose.getOrigin()) + random.point(-1, 1);
    for (Vec3& corner : corners) corner = to_pd(to_bullet(Vec3(about + triangle_size * random.point(-1, 1))));
    const Vec3 across = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    const auto shape = to_convex_shape(*body);
    const auto hull = ConvexPolytope::from_points(corners);
    if (!shape || !hull || hull->affine_dimension() != 2) continue;
    const ConvexShape triangle(*hull);
    const PenetrationDepth answer =
        penetration_depth({&*shape, to_pd(pose)}, {&triangle, Pose()}, scratch, {.bracket = Bracket::certified});
    const double distance = answer.signed_distance();
    const bool out = detail::out_of_reach(detail::rounded_box(*body, pose), corners, across, reach, 0x1p-20);
    EXPECT_TRUE(!out || distance > reach) << "kind " << kind << ", pair " << i << ": " << distance;
    if (distance <= reach + 1e-4) continue;
    ++judged.apart;
    judged.noticed += out ? 1 : 0;
  }
  return judged;
}

class RoundedBoxes : public testing::TestWithParam<int> {};

TEST_P(RoundedBoxes, OnlyWhatIsApartIsOutOfReach) {
  for (const double size : {0.3, 1.0, 20.0}) {
    const Judged judged = judge(GetParam(), size, 5);
    EXPECT_GT(judged.apart, 300) << size;
    // A sphere's box is the sphere; what rounds others off lies within theirs.
    const double share = GetParam() == 0 ? 0.95 : 0.6;
    EXPECT_GT(judged.noticed, share * judged.apart) << size << ": " << judged.noticed << " of " << judged.apart;
  }
}

INSTANTIATE_TEST_SUITE_P(Bodies, RoundedBoxes, testing::Range(0, kKinds));

/// A floor of 400 m: a triangle's corners round off far from the body, whose own coordinates are small.
TEST(RoundedBox, OnAWideFloor) {
  scenes::Random random(9);
  for (int i = 0; i < 2000; ++i) {
    const btSphereShape ball(btScalar(0.5));
    const btTransform pose = random_pose(random, 1);
    const Vec3 low = to_pd(pose.getOrigin()) - 0.5 * Vec3::UnitY();
    const Vec3 corners[3] = {{-200, low.y(), -200}, {-200, low.y(), 200}, {200, low.y(), 0}};
    const Vec3 across = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    const detail::RoundedBox box = detail::rounded_box(ball, pose);
    EXPECT_FALSE(detail::out_of_reach(box, corners, across, 0, 0x1p-20));
    const Vec3 lower[3] = {corners[0] - Vec3::UnitY() * 2e-3, corners[1] - Vec3::UnitY() * 2e-3,
                           corners[2] - Vec3::UnitY() * 2e-3};
    EXPECT_TRUE(detail::out_of_reach(box, lower, across, 0, 0x1p-20));
  }
}

}  // namespace
}  // namespace pd::test

// Casts and closest points through the world's broadphase.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "engine_glue/bullet_world.hpp"
#include "pd/bullet/world_queries.hpp"

namespace pd::test {
namespace {

btTransform at(double x, double y, double z, double turn = 0) {
  return btTransform(btQuaternion(btVector3(0, 0, 1), static_cast<btScalar>(turn)),
                     btVector3(static_cast<btScalar>(x), static_cast<btScalar>(y), static_cast<btScalar>(z)));
}

btBoxShape* sharp_box(BulletWorld& scene, double x, double y, double z) {
  auto* box =
      scene.shape<btBoxShape>(btVector3(static_cast<btScalar>(x), static_cast<btScalar>(y), static_cast<btScalar>(z)));
  box->setMargin(0);
  return box;
}

TEST(SweepTest, ABallMeetsTheNearerWall) {
  BulletWorld scene;
  btRigidBody* near = scene.body(sharp_box(scene, 0.001, 2, 2), 0, btVector3(3, 0, 0));
  scene.body(sharp_box(scene, 1, 2, 2), 0, btVector3(6, 0, 0));
  scene.world().updateAabbs();
  const btSphereShape ball(btScalar(0.5));
  const auto found = sweep_test(scene.world(), ball, at(0, 0, 0), at(10, 0, 0));
  ASSERT_TRUE(found.has_value());
  ASSERT_TRUE(found->hit.has_value());
  const SweepHit& hit = *found->hit;
  EXPECT_EQ(hit.object, near);
  EXPECT_NEAR(hit.fraction, 0.2499, 1e-6);
  EXPECT_NEAR(hit.normal.x(), -1, 1e-6);
  EXPECT_NEAR(hit.point_on_object.x(), 2.999, 1e-6);
  EXPECT_GT(hit.distance, 0);
  EXPECT_LE(hit.distance, 1e-6);
  EXPECT_FALSE(sweep_test(scene.world(), ball, at(0, 0, 0), at(2, 0, 0))->hit.has_value());
}

TEST(SweepTest, ALongRodTurnsIntoAPost) {
  BulletWorld scene;
  btRigidBody* post = scene.body(sharp_box(scene, 0.05, 0.05, 1), 0, btVector3(btScalar(0.9), btScalar(0.9), 0));
  scene.world().updateAabbs();
  auto* rod = sharp_box(scene, 2, 0.01, 0.01);
  // A right angle without moving: the post stands in the middle of the turn.
  const auto found = sweep_test(scene.world(), *rod, at(0, 0, 0), at(0, 0, 0, 1.5));
  ASSERT_TRUE(found.has_value() && found->hit.has_value());
  EXPECT_EQ(found->hit->object, post);
  // The rod's upper side at the post's corner (.95, .85): .95 sin t + .01 = .85 cos t ... as an angle of the corner.
  const double corner = std::atan2(0.85, 0.95) - std::asin(0.01 / std::hypot(0.85, 0.95));
  EXPECT_NEAR(found->hit->fraction, corner / 1.5, 1e-5);
  // A turn away from it.
  EXPECT_FALSE(sweep_test(scene.world(), *rod, at(0, 0, 0), at(0, 0, 0, -0.5))->hit.has_value());
}

TEST(SweepTest, FiltersAndCallbacksAsBulletsOwn) {
  BulletWorld scene;
  btRigidBody* near = scene.body(sharp_box(scene, 0.1, 2, 2), 0, btVector3(3, 0, 0));
  btRigidBody* far = scene.body(sharp_box(scene, 0.1, 2, 2), 0, btVector3(6, 0, 0));
  scene.world().updateAabbs();
  near->getBroadphaseHandle()->m_collisionFilterGroup = 64;
  const btSphereShape ball(btScalar(0.5));
  WorldQuerySettings settings;
  settings.filter_mask = ~64;
  EXPECT_EQ(sweep_test(scene.world(), ball, at(0, 0, 0), at(10, 0, 0), settings)->hit->object, far);
  btCollisionWorld::ClosestConvexResultCallback callback(btVector3(0, 0, 0), btVector3(10, 0, 0));
  const auto unanswered = sweep_test(scene.world(), ball, at(0, 0, 0), at(10, 0, 0), callback);
  ASSERT_TRUE(unanswered.has_value());
  EXPECT_EQ(*unanswered, 0);
  EXPECT_EQ(callback.m_hitCollisionObject, near);
  EXPECT_NEAR(static_cast<double>(callback.m_closestHitFraction), 0.24, 1e-5);
  EXPECT_NEAR(static_cast<double>(callback.m_hitNormalWorld.x()), -1, 1e-6);
  btCollisionWorld::ClosestConvexResultCallback bullet(btVector3(0, 0, 0), btVector3(10, 0, 0));
  scene.world().convexSweepTest(&ball, at(0, 0, 0), at(10, 0, 0), bullet);
  EXPECT_NEAR(static_cast<double>(bullet.m_closestHitFraction), static_cast<double>(callback.m_closestHitFraction),
              1e-3);
  callback.m_closestHitFraction = 1;
  callback.m_collisionFilterMask = ~64;
  (void)sweep_test(scene.world(), ball, at(0, 0, 0), at(10, 0, 0), callback);
  EXPECT_EQ(callback.m_hitCollisionObject, far);
}

TEST(SweepTest, TrianglesAndChildrenAreNamed) {
  BulletWorld scene;
  btTriangleMesh mesh;
  mesh.addTriangle(btVector3(-5, 0, -5), btVector3(-5, 0, 5), btVector3(0, 0, 0));
  mesh.addTriangle(btVector3(5, 0, 5), btVector3(5, 0, -5), btVector3(0, 0, 0));
  auto* ground = scene.shape<btBvhTriangleMeshShape>(&mesh, true);
  ground->setMargin(0);
  scene.body(ground, 0, btVector3(0, 0, 0));
  auto* compound = scene.shape<btCompoundShape>();
  auto* box = sharp_box(scene, 0.5, 0.5, 0.5);
  compound->addChildShape(at(0, 0, 0), box);
  compound->addChildShape(at(2, 0, 0), box);
  btRigidBody* pair = scene.body(compound, 0, btVector3(20, 0, 0));
  scene.world().updateAabbs();
  const btSphereShape ball(btScalar(0.25));
  const auto fallen = sweep_test(scene.world(), ball, at(3, 4, 0.1), at(3, -4, 0.1));
  ASSERT_TRUE(fallen->hit.has_value());
  EXPECT_EQ(fallen->hit->index, 1);
  EXPECT_EQ(fallen->hit->part, 0);
  EXPECT_NEAR(fallen->hit->fraction, 3.75 / 8, 1e-6);
  EXPECT_NEAR(fallen->hit->normal.y(), 1, 1e-6);
  const auto child = sweep_test(scene.world(), ball, at(22, 4, 0), at(22, 0, 0));
  ASSERT_TRUE(child->hit.has_value());
  EXPECT_EQ(child->hit->object, pair);
  EXPECT_EQ(child->hit->index, 1);
  EXPECT_EQ(child->hit->part, -1);
}

TEST(SweepTest, OverlapAtTheStartAndWhatHasNoBody) {
  BulletWorld scene;
  scene.body(sharp_box(scene, 1, 1, 1), 0, btVector3(0, 0, 0));
  const btVector3 centres[2] = {btVector3(0, 0, 0), btVector3(1, 0, 0)};
  const btScalar radii[2] = {btScalar(0.5), btScalar(0.25)};
  auto* uneven = scene.shape<btMultiSphereShape>(centres, radii, 2);
  uneven->setLocalScaling(btVector3(1, 1, btScalar(1.5)));
  scene.body(uneven, 0, btVector3(5, 0, 0));
  scene.world().updateAabbs();
  const btSphereShape ball(btScalar(0.5));
  const auto inside = sweep_test(scene.world(), ball, at(1.25, 0, 0), at(9, 0, 0));
  ASSERT_TRUE(inside->hit.has_value());
  EXPECT_EQ(inside->hit->fraction, 0);
  EXPECT_NEAR(inside->hit->distance, -0.25, 1e-6);
  EXPECT_EQ(inside->unanswered, 1);
  const auto refused = sweep_test(scene.world(), *uneven, at(0, 0, 0), at(1, 0, 0));
  ASSERT_FALSE(refused.has_value());
  EXPECT_EQ(refused.error().code, ErrorCode::unsupported);
}

TEST(DistanceTest, TheNearestWithinReach) {
  BulletWorld scene;
  scene.body(sharp_box(scene, 1, 1, 1), 0, btVector3(0, 0, 0));
  btRigidBody* ball = scene.body(scene.shape<btSphereShape>(btScalar(0.5)), 0, btVector3(4, 0, 0));
  scene.world().updateAabbs();
  const btSphereShape probe(btScalar(0.25));
  const auto found = distance_test(scene.world(), probe, at(2.75, 0, 0), 10);
  ASSERT_TRUE(found.has_value() && found->nearest.has_value());
  EXPECT_EQ(found->nearest->object, ball);
  EXPECT_NEAR(found->nearest->distance, 0.5, 1e-6);
  EXPECT_NEAR(found->nearest->point_on_shape.x(), 3, 1e-6);
  EXPECT_NEAR(found->nearest->point_on_object.x(), 3.5, 1e-6);
  EXPECT_NEAR(found->nearest->normal.x(), -1, 1e-6);
  EXPECT_FALSE(distance_test(scene.world(), probe, at(2.75, 0, 0), 0.25)->nearest.has_value());
  const auto inside = distance_test(scene.world(), probe, at(1, 0, 0), 0.1);
  ASSERT_TRUE(inside->nearest.has_value());
  EXPECT_NEAR(inside->nearest->distance, -0.25, 1e-6);
}

/// Counts the triangles that it hands out.
struct CountedMesh : btBvhTriangleMeshShape {
  explicit CountedMesh(btStridingMeshInterface* triangles) : btBvhTriangleMeshShape(triangles, true) {}
  void processAllTriangles(btTriangleCallback* callback, const btVector3& lower,
                           const btVector3& upper) const override {
    struct Counter : btTriangleCallback {
      btTriangleCallback* inner = nullptr;
      int count = 0;
      void processTriangle(btVector3* corners, int part, int index) override {
        ++count;
        inner->processTriangle(corners, part, index);
      }
    } counter;
    counter.inner = callback;
    btBvhTriangleMeshShape::processAllTriangles(&counter, lower, upper);
    handed_out += counter.count;
  }
  mutable int handed_out = 0;
};

/// A bumpy field of 40 x 40 squares of 1 m, two triangles each.
struct Field {
  Field() {
    const auto corner = [](int i, int j) {
      return btVector3(static_cast<btScalar>(i), static_cast<btScalar>((7 * i + 3 * j) % 5) * btScalar(0.1),
                       static_cast<btScalar>(j));
    };
    for (int i = 0; i < 40; ++i) {
      for (int j = 0; j < 40; ++j) {
        add(corner(i, j), corner(i, j + 1), corner(i + 1, j));
        add(corner(i + 1, j), corner(i, j + 1), corner(i + 1, j + 1));
      }
    }
    mesh = scene.shape<CountedMesh>(&triangles);
    mesh->setMargin(0);
    scene.body(mesh, 0, btVector3(0, 0, 0));
    scene.world().updateAabbs();
  }
  void add(const btVector3& a, const btVector3& b, const btVector3& c) {
    triangles.addTriangle(a, b, c);
    corners.push_back({a, b, c});
  }
  btTriangleMesh triangles;
  std::vector<std::array<btVector3, 3>> corners;
  BulletWorld scene;
  CountedMesh* mesh = nullptr;
};

TEST(DistanceTest, WhatLiesFartherThanTheAnswerIsNotAsked) {
  Field field;
  const btBoxShape probe(btVector3(btScalar(0.3), btScalar(0.1), btScalar(0.2)));
  for (const double height : {0.7, 1.5, 4.0, 30.0, 400.0}) {
    SCOPED_TRACE(height);
    const btTransform pose = at(17.3, height, 22.6, 0.4);
    // By the answer's own distance: there and no nearer.
    const auto far = distance_test(field.scene.world(), probe, pose, HUGE_VAL);
    ASSERT_TRUE(far.has_value() && far->nearest.has_value());
    const double distance = far->nearest->distance;
    const auto near = distance_test(field.scene.world(), probe, pose, distance * 1.001 + 1e-6);
    ASSERT_TRUE(near->nearest.has_value());
    EXPECT_EQ(near->nearest->distance, distance);
    EXPECT_FALSE(distance_test(field.scene.world(), probe, pose, distance * 0.999 - 1e-6)->nearest.has_value());
    EXPECT_LT(distance, height);
    EXPECT_GT(distance, height - 0.8);
  }
  field.mesh->handed_out = 0;
  ASSERT_TRUE(distance_test(field.scene.world(), probe, at(17.3, 0.7, 22.6, 0.4), HUGE_VAL)->nearest.has_value());
  EXPECT_GT(field.mesh->handed_out, 0);
  EXPECT_LT(field.mesh->handed_out, 200) << "of 3,200 triangles";
}

TEST(SweepTest, AWayAlongAMeshAsksTheTrianglesBesideItAlone) {
  Field field;
  const btBoxShape probe(btVector3(btScalar(0.3), btScalar(0.1), btScalar(0.2)));
  const btTransform from = at(2.2, 1.6, 2.7, 0.4), to = at(37.1, -0.9, 36.6, 1.9);
  const auto whole = sweep_test(field.scene.world(), probe, from, to);
  ASSERT_TRUE(whole.has_value() && whole->hit.has_value());
  EXPECT_GT(field.mesh->handed_out, 0);
  EXPECT_LT(field.mesh->handed_out, 800) << "of 3,200 triangles";
  // Each triangle by itself, as a body of its own, and the first of them all.
  double first = 1;
  int index = -1;
  for (int i = 0; i < field.triangles.getNumTriangles(); ++i) {
    const auto& corners = field.corners[static_cast<std::size_t>(i)];
    if (std::abs(corners[0].x() - corners[0].z()) > 4) continue;  // the way keeps to the diagonal
    BulletWorld one;
    btTriangleMesh triangle;
    triangle.addTriangle(corners[0], corners[1], corners[2]);
    auto* mesh = one.shape<btBvhTriangleMeshShape>(&triangle, true);
    mesh->setMargin(0);
    one.body(mesh, 0, btVector3(0, 0, 0));
    one.world().updateAabbs();
    const auto hit = sweep_test(one.world(), probe, from, to)->hit;
    if (hit && hit->fraction < first) {
      first = hit->fraction;
      index = i;
    }
  }
  EXPECT_NEAR(whole->hit->fraction, first, 1e-6);
  EXPECT_GE(index, 0);
}

TEST(SweepTest, WaysOfAnyLengthMeetAMesh) {
  // Places on the way are rounded to more than the shape's size, so that no stretch of the way is as short as that.
  Field field;
  const btSphereShape ball(btScalar(0.25));
  for (const double far : {1e3, 1e6, 1e9, 1e12, 1e15}) {
    const auto found = sweep_test(field.scene.world(), ball, at(-far, far, 20.3), at(far, -far, 20.3));
    ASSERT_TRUE(found.has_value());
    ASSERT_TRUE(found->hit.has_value()) << far;
    EXPECT_NEAR(found->hit->fraction, 0.5, 1e-2) << far;
  }
}

}  // namespace
}  // namespace pd::test

// Friction holds what it held: creep, towers, slopes, and that nothing that should slide or roll is held.
#include <gtest/gtest.h>

#include <cmath>

#include "pd/bullet/scalar.hpp"
#include "scenes/bullet/bullet_scene.hpp"
#include "scenes/contact_worlds.hpp"

namespace pd::test {
namespace {

using scenes::BulletScene;
using scenes::ContactRun;
using scenes::ContactScene;

Vec3 place(BulletScene& scene, int i) { return to_pd(scene.body(i).getWorldTransform().getOrigin()); }

void run(BulletScene& scene, double steps_per_second, double seconds) {
  for (int i = 0; i < std::lround(seconds * steps_per_second); ++i) {
    scene.step(steps_per_second);
  }
}

/// How far the farthest body is from where it started.
double drift(BulletScene& scene) {
  double farthest = 0;
  for (int i = 0; i < scene.num_bodies(); ++i) {
    farthest = std::max(farthest, (place(scene, i) - scene.plan(i).position).norm());
  }
  return farthest;
}

class Creep : public ::testing::TestWithParam<ContactRun> {};

TEST_P(Creep, BoxOnASlopeStaysForAMinute) {
  BulletScene scene(scenes::slope(0.4, 0.8, false, 0).world, GetParam());
  run(scene, 60, 2);
  const Vec3 settled = place(scene, 1);
  run(scene, 60, 60);
  EXPECT_LT((place(scene, 1) - settled).norm(), 2e-5);  // .0036 without anchors
}

TEST_P(Creep, BoxOnASlopeOfTrianglesStays) {
  BulletScene scene(scenes::slope(0.4, 0.8, true, 0).world, GetParam());
  run(scene, 60, 2);
  const Vec3 settled = place(scene, 1);
  run(scene, 60, 20);
  EXPECT_LT((place(scene, 1) - settled).norm(), 5e-5);  // .01 without anchors
}

INSTANTIATE_TEST_SUITE_P(BoxesAndHulls, Creep, ::testing::Values(ContactRun::pdepth, ContactRun::pdepth_hulls));

TEST(Friction, PyramidAtBulletsDefaults) {
  BulletScene scene(scenes::pyramid(10, 0).world, ContactRun::pdepth);
  run(scene, 60, 8);
  EXPECT_LT(drift(scene), 0.03);
}

/// The box's speed down a slope of `share` of the angle at which friction gives way, after two seconds.
double speed_on_slope(double share) {
  const double friction = 0.7;
  const double limit = friction * friction;  // Bullet multiplies the two bodies' coefficients
  const double angle = share * std::atan(limit);
  BulletScene scene(scenes::slope(angle, friction, false, 0).world, ContactRun::pdepth);
  run(scene, 240, 2);
  return static_cast<double>(scene.body(1).getLinearVelocity().length());
}

TEST(Friction, GivesWayAtCoulombsLimit) {
  EXPECT_LT(speed_on_slope(0.98), 1e-3);
  for (const double share : {1.02, 1.2}) {
    const double limit = 0.49;
    const double angle = share * std::atan(limit);
    const double expected = 2 * 9.81 * (std::sin(angle) - limit * std::cos(angle));
    EXPECT_NEAR(speed_on_slope(share), expected, 0.03 * expected + 0.005) << share;
  }
}

TEST(Friction, BrakingWay) {
  scenes::World world;
  world.friction = 0.7;
  scenes::WorldBody ground;
  ground.kind = scenes::WorldBody::Kind::box;
  ground.half_extents = Vec3(20, 20, 1);
  ground.position = Vec3(0, 0, -1);
  scenes::WorldBody body = ground;
  body.half_extents = Vec3(0.5, 0.5, 0.25);
  body.position = Vec3(0, 0, 0.25);
  body.mass = 1;
  body.linear_velocity = Vec3(3.5, 0, 0);
  world.bodies = {ground, body};
  BulletScene scene(world, ContactRun::pdepth);
  run(scene, 240, 3);
  const double theory = 3.5 * 3.5 / (2 * 0.49 * 9.81);
  EXPECT_NEAR(place(scene, 1).x(), theory, 0.03 * theory);
}

TEST(Friction, RollingWheelKeepsItsSpeed) {
  BulletScene scene(scenes::rolling_cylinder(0).world, ContactRun::pdepth);
  run(scene, 60, 5);
  EXPECT_NEAR(static_cast<double>(scene.body(1).getLinearVelocity().x()), 3, 3e-3);
}

/// A box on a ground whose surface moves, by Bullet's contact motion.
bool drive(btManifoldPoint& point, const btCollisionObjectWrapper*, int, int, const btCollisionObjectWrapper*, int,
           int) {
  point.m_contactPointFlags |= BT_CONTACT_FLAG_LATERAL_FRICTION_INITIALIZED;
  point.m_lateralFrictionDir1 = btVector3(1, 0, 0);
  point.m_lateralFrictionDir2 = btVector3(0, 1, 0);
  point.m_contactMotion1 = point.m_contactMotion2 = 0;
  point.m_contactMotion1 = btScalar(0.5);
  return true;
}

TEST(Friction, ConveyorBeltsCarryOn) {
  double speed[2];
  for (const ContactRun way : {ContactRun::bullet_best, ContactRun::pdepth}) {
    BulletScene scene(scenes::slope(0, 0.8, false, 0).world, way);
    scene.world().getSolverInfo().m_solverMode |=
        SOLVER_ENABLE_FRICTION_DIRECTION_CACHING | SOLVER_USE_2_FRICTION_DIRECTIONS;
    scene.body(0).setCollisionFlags(scene.body(0).getCollisionFlags() | btCollisionObject::CF_CUSTOM_MATERIAL_CALLBACK);
    gContactAddedCallback = drive;
    run(scene, 60, 4);
    gContactAddedCallback = nullptr;
    speed[way == ContactRun::pdepth] = static_cast<double>(scene.body(1).getLinearVelocity().x());
  }
  EXPECT_NEAR(std::abs(speed[0]), 0.5, 0.02);
  EXPECT_NEAR(speed[1], speed[0], 0.02);
}

TEST(Friction, BodiesThatAskForAnchorsHoldToo) {
  BulletScene scene(scenes::slope(0.4, 0.8, false, 0).world, ContactRun::pdepth);
  scene.body(1).setCollisionFlags(scene.body(1).getCollisionFlags() | btCollisionObject::CF_HAS_FRICTION_ANCHOR);
  run(scene, 60, 2);
  const Vec3 settled = place(scene, 1);
  run(scene, 60, 60);
  EXPECT_LT((place(scene, 1) - settled).norm(), 2e-5);
}

TEST(Friction, AnchorsLeaveDepthAndNormalAlone) {
  BulletScene scene(scenes::slope(0.4, 0.8, false, 0).world, ContactRun::pdepth);
  run(scene, 60, 3);
  const btPersistentManifold* manifold = scene.dispatcher().getManifoldByIndexInternal(0);
  const btVector3 up(std::sin(btScalar(0.4)), 0, std::cos(btScalar(0.4)));
  int anchored = 0;
  for (int k = 0; k < manifold->getNumContacts(); ++k) {
    const btManifoldPoint& point = manifold->getContactPoint(k);
    anchored += (point.m_contactPointFlags & BT_CONTACT_FLAG_FRICTION_ANCHOR) != 0 ? 1 : 0;
    EXPECT_GT(static_cast<double>(std::abs(point.m_normalWorldOnB.dot(up))), 0.999999);
    // The point on B lies on the slope, and the distance is what lies between the surfaces.
    const btScalar across = (point.m_positionWorldOnA - point.m_positionWorldOnB).dot(point.m_normalWorldOnB);
    EXPECT_NEAR(static_cast<double>(across), static_cast<double>(point.getDistance()), 1e-6);
  }
  EXPECT_EQ(manifold->getNumContacts(), 4);
  EXPECT_GE(anchored, 2);  // the upper points carry less, and friction gives way there first
}

}  // namespace
}  // namespace pd::test

/// @file
/// Worlds beside plain rigid bodies, the same program against Bullet's algorithms and ours: GImpact meshes, cloth in a
/// soft/rigid world, Featherstone arms against each other and against rigid bodies.
#include <BulletCollision/Gimpact/btGImpactCollisionAlgorithm.h>
#include <BulletCollision/Gimpact/btGImpactShape.h>
#include <BulletDynamics/Featherstone/btMultiBody.h>
#include <BulletDynamics/Featherstone/btMultiBodyConstraintSolver.h>
#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>
#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>
#include <BulletSoftBody/btSoftBodyHelpers.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <memory>
#include <utility>
#include <vector>

#include "engine_glue/bullet_world.hpp"
#include "pd/bullet/install.hpp"

namespace pd::test {
namespace {

constexpr btScalar kStep = btScalar(1.0 / 60);

btVector3 vector(double x, double y, double z) {
  return btVector3(static_cast<btScalar>(x), static_cast<btScalar>(y), static_cast<btScalar>(z));
}
btTransform at(double x, double y, double z) { return btTransform(btQuaternion::getIdentity(), vector(x, y, z)); }
double height_of(const btCollisionObject& body) {
  return static_cast<double>(body.getWorldTransform().getOrigin().y());
}

// GImpact: a mesh that moves. Bullet decides its pairs; of ours it asks the pairs of its triangles with convex shapes.

enum class Installed { never, before_gimpact, after_gimpact };

/// A cube of 1 m as twelve triangles falls on a floor, and a box on it. @return their heights after four seconds.
std::array<double, 2> heights_on_gimpact(Installed installed) {
  static const btScalar corners[8][3] = {
      {btScalar(-.5), btScalar(-.5), btScalar(-.5)}, {btScalar(.5), btScalar(-.5), btScalar(-.5)},
      {btScalar(.5), btScalar(.5), btScalar(-.5)},   {btScalar(-.5), btScalar(.5), btScalar(-.5)},
      {btScalar(-.5), btScalar(-.5), btScalar(.5)},  {btScalar(.5), btScalar(-.5), btScalar(.5)},
      {btScalar(.5), btScalar(.5), btScalar(.5)},    {btScalar(-.5), btScalar(.5), btScalar(.5)}};
  static const int faces[12][3] = {{0, 2, 1}, {0, 3, 2}, {4, 5, 6}, {4, 6, 7}, {0, 1, 5}, {0, 5, 4},
                                   {3, 6, 2}, {3, 7, 6}, {0, 4, 7}, {0, 7, 3}, {1, 2, 6}, {1, 6, 5}};
  btTriangleMesh mesh;
  for (const auto& face : faces) {
    btVector3 points[3];
    for (int i = 0; i < 3; ++i) points[i].setValue(corners[face[i]][0], corners[face[i]][1], corners[face[i]][2]);
    mesh.addTriangle(points[0], points[1], points[2]);
  }
  BulletPenetrationDepthSolver solver;
  BulletWorld scene;
  if (installed == Installed::before_gimpact) install(scene.world(), solver);
  btGImpactCollisionAlgorithm::registerAlgorithm(&scene.dispatcher());
  if (installed == Installed::after_gimpact) install(scene.world(), solver);
  auto* cube = scene.shape<btGImpactMeshShape>(&mesh);
  cube->setMargin(btScalar(0.01));
  cube->updateBound();
  scene.body(scene.shape<btBoxShape>(vector(10, 1, 10)), 0, at(0, -1, 0));
  btRigidBody* lower = scene.body(cube, 1, at(0, 0.6, 0));
  btRigidBody* upper = scene.body(scene.shape<btBoxShape>(vector(0.3, 0.3, 0.3)), 1, at(0.02, 1.5, 0.01));
  for (int i = 0; i < 240; ++i) scene.world().stepSimulation(kStep, 0);
  return {height_of(*lower), height_of(*upper)};
}

TEST(OtherWorlds, GImpactMeshesRestWhereBulletsDo) {
  const auto bullet = heights_on_gimpact(Installed::never);
  const auto first = heights_on_gimpact(Installed::before_gimpact);
  const auto later = heights_on_gimpact(Installed::after_gimpact);
  for (const auto& ours : {first, later}) {
    EXPECT_NEAR(ours[0], 0.5, 0.03);
    EXPECT_NEAR(ours[1], 1.3, 0.05);
    EXPECT_NEAR(ours[0], bullet[0], 0.03);
    EXPECT_NEAR(ours[1], bullet[1], 0.05);
  }
  std::printf("heights of cube and box: Bullet %.4f %.4f, ours %.4f %.4f and %.4f %.4f\n", bullet[0], bullet[1],
              first[0], first[1], later[0], later[1]);
}

// Cloth.

struct ClothWorld {
  std::vector<btVector3> nodes;  ///< of the cloth
  btVector3 ball;                ///< that lies in it
  double brick = 0;              ///< height of the upper of two bricks beside it
  std::int64_t calls = 0;
};

ClothWorld cloth_after_three_seconds(bool ours) {
  BulletPenetrationDepthSolver solver;
  btSoftBodyRigidBodyCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher(&configuration);
  btDbvtBroadphase broadphase;
  btSequentialImpulseConstraintSolver constraints;
  btSoftRigidDynamicsWorld world(&dispatcher, &broadphase, &constraints, &configuration);
  world.setGravity(vector(0, -9.81, 0));
  world.getWorldInfo().m_gravity = world.getGravity();
  world.getWorldInfo().m_sparsesdf.Initialize();
  if (ours) {
    EXPECT_TRUE(install(world, solver));
  }
  btSphereShape ball_shape(btScalar(0.8));
  btBoxShape brick_shape(vector(0.5, 0.25, 0.5)), floor_shape(vector(10, 1, 10));
  btVector3 inertia;
  std::vector<std::unique_ptr<btRigidBody>> bodies;
  const auto add = [&](btCollisionShape& shape, btScalar mass, const btTransform& pose) {
    inertia.setZero();
    if (mass > 0) shape.calculateLocalInertia(mass, inertia);
    bodies.push_back(std::make_unique<btRigidBody>(mass, nullptr, &shape, inertia));
    bodies.back()->setWorldTransform(pose);
    bodies.back()->setActivationState(DISABLE_DEACTIVATION);
    world.addRigidBody(bodies.back().get());
    return bodies.back().get();
  };
  add(floor_shape, 0, at(0, -1, 0));
  btRigidBody* ball = add(ball_shape, btScalar(0.2), at(0.1, 7.2, 0.05));
  add(brick_shape, 1, at(5, 0.25, 0));
  btRigidBody* brick = add(brick_shape, 1, at(5.2, 0.75, 0));
  btSoftBody* cloth = btSoftBodyHelpers::CreatePatch(world.getWorldInfo(), vector(-2, 6, -2), vector(2, 6, -2),
                                                     vector(-2, 6, 2), vector(2, 6, 2), 21, 21, 1 + 2 + 4 + 8, true);
  cloth->setTotalMass(btScalar(0.5));
  world.addSoftBody(cloth);
  for (int i = 0; i < 180; ++i) world.stepSimulation(kStep, 0);
  ClothWorld result;
  for (int i = 0; i < cloth->m_nodes.size(); ++i) result.nodes.push_back(cloth->m_nodes[i].m_x);
  result.ball = ball->getWorldTransform().getOrigin();
  result.brick = height_of(*brick);
  result.calls = solver.statistics().calls;
  world.removeSoftBody(cloth);
  delete cloth;
  for (const auto& body : bodies) world.removeRigidBody(body.get());
  return result;
}

/// Soft bodies are Bullet's own, bit for bit; rigid pairs of the same world are ours.
TEST(OtherWorlds, ClothIsBulletsAndBricksAreOurs) {
  const ClothWorld bullet = cloth_after_three_seconds(false);
  const ClothWorld ours = cloth_after_three_seconds(true);
  ASSERT_EQ(bullet.nodes.size(), ours.nodes.size());
  int different = 0;
  for (std::size_t i = 0; i < ours.nodes.size(); ++i) {
    different += std::memcmp(&bullet.nodes[i], &ours.nodes[i], 3 * sizeof(btScalar)) != 0;
  }
  EXPECT_EQ(different, 0);
  EXPECT_EQ(std::memcmp(&bullet.ball, &ours.ball, 3 * sizeof(btScalar)), 0);
  EXPECT_GT(static_cast<double>(ours.ball.y()), 3);  // the cloth holds it, far above the floor
  EXPECT_NEAR(ours.brick, 0.75, 0.01);
  EXPECT_EQ(bullet.calls, 0);
  EXPECT_GT(ours.calls, 300);
}

// Featherstone arms.

/// A base and links of boxes, 1 m each, on hinges.
class Arm {
 public:
  Arm(btMultiBodyDynamicsWorld& world, btBoxShape& link_shape, int links, const btVector3& base, const btVector3& hinge,
      const btVector3& along)
      : world_(world) {
    btVector3 inertia;
    link_shape.calculateLocalInertia(1, inertia);
    body_ = std::make_unique<btMultiBody>(links, 1, inertia, false, false);
    body_->setBasePos(base);
    const btVector3 half = along * btScalar(0.5);
    for (int link = 0; link < links; ++link) {
      body_->setupRevolute(link, 1, inertia, link - 1, btQuaternion::getIdentity(), hinge, half, half, true);
    }
    body_->finalizeMultiDof();
    body_->setCanSleep(false);
    world_.addMultiBody(body_.get());
    for (int link = -1; link < links; ++link) {
      auto collider = std::make_unique<btMultiBodyLinkCollider>(body_.get(), link);
      collider->setCollisionShape(&link_shape);
      collider->setWorldTransform(
          btTransform(btQuaternion::getIdentity(), base + along * static_cast<btScalar>(link + 1)));
      world_.addCollisionObject(collider.get(), btBroadphaseProxy::DefaultFilter, btBroadphaseProxy::AllFilter);
      if (link < 0) {
        body_->setBaseCollider(collider.get());
      } else {
        body_->getLink(link).m_collider = collider.get();
      }
      colliders_.push_back(std::move(collider));
    }
  }
  ~Arm() {
    for (const auto& collider : colliders_) world_.removeCollisionObject(collider.get());
    world_.removeMultiBody(body_.get());
  }
  Arm(const Arm&) = delete;
  Arm& operator=(const Arm&) = delete;

  [[nodiscard]] double lowest() const {
    double least = 1e30;
    for (const auto& collider : colliders_) least = std::min(least, height_of(*collider));
    return least;
  }
  [[nodiscard]] double fastest() const {
    double most = 0;
    for (int i = 0; i < body_->getNumLinks(); ++i) {
      most = std::max(most, std::abs(static_cast<double>(body_->getJointVel(i))));
    }
    return std::max(most, static_cast<double>(body_->getBaseVel().length()));
  }

 private:
  btMultiBodyDynamicsWorld& world_;
  std::unique_ptr<btMultiBody> body_;
  std::vector<std::unique_ptr<btMultiBodyLinkCollider>> colliders_;
};

struct ArmsAtRest {
  double lower = 0;  ///< least heights of links and of the brick
  double upper = 0;
  double brick = 0;
  double speed = 0;    ///< of the fastest joint
  double deepest = 0;  ///< contact at the end
  std::int64_t calls = 0;
};

/// An arm falls on a floor, a second one across it, a brick on that.
ArmsAtRest arms_after_four_seconds(bool ours) {
  BulletPenetrationDepthSolver solver;
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher(&configuration);
  btDbvtBroadphase broadphase;
  btMultiBodyConstraintSolver constraints;
  btMultiBodyDynamicsWorld world(&dispatcher, &broadphase, &constraints, &configuration);
  world.setGravity(vector(0, -9.81, 0));
  if (ours) install(world, solver);
  btBoxShape floor_shape(vector(10, 1, 10)), along_x(vector(0.45, 0.1, 0.1)), along_z(vector(0.1, 0.1, 0.45));
  btBoxShape brick_shape(vector(0.4, 0.1, 0.6));
  btRigidBody floor(0, nullptr, &floor_shape);
  floor.setWorldTransform(at(0, -1, 0));
  world.addRigidBody(&floor);
  btVector3 inertia;
  brick_shape.calculateLocalInertia(1, inertia);
  btRigidBody brick(1, nullptr, &brick_shape, inertia);
  brick.setWorldTransform(at(1, 0.9, 0));
  brick.setActivationState(DISABLE_DEACTIVATION);
  world.addRigidBody(&brick);
  ArmsAtRest result;
  {
    const Arm lower(world, along_x, 2, vector(0, 0.15, 0), vector(0, 0, 1), vector(1, 0, 0));
    const Arm upper(world, along_z, 2, vector(1, 0.5, -1), vector(1, 0, 0), vector(0, 0, 1));
    for (int i = 0; i < 240; ++i) world.stepSimulation(kStep, 0);
    result = {lower.lowest(), upper.lowest(), height_of(brick), std::max(lower.fastest(), upper.fastest()), 0, 0};
    for (int i = 0; i < dispatcher.getNumManifolds(); ++i) {
      const btPersistentManifold& manifold = *dispatcher.getManifoldByIndexInternal(i);
      for (int k = 0; k < manifold.getNumContacts(); ++k) {
        result.deepest = std::max(result.deepest, -static_cast<double>(manifold.getContactPoint(k).getDistance()));
      }
    }
  }
  result.calls = solver.statistics().calls;
  world.removeRigidBody(&brick);
  world.removeRigidBody(&floor);
  return result;
}

TEST(OtherWorlds, FeatherstoneArmsAgainstEachOtherAndBricks) {
  const ArmsAtRest bullet = arms_after_four_seconds(false);
  const ArmsAtRest ours = arms_after_four_seconds(true);
  for (const auto& [name, rest] : {std::pair{"Bullet", bullet}, std::pair{"ours", ours}}) {
    std::printf("%s: arms %.4f and %.4f, brick %.4f, speed %.2g, deepest %.2g, %lld queries\n", name, rest.lower,
                rest.upper, rest.brick, rest.speed, rest.deepest, static_cast<long long>(rest.calls));
  }
  EXPECT_NEAR(ours.lower, 0.1, 0.01);
  EXPECT_GT(ours.upper, 0.09);  // its middle lies on the lower arm, its ends hang down to the floor at most
  EXPECT_NEAR(ours.brick, bullet.brick, 0.05);
  EXPECT_LE(ours.deepest, std::max(bullet.deepest, 0.005));
  EXPECT_LE(ours.speed, std::max(bullet.speed, 0.01));
  EXPECT_GT(ours.calls, 240);
}

}  // namespace
}  // namespace pd::test

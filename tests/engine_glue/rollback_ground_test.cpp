// RollbackStepper has a budget of Bullet's steps and queries on meshes and heightfields: each first contact takes the
// step that met it, a shorter one or two that end before it, and one for the rest.
#include <BulletCollision/CollisionShapes/btHeightfieldTerrainShape.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <memory>
#include <vector>

#include "engine_glue/bullet_world.hpp"
#include "pd/bullet/install.hpp"
#include "pd/bullet/rollback.hpp"

namespace pd::test {
namespace {

const btScalar kStep = btScalar(1.0 / 60);

struct Cost {
  int steps = 0;
  int cuts = 0;
  int parts = 0;
  std::int64_t queries = 0;  ///< of Bullet's narrow phase
};

Cost run(BulletWorld& scene, int frames) {
  BulletPenetrationDepthSolver solver;
  install(scene.world(), solver);
  RollbackStepper stepper(scene.world(), solver);
  Cost cost;
  for (int i = 0; i < frames; ++i) {
    const RollbackReport report = stepper.step(kStep);
    cost.steps += report.simulation_steps - 1;
    cost.cuts += report.parts - 1;
    cost.parts += report.parts;
    EXPECT_FALSE(report.bounded);
  }
  cost.queries = static_cast<std::int64_t>(solver.statistics().calls);
  return cost;
}

btVector3 place(double x, double y, double z) {
  return btVector3(static_cast<btScalar>(x), static_cast<btScalar>(y), static_cast<btScalar>(z));
}

TEST(RollbackGround, BoxesOnARidge) {
  constexpr int kSide = 41;
  std::vector<btScalar> heights;  // Bullet reads PHY_FLOAT in its own precision
  for (int j = 0; j < kSide; ++j) {
    for (int i = 0; i < kSide; ++i) {
      heights.push_back(static_cast<btScalar>(2 - 0.5 * std::abs(i - 20) + 0.05 * std::sin(1.7 * j)));
    }
  }
  Cost all;
  for (int start = 0; start < 4; ++start) {
    BulletWorld scene;
    scene.body(scene.shape<btHeightfieldTerrainShape>(kSide, kSide, heights.data(), btScalar(1), btScalar(-10),
                                                      btScalar(10), 1, PHY_FLOAT, false),
               0, btVector3(0, 0, 0));
    auto* box = scene.shape<btBoxShape>(place(0.3, 0.3, 0.3));
    for (int i = 0; i < 10; ++i) {
      btRigidBody* body = scene.body(
          box, 1, place(0.05 * (i % 3) + 0.013 * i * start, 3 + 0.7 * (i / 5) + 0.1 * i, -4 + 1.8 * (i % 5)));
      body->setActivationState(DISABLE_DEACTIVATION);
    }
    const Cost cost = run(scene, 60);
    all.steps += cost.steps;
    all.cuts += cost.cuts;
    all.parts += cost.parts;
    all.queries += cost.queries;
  }
  // In double precision the boxes balance for longer, and fewer steps are cut.
  EXPECT_GT(all.cuts, sizeof(btScalar) == sizeof(float) ? 100 : 10);
  EXPECT_LT(all.steps, 3.3 * all.cuts) << all.steps << " steps for " << all.cuts << " cuts";
}

TEST(RollbackGround, WheelsOnWaves) {
  btTriangleMesh mesh;
  const auto corner = [](int i, int j) { return place(0.5 * i, 0.1 * std::sin(0.5 * i) * std::cos(0.5 * j), 0.5 * j); };
  for (int i = -20; i < 0; ++i) {
    for (int j = -6; j < 6; ++j) {
      mesh.addTriangle(corner(i, j), corner(i, j + 1), corner(i + 1, j + 1));
      mesh.addTriangle(corner(i, j), corner(i + 1, j + 1), corner(i + 1, j));
    }
  }
  Cost all;
  for (int start = 0; start < 4; ++start) {
    BulletWorld scene;
    scene.body(scene.shape<btBvhTriangleMeshShape>(&mesh, true), 0, btVector3(0, 0, 0))->setFriction(1);
    const btVector3 middle = place(-5 + 0.07 * start, 0.75, 0.03 * start);
    btRigidBody* car = scene.body(scene.shape<btBoxShape>(place(1, 0.2, 0.5)), 200, middle);
    car->setActivationState(DISABLE_DEACTIVATION);
    auto* wheel = scene.shape<btCylinderShapeZ>(place(0.35, 0.35, 0.1));
    std::vector<std::unique_ptr<btHingeConstraint>> axles;
    for (int k = 0; k < 4; ++k) {
      const btVector3 at = place(k % 2 != 0 ? 0.8 : -0.8, -0.35, k / 2 != 0 ? 0.75 : -0.75);
      btRigidBody* body = scene.body(wheel, 15, middle + at);
      body->setFriction(1);
      body->setActivationState(DISABLE_DEACTIVATION);
      axles.push_back(std::make_unique<btHingeConstraint>(*car, *body, at, btVector3(0, 0, 0), btVector3(0, 0, 1),
                                                          btVector3(0, 0, 1)));
      axles.back()->enableAngularMotor(true, -12, 20);
      scene.world().addConstraint(axles.back().get(), true);
    }
    const Cost cost = run(scene, 60);
    all.steps += cost.steps;
    all.cuts += cost.cuts;
    all.parts += cost.parts;
    all.queries += cost.queries;
    for (const auto& axle : axles) scene.world().removeConstraint(axle.get());
  }
  EXPECT_GT(all.cuts, 100);
  EXPECT_LT(all.steps, 3.5 * all.cuts) << all.steps << " steps for " << all.cuts << " cuts";
  // Trials of a part take what the first of them found: 13 queries a part, where each trial asked 25 of them before.
  EXPECT_LT(all.queries, 17 * all.parts) << all.queries << " queries for " << all.parts << " parts";
}

/// Two boxes that fall with a joint between them do not move by the law of free flight. The velocity that gravity adds
/// in a part is less in a shorter part, and a trial that is foreseen without that ends too early by half of g h^2.
TEST(RollbackGround, BodiesInAJointAreForeseenWithTheVelocityOfTheShorterPart) {
  int trials = 0;
  constexpr int kStarts = 8;
  for (int start = 0; start < kStarts; ++start) {
    BulletWorld scene;
    scene.body(scene.shape<btBoxShape>(place(10, 1, 10)), 0, place(0, -1, 0));
    auto* box = scene.shape<btBoxShape>(place(0.5, 0.5, 0.5));
    btRigidBody* low = scene.body(box, 1, place(0, 1 + 0.01 * start, 0));
    btRigidBody* high = scene.body(box, 2, place(1.5, 1.3 + 0.01 * start, 0));
    for (btRigidBody* body : {low, high}) body->setActivationState(DISABLE_DEACTIVATION);
    btPoint2PointConstraint joint(*low, *high, place(0.75, 0.15, 0), place(-0.75, -0.15, 0));
    scene.world().addConstraint(&joint, true);
    BulletPenetrationDepthSolver solver;
    install(scene.world(), solver);
    RollbackStepper stepper(scene.world(), solver);
    bool has_met = false;
    for (int i = 0; i < 30 && !has_met; ++i) {
      const RollbackReport report = stepper.step(kStep);
      has_met = report.contacts.size() > 0;
      if (has_met) trials += report.contacts[0].trials;
    }
    EXPECT_TRUE(has_met) << start;
    scene.world().removeConstraint(&joint);
  }
  EXPECT_LT(trials, 1.5 * kStarts);  // 23 where the shorter part was taken to be as fast as the longer one
}

}  // namespace
}  // namespace pd::test

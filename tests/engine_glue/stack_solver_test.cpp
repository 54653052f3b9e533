// pd::StackSolver: stacks that stand, and what Bullet's solver decides decided as there.
#include "pd/bullet/stack_solver.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "pd/bullet/install.hpp"
#include "pd/bullet/snapshot.hpp"
#include "pd/bullet/solver_settings.hpp"
#include "scenes/bullet/bullet_scene.hpp"
#include "scenes/contact_worlds.hpp"

namespace pd::test {
namespace {

using scenes::BulletScene;
using scenes::ContactRun;

/// Largest way of a body from its start after so many seconds, in body sizes.
double drift(const char* name, double rate, double seconds, StackSolverStatistics* statistics = nullptr) {
  scenes::ContactScene plan = scenes::contact_scene(name, 1);
  plan.world.solved_at_once = true;
  BulletScene scene(plan.world, ContactRun::pdepth);
  apply_recommended(scene.world().getSolverInfo());
  scene.world().getSolverInfo().m_numIterations = 10;
  for (int i = 0; i < static_cast<int>(seconds * rate); ++i) scene.step(rate);
  double most = 0;
  for (int i = 0; i < scene.num_bodies(); ++i) {
    const btVector3 at = scene.body(i).getWorldTransform().getOrigin();
    const Eigen::Vector3d& start = plan.world.bodies[static_cast<std::size_t>(i)].position;
    const Eigen::Vector3d now(static_cast<double>(at.x()), static_cast<double>(at.y()), static_cast<double>(at.z()));
    most = std::max(most, (now - start).norm() / plan.size);
  }
  if (statistics != nullptr) {
    *statistics = dynamic_cast<StackSolver&>(*scene.world().getConstraintSolver()).statistics();
  }
  return most;
}

TEST(StackSolver, TowersOfTwentyStandWhateverTheirSize) {
  EXPECT_LT(drift("tower-1m", 60, 10), 1e-3);
  EXPECT_LT(drift("tower-10cm", 60, 10), 1e-3);
  EXPECT_LT(drift("tower-1cm", 240, 4), 1e-3);
  StackSolverStatistics statistics;
  EXPECT_LT(drift("tower-1mm", 960, 1, &statistics), 1e-3);
  EXPECT_EQ(statistics.left, 0);
  EXPECT_EQ(statistics.unsettled, 0);
  EXPECT_LT(statistics.factorisations, 1.2 * static_cast<double>(statistics.groups));
}

TEST(StackSolver, AHeavyBoxOnLightOnesStands) { EXPECT_LT(drift("mass-ratio", 60, 5), 1e-3); }

/// One world of a floor and whatever a test adds.
struct StackWorld {
  explicit StackWorld(const StackSolverSettings& settings = {})
      : impulses(settings), world(&dispatcher, &broadphase, &impulses, &configuration) {
    install(world, solver);
    world.setGravity(btVector3(0, btScalar(-9.81), 0));
    add(btVector3(10, 1, 10), 0, btVector3(0, -1, 0));
  }
  ~StackWorld() {
    for (auto& joint : joints) world.removeConstraint(joint.get());
    for (auto& body : bodies) world.removeRigidBody(body.get());
  }
  btRigidBody& add(const btVector3& half, double mass, const btVector3& at) {
    shapes.push_back(std::make_unique<btBoxShape>(half));
    btVector3 inertia(0, 0, 0);
    if (mass > 0) shapes.back()->calculateLocalInertia(btScalar(mass), inertia);
    bodies.push_back(std::make_unique<btRigidBody>(btScalar(mass), nullptr, shapes.back().get(), inertia));
    btRigidBody& body = *bodies.back();
    body.setWorldTransform(btTransform(btQuaternion::getIdentity(), at));
    body.setActivationState(DISABLE_DEACTIVATION);
    world.addRigidBody(&body);
    return body;
  }
  void step(int count) {
    for (int i = 0; i < count; ++i) world.stepSimulation(btScalar(1) / 60, 0);
  }

  BulletPenetrationDepthSolver solver;
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase broadphase;
  StackSolver impulses;
  btDiscreteDynamicsWorld world;
  std::vector<std::unique_ptr<btBoxShape>> shapes;
  std::vector<std::unique_ptr<btRigidBody>> bodies;
  std::vector<std::unique_ptr<btTypedConstraint>> joints;
};

const btVector3 kHalf(btScalar(0.5), btScalar(0.5), btScalar(0.5));

TEST(StackSolver, GroupsThatAreTooLargeAreBulletsBitForBit) {
  StackSolverSettings none;
  none.max_bodies = 0;
  StackWorld stack(none);
  btSequentialImpulseConstraintSolver sequential;
  StackWorld bullet;
  bullet.world.setConstraintSolver(&sequential);
  for (StackWorld* each : {&stack, &bullet}) {
    for (int i = 0; i < 5; ++i) each->add(kHalf, 1, btVector3(btScalar(0.02 * i), btScalar(0.5 + i), 0));
    each->step(60);
  }
  EXPECT_GT(stack.impulses.statistics().left, 0);
  EXPECT_EQ(stack.impulses.statistics().groups, 0);
  for (std::size_t i = 0; i < stack.bodies.size(); ++i) {
    EXPECT_TRUE(stack.bodies[i]->getWorldTransform() == bullet.bodies[i]->getWorldTransform()) << i;
  }
}

TEST(StackSolver, FrictionHoldsAndLetsGoWhereItDoesUnderBullet) {
  for (const double tilt : {0.3, 0.6}) {  // tan: .31 and .68, friction .5
    StackWorld scene;
    btRigidBody& box = scene.add(kHalf, 1, btVector3(0, btScalar(0.5), 0));
    scene.bodies[0]->setFriction(1);
    box.setFriction(btScalar(0.5));
    scene.world.setGravity(btVector3(btScalar(9.81 * std::sin(tilt)), btScalar(-9.81 * std::cos(tilt)), 0));
    scene.step(60);
    const double expected = tilt < 0.4 ? 0 : 9.81 * (std::sin(tilt) - 0.5 * std::cos(tilt));
    EXPECT_NEAR(static_cast<double>(box.getLinearVelocity().x()), expected, 0.01) << tilt;
  }
}

TEST(StackSolver, BodiesThatMustNotTurnOrLeaveAPlaneObey) {
  StackWorld scene;
  for (int i = 0; i < 6; ++i) {
    btRigidBody& box = scene.add(kHalf, 1, btVector3(btScalar(0.2 * i), btScalar(0.5 + i), btScalar(0.1 * i)));
    if (i % 2 == 0) {
      box.setAngularFactor(0);
    } else {
      box.setLinearFactor(btVector3(1, 1, 0));
      box.setAngularFactor(btVector3(0, 0, 1));
    }
  }
  scene.step(120);
  EXPECT_GT(scene.impulses.statistics().groups, 0);
  for (int i = 0; i < 6; ++i) {
    const btRigidBody& box = *scene.bodies[static_cast<std::size_t>(i + 1)];
    const btVector3 spin = box.getAngularVelocity();
    EXPECT_EQ(spin.x(), 0);
    EXPECT_EQ(spin.y(), 0);
    if (i % 2 == 0) {
      EXPECT_EQ(spin.z(), 0);
    } else {
      EXPECT_EQ(box.getWorldTransform().getOrigin().z(), btScalar(0.1 * i));
    }
    EXPECT_GT(box.getWorldTransform().getOrigin().y(), 0);
  }
}

TEST(StackSolver, AChainOfJointsHoldsAWeightAHundredTimesItsLinks) {
  const auto stretched = [](bool ours) {
    StackWorld scene;
    btSequentialImpulseConstraintSolver sequential;
    if (!ours) scene.world.setConstraintSolver(&sequential);
    const btVector3 link(btScalar(0.05), btScalar(0.2), btScalar(0.05));
    btRigidBody* above = nullptr;
    for (int i = 0; i < 12; ++i) {
      const bool last = i == 11;
      btRigidBody& body = scene.add(link, last ? 100 : 1, btVector3(0, btScalar(8 - 0.4 * i), 0));
      const btVector3 top(0, btScalar(0.2), 0);
      if (above == nullptr) {
        scene.joints.push_back(std::make_unique<btPoint2PointConstraint>(body, top));
      } else {
        scene.joints.push_back(std::make_unique<btPoint2PointConstraint>(*above, body, -top, top));
      }
      scene.world.addConstraint(scene.joints.back().get(), true);
      above = &body;
    }
    scene.step(120);
    return 8 - 0.4 * 11 - static_cast<double>(above->getWorldTransform().getOrigin().y());
  };
  EXPECT_LT(stretched(true), 0.002);
  EXPECT_GT(stretched(false), 0.02);
}

TEST(StackSolver, TheSameBitsTwiceAndAfterASnapshot) {
  const auto poses = [](bool restored) {
    StackWorld scene;
    for (int i = 0; i < 8; ++i) scene.add(kHalf, 1, btVector3(btScalar(0.05 * (i % 3)), btScalar(0.6 + 1.1 * i), 0));
    scene.step(40);
    if (restored) {
      const BulletSnapshot snapshot(scene.world, &scene.solver);
      scene.step(7);
      EXPECT_EQ(snapshot.restore(), Restored::yes);
    }
    scene.step(40);
    std::vector<btTransform> result;
    for (const auto& body : scene.bodies) result.push_back(body->getWorldTransform());
    return result;
  };
  const auto first = poses(false);
  const auto second = poses(false);
  const auto third = poses(true);
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_TRUE(first[i] == second[i]) << i;
    EXPECT_TRUE(first[i] == third[i]) << i;
  }
}

TEST(StackSolver, ABodyWithoutNumbersSpoilsNoneOfAnotherGroup) {
  StackWorld scene;
  for (int i = 0; i < 3; ++i) scene.add(kHalf, 1, btVector3(0, btScalar(0.5 + i), 0));
  btRigidBody& broken = scene.add(kHalf, 1, btVector3(5, btScalar(0.5), 0));
  scene.add(kHalf, 1, btVector3(5, btScalar(1.5), 0));
  scene.step(5);
  broken.setLinearVelocity(btVector3(0, btScalar(NAN), 0));
  scene.step(1);
  EXPECT_GT(scene.impulses.statistics().unsettled, 0);
  for (int i = 1; i <= 3; ++i) {
    const btVector3 at = scene.bodies[static_cast<std::size_t>(i)]->getWorldTransform().getOrigin();
    EXPECT_NEAR(static_cast<double>(at.y()), i - 0.5, 1e-2) << i;
  }
}

TEST(StackSolver, ABallBouncesAsHighAsUnderBullet) {
  const auto fastest_rise = [](bool ours) {
    StackWorld scene;
    btSequentialImpulseConstraintSolver sequential;
    if (!ours) scene.world.setConstraintSolver(&sequential);
    btRigidBody& box = scene.add(kHalf, 1, btVector3(0, 3, 0));
    box.setRestitution(btScalar(0.8));
    scene.bodies[0]->setRestitution(1);
    double most = 0;
    for (int i = 0; i < 90; ++i) {
      scene.step(1);
      most = std::max(most, static_cast<double>(box.getLinearVelocity().y()));
    }
    return most;
  };
  EXPECT_NEAR(fastest_rise(true), fastest_rise(false), 1e-3);
}

/// Counts Bullet's sweeps.
class SweepCounter : public StackSolver {
 public:
  using StackSolver::StackSolver;
  int sweeps = 0;

 protected:
  btScalar solveSingleIteration(int iteration, btCollisionObject** bodies, int num_bodies,
                                btPersistentManifold** manifolds, int num_manifolds, btTypedConstraint** constraints,
                                int num_constraints, const btContactSolverInfo& info, btIDebugDraw* drawer) override {
    ++sweeps;
    return StackSolver::solveSingleIteration(iteration, bodies, num_bodies, manifolds, num_manifolds, constraints,
                                             num_constraints, info, drawer);
  }
};

/// Once a tower is solved, sweeps mend nothing. Where it is left to them, it gets all ten.
TEST(StackSolver, SweepsEndWhereTheyMendNothing) {
  for (const bool is_solved : {true, false}) {
    StackSolverSettings settings;
    if (!is_solved) settings.max_bodies = 0;
    StackWorld scene;
    SweepCounter counter(settings);
    scene.world.setConstraintSolver(&counter);
    for (int i = 0; i < 12; ++i) scene.add(kHalf, 1, btVector3(0, btScalar(0.5 + i), 0));
    scene.step(60);
    counter.sweeps = 0;
    scene.step(60);
    if (is_solved) {
      EXPECT_LE(counter.sweeps, 3 * 60);
    } else {
      EXPECT_EQ(counter.sweeps, 10 * 60);
    }
  }
}

/// A block of boxes that touch, dropped from two metres: Bullet's Basic Example.
void add_block(StackWorld& scene, int edge) {
  const btVector3 half(btScalar(0.1), btScalar(0.1), btScalar(0.1));
  for (int k = 0; k < edge; ++k) {
    for (int i = 0; i < edge; ++i) {
      for (int j = 0; j < edge; ++j) {
        scene.add(half, 1, btVector3(btScalar(0.2 * i), btScalar(2 + 0.2 * k), btScalar(0.2 * j)));
      }
    }
  }
}

/// A block that falls carries nothing, its landing comes and goes, and what lies on the floor is not high. Each
/// factorisation of the whole takes as long as some hundred sweeps.
TEST(StackSolver, LeavesBlocksThatFallToTheSweeps) {
  StackWorld scene;
  add_block(scene, 4);
  scene.step(90);
  EXPECT_LT(scene.impulses.statistics().factorisations, 90);
  EXPECT_GT(scene.impulses.statistics().left, 90);
}

/// Columns that stand askew fall over. Twenty factorisations a step do not pay for that.
TEST(StackSolver, LeavesColumnsThatFallOverToTheSweeps) {
  StackWorld scene;
  for (int i = 0; i < 15; ++i) {
    btRigidBody& box =
        scene.add(kHalf, 1, btVector3(btScalar(0.2 * (i * 7 % 5 - 2)), btScalar(0.5 + 1.02 * i), btScalar(0.06 * i)));
    box.setAngularVelocity(btVector3(btScalar(0.5 * (i % 3 - 1)), 0, btScalar(0.5 * (i % 2))));
  }
  scene.step(120);
  const StackSolverStatistics& statistics = scene.impulses.statistics();
  EXPECT_GT(statistics.groups, 0);
  EXPECT_LT(statistics.factorisations, 4 * 120);
}

/// A pendulum and a door: what hangs in one joint carries its own weight only. The chain of the test above carries more
/// than ten sweeps do.
TEST(StackSolver, LeavesWhatHangsInAJointToTheSweepsWhereNothingMeetsIt) {
  StackWorld scene;
  btRigidBody& pendulum = scene.add(kHalf, 1, btVector3(0, 4, 0));
  btRigidBody& door = scene.add(kHalf, 1, btVector3(4, 4, 0));
  scene.joints.push_back(std::make_unique<btPoint2PointConstraint>(pendulum, btVector3(1, 1, 0)));
  scene.joints.push_back(std::make_unique<btHingeConstraint>(door, btVector3(1, 0, 0), btVector3(0, 0, 1)));
  for (auto& joint : scene.joints) scene.world.addConstraint(joint.get());
  double apart = 0;
  for (int i = 0; i < 120; ++i) {
    scene.step(1);
    apart = std::max(
        apart, static_cast<double>((pendulum.getWorldTransform() * btVector3(1, 1, 0) - btVector3(1, 5, 0)).length()));
  }
  EXPECT_EQ(scene.impulses.statistics().groups, 0);
  EXPECT_EQ(scene.impulses.statistics().left, 2 * 120);
  EXPECT_LT(apart, 0.01);
}

TEST(StackSolver, LeavesHeapsToTheSweepsAndSolvesTheTowerBesideThem) {
  StackWorld scene;
  for (int i = 0; i < 12; ++i) scene.add(kHalf, 1, btVector3(8, btScalar(0.5 + i), 0));
  for (int i = 0; i < 60; ++i) {
    btRigidBody& box = scene.add(
        kHalf, 1, btVector3(btScalar(1.2 * (i % 3) - 5), btScalar(1 + 1.3 * (i / 9)), btScalar(1.2 * (i / 3 % 3))));
    box.setAngularVelocity(btVector3(btScalar(i % 5 - 2), btScalar(i % 3 - 1), btScalar(i % 7 - 3)));
  }
  scene.step(120);
  const StackSolverStatistics& statistics = scene.impulses.statistics();
  EXPECT_GE(statistics.groups, 120);
  EXPECT_LT(statistics.factorisations, 4 * 120);
  EXPECT_NEAR(static_cast<double>(scene.bodies[12]->getWorldTransform().getOrigin().y()), 11.5, 1e-3);
}

/// Ten boxes that fall 19 m as a column (`dropped_column_test.cpp`). The blow is solved, too.
TEST(StackSolver, ColumnsThatAreDroppedStand) {
  for (int start = 0; start < 3; ++start) {
    StackWorld scene;
    for (int i = 0; i < 10; ++i) {
      const btVector3 aside(btScalar(1e-5 * ((7 * i + 3 * start) % 11 - 5)), 0,
                            btScalar(1e-5 * ((5 * i + start) % 9 - 4)));
      scene.add(btVector3(1, 1, 1), 1, btVector3(0, btScalar(20 + 2 * i), 0) + aside);
    }
    scene.step(300);
    EXPECT_GT(scene.bodies.back()->getWorldTransform().getOrigin().y(), 18) << start;
  }
}

/// How long a group is left alone belongs to the state of the world.
TEST(StackSolver, AHeapHasTheSameBitsAfterASnapshot) {
  const auto poses = [](bool restored) {
    StackWorld scene;
    add_block(scene, 3);
    scene.step(45);
    if (restored) {
      const BulletSnapshot snapshot(scene.world, &scene.solver);
      scene.step(20);
      EXPECT_EQ(snapshot.restore(), Restored::yes);
    }
    scene.step(40);
    std::vector<btTransform> result;
    for (const auto& body : scene.bodies) result.push_back(body->getWorldTransform());
    return result;
  };
  EXPECT_TRUE(poses(false) == poses(true));
}

}  // namespace
}  // namespace pd::test

#include "bench/rollback/costs.hpp"

#include <cstdio>
#include <ctime>
#include <random>

#include "engine_glue/bullet_world.hpp"
#include "pd/bullet/install.hpp"
#include "pd/bullet/rollback.hpp"

namespace pd::bench {

namespace {

/// Processor time of `step` called `steps` times, in ms a step.
template <class Step>
double milliseconds(int steps, const Step& step) {
  const std::clock_t start = std::clock();
  for (int i = 0; i < steps; ++i) step();
  return 1e3 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC / steps;
}

/// What rollback costs: a world in which nothing is fast, and one in which everything is.
struct CostWorld {
  BulletPenetrationDepthSolver solver;
  test::BulletWorld scene;

  CostWorld() { install(scene.world(), solver); }

  btRigidBody* box(double x, double y, double z, double mass, const btVector3& at) {
    auto* shape = scene.shape<btBoxShape>(
        btVector3(static_cast<btScalar>(x), static_cast<btScalar>(y), static_cast<btScalar>(z)));
    shape->setMargin(0);
    return scene.body(shape, static_cast<btScalar>(mass), at);
  }
  /// Boxes on a floor in layers, at rest.
  void pile() {
    box(20, 1, 20, 0, btVector3(0, -1, 0));
    for (int layer = 0; layer < 4; ++layer) {
      for (int i = 0; i < 16; ++i) {
        const btVector3 at(static_cast<btScalar>(1.1 * (i % 4)), static_cast<btScalar>(0.5 + layer),
                           static_cast<btScalar>(1.1 * (i / 4)));
        box(0.5, 0.5, 0.5, 1, at)->setActivationState(DISABLE_DEACTIVATION);
      }
    }
  }
  /// Balls at 30 m/s in a room of 6 m.
  void balls() {
    std::mt19937_64 random(1);
    std::normal_distribution<double> normal;
    for (int axis = 0; axis < 3; ++axis) {
      for (const int side : {-1, 1}) {
        btVector3 at(0, 0, 0);
        at[axis] = static_cast<btScalar>(side * 3.5);
        btVector3 half(4, 4, 4);
        half[axis] = btScalar(0.5);
        box(static_cast<double>(half.x()), static_cast<double>(half.y()), static_cast<double>(half.z()), 0, at)
            ->setRestitution(1);
      }
    }
    auto* ball = scene.shape<btSphereShape>(btScalar(0.2));
    for (int i = 0; i < 50; ++i) {
      const btVector3 at(static_cast<btScalar>(i % 4 - 1.5), static_cast<btScalar>(i / 4 % 4 - 1.5),
                         static_cast<btScalar>(i / 16 - 1.5));
      btRigidBody* body = scene.body(ball, 1, at);
      const double x = normal(random);
      const double y = normal(random);
      const double z = normal(random);
      btVector3 way(static_cast<btScalar>(x), static_cast<btScalar>(y), static_cast<btScalar>(z));
      body->setLinearVelocity(btScalar(30) * way.normalized());
      body->setRestitution(1);
      body->setFriction(0);
    }
  }
};

void report_cost(const char* name, void (CostWorld::*fill)(), int settle, int steps) {
  const btScalar step = btScalar(1.0 / 60);
  CostWorld plain;
  CostWorld guarded;
  (plain.*fill)();
  (guarded.*fill)();
  for (int i = 0; i < settle; ++i) {
    plain.scene.world().stepSimulation(step, 0);
    guarded.scene.world().stepSimulation(step, 0);
  }
  const double own = milliseconds(steps, [&] { plain.scene.world().stepSimulation(step, 0); });
  RollbackStepper stepper(guarded.scene.world(), guarded.solver);
  long long parts = 0;
  long long simulation_steps = 0;
  const double ours = milliseconds(steps, [&] {
    const RollbackReport report = stepper.step(step);
    parts += report.parts;
    simulation_steps += report.simulation_steps;
  });
  const double tried = static_cast<double>(simulation_steps) / steps;
  std::printf(
      "%-34s plain %.3f ms a step, rollback %.3f (%.2f times); %.2f parts, %.2f simulation steps, each %.2f plain "
      "ones\n",
      name, own, ours, ours / own, static_cast<double>(parts) / steps, tried, ours / own / tried);
}

}  // namespace

void report_costs() {
  report_cost("64 boxes at rest", &CostWorld::pile, 120, 300);
  report_cost("50 balls at 30 m/s in a room", &CostWorld::balls, 0, 60);
}

}  // namespace pd::bench

#include "bench/rollback/drops.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "engine_glue/bullet_world.hpp"
#include "engine_glue/random_room.hpp"
#include "pd/bullet/install.hpp"
#include "pd/bullet/rollback.hpp"

namespace pd::bench {

namespace {

constexpr double kGravity = test::RandomRoom::kGravity;

/// A ball of restitution 1 that falls on a floor from a height of 1 m, for 10 s.
struct DropWorld {
  BulletPenetrationDepthSolver solver;
  test::BulletWorld scene;
  btRigidBody* ball = nullptr;

  DropWorld() {
    install(scene.world(), solver);
    auto* floor = scene.shape<btBoxShape>(btVector3(5, 1, 5));
    floor->setMargin(0);
    scene.body(floor, 0, btVector3(0, -1, 0))->setRestitution(1);
    ball = scene.body(scene.shape<btSphereShape>(btScalar(0.1)), 1, btVector3(0, btScalar(1.1), 0));
    ball->setRestitution(1);
    ball->setFriction(0);
  }
  [[nodiscard]] double height() const { return static_cast<double>(ball->getWorldTransform().getOrigin().y()) - 0.1; }
  [[nodiscard]] double energy() const {
    return 0.5 * static_cast<double>(ball->getLinearVelocity().length2()) + kGravity * height();
  }
};

/// Heights of bounces, and the energy, as shares of the first.
template <class Step>
void report_drop(const char* name, DropWorld& world, double rate, const Step& step) {
  const double start = world.energy();
  double apex = 0, last_apex = 0, least = HUGE_VAL, most = 0;
  bool rising = false;
  int bounces = 0;
  for (int i = 0; i < static_cast<int>(10 * rate); ++i) {
    step(static_cast<btScalar>(1 / rate));
    const bool rises = world.ball->getLinearVelocity().y() > 0;
    if (rises && !rising) {
      ++bounces;
      apex = 0;
    }
    rising = rises;
    apex = std::max(apex, world.energy() / kGravity);
    if (!rises && bounces > 0) last_apex = apex;
    least = std::min(least, world.energy() / start);
    most = std::max(most, world.energy() / start);
  }
  std::printf("%-22s %5.0f Hz: %2d bounces, last apex %.5f m; energy %.5f to %.5f of the first\n", name, rate, bounces,
              last_apex, least, most);
}

}  // namespace

void report_drops() {
  for (const double rate : {30.0, 60.0, 240.0}) {
    DropWorld plain;
    report_drop("plain", plain, rate, [&](btScalar h) { plain.scene.world().stepSimulation(h, 0); });
    for (const bool exact : {false, true}) {
      DropWorld guarded;
      RollbackSettings settings;
      settings.exact_flight = exact;
      RollbackStepper stepper(guarded.scene.world(), guarded.solver, settings);
      report_drop(exact ? "exact flight" : "Bullet's flight", guarded, rate, [&](btScalar h) { stepper.step(h); });
    }
  }
}

}  // namespace pd::bench

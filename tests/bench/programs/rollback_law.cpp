/// @file
/// `rollback_law`: random worlds stepped by pd::RollbackStepper, and the law that cutting steps adds no energy:
///
///     E(t) <= E(0) + max(0, gain of a plain run at 1,920 Hz) + 1e-3 E_ref at the end of every step,
///
/// with E_ref the kinetic energy at the start plus the range of the potential. Scene number i depends on --seed and i
/// only: hulls, boxes and compounds in a room, some in stacks or joined by constraints, restitution 0 to 1.
/// Exit status 1 where a scene breaks the law.
#include <btBulletDynamicsCommon.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <memory>
#include <random>
#include <vector>

#include "engine_glue/bullet_world.hpp"
#include "pd/bullet/install.hpp"
#include "pd/bullet/rollback.hpp"

namespace {

constexpr double kGravity = 9.81;
constexpr double kRoom = 3;

/// One world of a scene; made twice, for the two ways to step it.
class RandomWorld {
 public:
  explicit RandomWorld(std::uint64_t seed) : random_(seed) {
    pd::install(scene_.world(), solver_);
    restitution_ = static_cast<btScalar>(uniform(0, 1));
    if (uniform(0, 1) < 0.2) restitution_ = 0;
    walls();
    const int count = static_cast<int>(uniform(3, 9));
    const bool stack = uniform(0, 1) < 0.3;
    for (int i = 0; i < count; ++i) thrown(i, stack);
    if (uniform(0, 1) < 0.3) joint();
  }
  ~RandomWorld() {
    for (auto& joint : joints_) scene_.world().removeConstraint(joint.get());
  }
  RandomWorld(const RandomWorld&) = delete;
  RandomWorld& operator=(const RandomWorld&) = delete;

  btDiscreteDynamicsWorld& world() { return scene_.world(); }
  pd::BulletPenetrationDepthSolver& solver() { return solver_; }
  [[nodiscard]] bool has_joint() const { return !joints_.empty(); }

  [[nodiscard]] double kinetic_energy() const {
    double sum = 0;
    for (const auto& body : scene_.bodies()) {
      if (body->isStaticObject()) continue;
      const btVector3 spin = body->getAngularVelocity() * body->getWorldTransform().getBasis();
      sum += 0.5 * static_cast<double>(body->getLinearVelocity().length2() / body->getInvMass());
      for (int i = 0; i < 3; ++i) {
        sum += 0.5 * static_cast<double>(spin[i] * spin[i] / body->getInvInertiaDiagLocal()[i]);
      }
    }
    return sum;
  }
  [[nodiscard]] double energy() const {
    double sum = kinetic_energy();
    for (const auto& body : scene_.bodies()) {
      if (!body->isStaticObject()) {
        sum += kGravity * static_cast<double>(body->getWorldTransform().getOrigin().y() / body->getInvMass());
      }
    }
    return sum;
  }
  [[nodiscard]] double potential_range() const {
    double mass = 0;
    for (const auto& body : scene_.bodies()) {
      if (!body->isStaticObject()) mass += static_cast<double>(1 / body->getInvMass());
    }
    return mass * kGravity * 2 * kRoom;
  }
  /// Bodies that left the room.
  [[nodiscard]] int lost() const {
    int count = 0;
    for (const auto& body : scene_.bodies()) {
      const btVector3 at = body->getWorldTransform().getOrigin();
      if (!body->isStaticObject() && std::abs(static_cast<double>(at[at.absolute().maxAxis()])) > kRoom + 0.2) ++count;
    }
    return count;
  }

 private:
  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  btVector3 vector(double size) {
    std::normal_distribution<double> normal;
    const double x = normal(random_);
    const double y = normal(random_);
    const double z = normal(random_);
    return {static_cast<btScalar>(size * x), static_cast<btScalar>(size * y), static_cast<btScalar>(size * z)};
  }

  void walls() {
    for (int axis = 0; axis < 3; ++axis) {
      for (const int side : {-1, 1}) {
        btVector3 half(4, 4, 4);
        half[axis] = btScalar(0.5);
        auto* shape = scene_.shape<btBoxShape>(half);
        shape->setMargin(0);
        btVector3 at(0, 0, 0);
        at[axis] = static_cast<btScalar>(side * (kRoom + 0.5));
        scene_.body(shape, 0, at)->setRestitution(1);
      }
    }
  }

  btCollisionShape* random_shape() {
    const double kind = uniform(0, 4);
    const auto size = [&] { return static_cast<btScalar>(uniform(0.1, 0.35)); };
    if (kind < 1) {
      auto* box = scene_.shape<btBoxShape>(btVector3(size(), size(), size()));
      box->setMargin(0);
      return box;
    }
    if (kind < 2) return scene_.shape<btSphereShape>(size());
    if (kind < 3) {
      auto* hull = scene_.shape<btConvexHullShape>();
      for (int i = 0; i < 12; ++i) hull->addPoint(vector(0.2), false);
      hull->setMargin(0);
      hull->recalcLocalAabb();
      return hull;
    }
    auto* part = scene_.shape<btBoxShape>(btVector3(btScalar(0.35), btScalar(0.07), btScalar(0.09)));
    part->setMargin(0);
    auto* cross = scene_.shape<btCompoundShape>();
    cross->addChildShape(btTransform::getIdentity(), part);
    cross->addChildShape(btTransform(btQuaternion(btVector3(0, 0, 1), SIMD_HALF_PI)), part);
    return cross;
  }

  void thrown(int i, bool stack) {
    btRigidBody* body = nullptr;
    if (stack && i < 4) {
      auto* box = scene_.shape<btBoxShape>(btVector3(btScalar(0.3), btScalar(0.3), btScalar(0.3)));
      box->setMargin(0);
      body = scene_.body(box, 1, btVector3(0, static_cast<btScalar>(-kRoom + 0.3 + 0.6 * i), 0));
    } else {
      const btVector3 at(btScalar(i % 3 * 1.5 - 1.5), btScalar(i / 3 * 1.3 - 0.6), btScalar(uniform(1.0, 1.6)));
      body = scene_.body(random_shape(), static_cast<btScalar>(uniform(0.3, 3)), at);
      body->setLinearVelocity(vector(12));
      body->setAngularVelocity(vector(5));
    }
    body->setRestitution(restitution_);
    body->setFriction(static_cast<btScalar>(uniform(0, 0.8)));
    bodies_.push_back(body);
  }

  void joint() {
    btRigidBody& a = *bodies_[bodies_.size() - 2];
    btRigidBody& b = *bodies_.back();
    const btVector3 middle = btScalar(0.5) * (a.getWorldTransform().getOrigin() + b.getWorldTransform().getOrigin());
    joints_.push_back(std::make_unique<btPoint2PointConstraint>(a, b, a.getWorldTransform().invXform(middle),
                                                                b.getWorldTransform().invXform(middle)));
    scene_.world().addConstraint(joints_.back().get());
  }

  std::mt19937_64 random_;
  pd::BulletPenetrationDepthSolver solver_;
  pd::test::BulletWorld scene_;
  std::vector<btRigidBody*> bodies_;
  std::vector<std::unique_ptr<btTypedConstraint>> joints_;
  btScalar restitution_ = 0;
};

/// Processor time of `step` called `steps` times, in ms a step.
template <class Step>
double milliseconds(int steps, const Step& step) {
  const std::clock_t start = std::clock();
  for (int i = 0; i < steps; ++i) step();
  return 1e3 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC / steps;
}

/// What rollback costs: a world in which nothing is fast, and one in which everything is.
struct CostWorld {
  pd::BulletPenetrationDepthSolver solver;
  pd::test::BulletWorld scene;

  CostWorld() { pd::install(scene.world(), solver); }

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
  pd::RollbackStepper stepper(guarded.scene.world(), guarded.solver);
  long long parts = 0;
  long long simulation_steps = 0;
  const double ours = milliseconds(steps, [&] {
    const pd::RollbackReport report = stepper.step(step);
    parts += report.parts;
    simulation_steps += report.simulation_steps;
  });
  const double tried = static_cast<double>(simulation_steps) / steps;
  std::printf(
      "%-34s plain %.3f ms a step, rollback %.3f (%.2f times); %.2f parts, %.2f simulation steps, each %.2f plain "
      "ones\n",
      name, own, ours, ours / own, static_cast<double>(parts) / steps, tried, ours / own / tried);
}

/// A ball of restitution 1 that falls on a floor from a height of 1 m, for 10 s.
struct DropWorld {
  pd::BulletPenetrationDepthSolver solver;
  pd::test::BulletWorld scene;
  btRigidBody* ball = nullptr;

  DropWorld() {
    pd::install(scene.world(), solver);
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

void report_drops() {
  for (const double rate : {30.0, 60.0, 240.0}) {
    DropWorld plain;
    report_drop("plain", plain, rate, [&](btScalar h) { plain.scene.world().stepSimulation(h, 0); });
    for (const bool exact : {false, true}) {
      DropWorld guarded;
      pd::RollbackSettings settings;
      settings.exact_flight = exact;
      pd::RollbackStepper stepper(guarded.scene.world(), guarded.solver, settings);
      report_drop(exact ? "exact flight" : "Bullet's flight", guarded, rate, [&](btScalar h) { stepper.step(h); });
    }
  }
}

/// What all scenes add up to.
struct Totals {
  int broken = 0;
  int lost = 0;
  int lost_plain = 0;
  long long parts = 0;
  long long trials = 0;
  long long contacts = 0;
  long long contact_trials = 0;
  int bounded = 0;
  int least_parts = 0;
  double deepest_run_in = 0;
  double worst = -HUGE_VAL;
  double seconds = 0;
  std::vector<int> with_trials = std::vector<int>(33);  ///< contacts that took so many
};

/// The most that Bullet's own plain steps of 1/1920 s gain over the same time.
double plain_gain(std::uint64_t seed, int steps, double start, Totals& totals) {
  RandomWorld plain(seed);
  double gain = 0;
  for (int k = 0; k < steps * 32; ++k) {
    plain.world().stepSimulation(btScalar(1.0 / 1920), 0);
    gain = std::max(gain, plain.energy() - start);
  }
  totals.lost_plain += plain.lost();
  return gain;
}

/// What one scene came to.
struct Outcome {
  double excess = 0;  ///< share of E_ref by which it breaks the law (negative where it keeps it)
  int step = 0;       ///< when it was largest
  bool joint = false;
};

/// One scene under the stepper.
Outcome run_scene(std::uint64_t seed, int steps, const pd::RollbackSettings& settings, Totals& totals) {
  RandomWorld guarded(seed);
  const double start = guarded.energy();
  const double reference = guarded.kinetic_energy() + guarded.potential_range();
  const double gain = plain_gain(seed, steps, start, totals);
  pd::RollbackStepper stepper(guarded.world(), guarded.solver(), settings);
  double excess = -HUGE_VAL;
  int last = 0;
  const auto clock = std::chrono::steady_clock::now();
  for (int k = 0; k < steps; ++k) {
    const pd::RollbackReport report = stepper.step(btScalar(1.0 / 60));
    totals.parts += report.parts;
    totals.trials += report.simulation_steps;
    totals.contacts += report.contacts.size();
    for (const pd::FirstContact& contact : report.contacts) {
      totals.contact_trials += contact.trials;
      ++totals.with_trials[static_cast<std::size_t>(std::min(contact.trials, 32))];
    }
    totals.bounded += report.bounded ? 1 : 0;
    totals.least_parts += report.least_parts;
    totals.deepest_run_in = std::max(totals.deepest_run_in, report.deepest_run_in);
    const double over = guarded.energy() - start - gain;
    if (over > excess) {
      excess = over;
      last = k;
    }
  }
  totals.seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - clock).count();
  totals.lost += guarded.lost();
  totals.worst = std::max(totals.worst, excess / reference);
  return {excess / reference, last, guarded.has_joint()};
}

void print(const Totals& totals, int scenes, int steps) {
  const double frames = static_cast<double>(scenes) * steps;
  std::printf(
      "%d scenes of %d steps: %d break the law; worst %.3g of E_ref above E(0) and the plain gain (allowed 1e-3)\n",
      scenes, steps, totals.broken, totals.worst);
  std::printf("bodies lost: %d (plain at 1,920 Hz: %d)\n", totals.lost, totals.lost_plain);
  std::printf(
      "a step: %.3f parts, %.3f simulation steps, %.3f ms; %.2f trials a first contact\n",
      static_cast<double>(totals.parts) / frames, static_cast<double>(totals.trials) / frames,
      1e3 * totals.seconds / frames,
      totals.contacts > 0 ? static_cast<double>(totals.contact_trials) / static_cast<double>(totals.contacts) : 0.0);
  std::printf("trials a contact, share of contacts (of trials):");
  for (std::size_t k = 1; k < totals.with_trials.size(); ++k) {
    if (totals.with_trials[k] == 0) continue;
    const auto count = static_cast<double>(totals.with_trials[k]);
    std::printf(" %zu: %.3f (%.3f)", k, count / static_cast<double>(totals.contacts),
                static_cast<double>(k) * count / static_cast<double>(totals.contact_trials));
  }
  std::printf("\nleast parts %d, deepest run in %.2g m; bounded steps %d\n", totals.least_parts, totals.deepest_run_in,
              totals.bounded);
}

}  // namespace

int main(int argc, char** argv) {
  int scenes = 100;
  int steps = 60;
  std::uint64_t seed = 1;
  CLI::App app{"Random worlds under pd::RollbackStepper: no energy may be gained."};
  int first = 0;
  app.add_option("--scenes", scenes)->capture_default_str();
  app.add_option("--first", first, "scene to begin with")->capture_default_str();
  app.add_option("--seed", seed)->capture_default_str();
  app.add_option("--steps", steps, "of 1/60 s")->capture_default_str();
  bool cost = false;
  app.add_flag("--cost", cost,
               "only measures processor time: a pile of 64 boxes at rest, 50 balls at 30 m/s in a room");
  bool drop = false;
  app.add_flag("--drop", drop, "only drops a ball of restitution 1 from 1 m, for 10 s");
  bool bullets_flight = false;
  app.add_flag("--bullets-flight", bullets_flight, "without RollbackSettings::exact_flight");
  CLI11_PARSE(app, argc, argv);
  if (drop) {
    report_drops();
    return 0;
  }
  if (cost) {
    report_cost("64 boxes at rest", &CostWorld::pile, 120, 300);
    report_cost("50 balls at 30 m/s in a room", &CostWorld::balls, 0, 60);
    return 0;
  }
  pd::RollbackSettings settings;
  settings.exact_flight = !bullets_flight;
  Totals totals;
  for (int i = first; i < first + scenes; ++i) {
    const Outcome outcome = run_scene(seed * 1000003 + static_cast<std::uint64_t>(i), steps, settings, totals);
    if (outcome.excess <= 1e-3) continue;
    ++totals.broken;
    std::printf("BROKEN seed=%llu scene=%d, step %d%s: %.3g of E_ref above the law\n",
                static_cast<unsigned long long>(seed), i, outcome.step, outcome.joint ? ", with a joint" : "",
                outcome.excess);
  }
  print(totals, scenes, steps);
  return totals.broken == 0 ? 0 : 1;
}

/// @file
/// Bullet's own contacts and those of pdepth, by turns in one run: processor time of a step while a block of boxes
/// falls, and of contact queries between compounds of hulls. Default settings; the deepest contact and the number of
/// points stand beside the times.
#include <btBulletDynamicsCommon.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <memory>
#include <random>
#include <vector>

#include "bench/measure/processor_time.hpp"
#include "pd/bullet/install.hpp"

namespace {

using namespace pd;
using bench::processor_seconds;

struct Cost {
  double seconds = 0;  ///< of a step, or of all pairs asked once
  int points = 0;
  double least = 0;  ///< distance of the deepest point
};

class World {
 public:
  explicit World(bool ours) {
    world_.setGravity(btVector3(0, -10, 0));
    if (ours) install(world_, solver_);
  }
  ~World() {
    for (const auto& body : bodies_) world_.removeRigidBody(body.get());
  }
  World(const World&) = delete;
  World& operator=(const World&) = delete;

  template <class Shape, class... Arguments>
  Shape* shape(Arguments&&... arguments) {
    auto made = std::make_unique<Shape>(std::forward<Arguments>(arguments)...);
    Shape* const raw = made.get();
    shapes_.push_back(std::move(made));
    return raw;
  }
  void body(btCollisionShape* shape, btScalar mass, const btVector3& at) {
    btVector3 inertia(0, 0, 0);
    if (mass > 0) shape->calculateLocalInertia(mass, inertia);
    btRigidBody::btRigidBodyConstructionInfo info(mass, nullptr, shape, inertia);
    info.m_startWorldTransform = btTransform(btQuaternion::getIdentity(), at);
    bodies_.push_back(std::make_unique<btRigidBody>(info));
    world_.addRigidBody(bodies_.back().get());
  }

  btDiscreteDynamicsWorld& world() { return world_; }
  const std::vector<std::unique_ptr<btRigidBody>>& bodies() const { return bodies_; }
  /// Fills in the points that stand in the world's manifolds.
  void count(Cost& cost) {
    for (int i = 0; i < dispatcher_.getNumManifolds(); ++i) {
      const btPersistentManifold& manifold = *dispatcher_.getManifoldByIndexInternal(i);
      cost.points += manifold.getNumContacts();
      for (int k = 0; k < manifold.getNumContacts(); ++k) {
        cost.least = std::min(cost.least, static_cast<double>(manifold.getContactPoint(k).getDistance()));
      }
    }
  }

 private:
  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_{&configuration_};
  btDbvtBroadphase broadphase_;
  btSequentialImpulseConstraintSolver constraints_;
  btDiscreteDynamicsWorld world_{&dispatcher_, &broadphase_, &constraints_, &configuration_};
  BulletPenetrationDepthSolver solver_;
  std::vector<std::unique_ptr<btCollisionShape>> shapes_;
  std::vector<std::unique_ptr<btRigidBody>> bodies_;
};

/// The boxes of Bullet's "Basic Example", in free fall.
Cost falling_block(bool ours) {
  World w(ours);
  w.body(w.shape<btBoxShape>(btVector3(50, 50, 50)), 0, btVector3(0, -50, 0));
  auto* const box = w.shape<btBoxShape>(btVector3(btScalar(0.1), btScalar(0.1), btScalar(0.1)));
  for (int k = 0; k < 125; ++k) {
    const btVector3 cell(static_cast<btScalar>(k / 5 % 5), static_cast<btScalar>(k / 25), static_cast<btScalar>(k % 5));
    w.body(box, 1, btScalar(0.2) * cell + btVector3(0, 2, 0));
  }
  const auto step = [&] { w.world().stepSimulation(btScalar(1) / 60, 0); };
  step();
  constexpr int kSteps = 36;  // the block lands after them
  const double start = processor_seconds();
  for (int i = 0; i < kSteps; ++i) step();
  Cost cost{(processor_seconds() - start) / kSteps};
  w.count(cost);
  return cost;
}

struct Counting : btCollisionWorld::ContactResultCallback {
  Cost found;
  btScalar addSingleResult(btManifoldPoint& point, const btCollisionObjectWrapper*, int, int,
                           const btCollisionObjectWrapper*, int, int) override {
    ++found.points;
    found.least = std::min(found.least, static_cast<double>(point.getDistance()));
    return 0;
  }
};

void fill_with_compounds(World& w) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto number = [&] { return static_cast<btScalar>(uniform(random)); };
  const auto place = [&] {
    const btScalar x = number(), y = number(), z = number();
    return btVector3(x, y, z);
  };
  for (int b = 0; b < 10; ++b) {
    auto* const compound = w.shape<btCompoundShape>();
    for (int k = 0; k < 8; ++k) {
      auto* const hull = w.shape<btConvexHullShape>();
      for (int i = 0; i < 24; ++i) {
        const btScalar radius = btScalar(0.05) + btScalar(0.02) * number();
        hull->addPoint(place().normalized() * radius, false);
      }
      hull->recalcLocalAabb();
      hull->setMargin(btScalar(0.001));
      compound->addChildShape(btTransform(btQuaternion::getIdentity(), btScalar(0.12) * place()), hull);
    }
    w.body(compound, 0, btScalar(0.4) * place());
  }
}

Cost queries(World& w, double reach) {
  Counting counting;
  counting.m_closestDistanceThreshold = static_cast<btScalar>(reach);
  const double start = processor_seconds();
  for (std::size_t i = 0; i < w.bodies().size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) w.world().contactPairTest(w.bodies()[j].get(), w.bodies()[i].get(), counting);
  }
  counting.found.seconds = processor_seconds() - start;
  return counting.found;
}

/// @param ask  (ours) measures once
template <class Ask>
void print_by_turns(const char* name, int turns, const Ask& ask) {
  Cost sums[2], last[2];
  for (int turn = 0; turn < turns; ++turn) {
    for (const bool ours : {false, true}) {
      last[ours ? 1 : 0] = ask(ours);
      sums[ours ? 1 : 0].seconds += last[ours ? 1 : 0].seconds / turns;
    }
  }
  std::printf("%-42s %8.0f %8.0f %7.2f %8d %8d %10.5f %10.5f\n", name, 1e6 * sums[0].seconds, 1e6 * sums[1].seconds,
              sums[1].seconds / sums[0].seconds, last[0].points, last[1].points, last[0].least, last[1].least);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Processor time of Bullet's own contacts and of pdepth's, by turns.");
  int turns = 15;
  app.add_option("--turns", turns, "How often each is measured")->check(CLI::Range(1, 10'000))->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  std::printf("%-42s %8s %8s %7s %8s %8s %10s %10s\n", "microseconds", "Bullet", "pdepth", "ratio", "points", "points",
              "deepest", "deepest");
  print_by_turns("a step of 125 boxes that fall as a block", turns, [](bool ours) { return falling_block(ours); });
  World worlds[2] = {World(false), World(true)};
  for (World& w : worlds) fill_with_compounds(w);
  for (const double reach : {0.0, 0.1, 10.0}) {
    char name[64];
    std::snprintf(name, sizeof name, "45 queries of compounds within %g m", reach);
    for (World& w : worlds) (void)queries(w, reach);
    print_by_turns(name, turns, [&](bool ours) { return queries(worlds[ours ? 1 : 0], reach); });
  }
}

/// @file
/// `bodies_on_mesh`: 36 bodies of one kind, or piles of them, that came to rest on a flat, wavy or rough triangle mesh
/// or on a plane, a step under Bullet's algorithms and under ours in one run: milliseconds, queries, those that a
/// memory answered, contact points, bodies that fell through or off, the speed of half, of nine tenths and of all of
/// the bodies, and the deepest point of a world, nine tenths of them (`--alone`: a world for each body). For
/// instructions, one side alone under callgrind:
///
///     valgrind --tool=callgrind --toggle-collect='btDiscreteDynamicsWorld::stepSimulation*'
///       bodies_on_mesh --kinds cylinder --grounds waves --runs pdepth --settle 0 --steps 20
#include <BulletCollision/CollisionShapes/btStaticPlaneShape.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "engine_glue/union_worlds.hpp"

namespace {

constexpr double kExtent = 6;
constexpr int kSide = 6;

/// In [-1/2, 1/2), the same numbers on every platform.
class Random {
 public:
  btScalar next() {
    state_ = state_ * 1664525U + 1013904223U;
    return static_cast<btScalar>(static_cast<double>(state_ >> 8U) / 16777216.0 - 0.5);
  }

 private:
  std::uint32_t state_ = 12345;
};

btCollisionShape* hull_of_100(pd::test::BulletWorld& world) {
  auto* hull = world.shape<btConvexHullShape>();
  Random random;
  for (int i = 0; i < 100; ++i) {
    const btScalar z = random.next(), y = random.next();
    const btVector3 way(random.next(), y, z);
    hull->addPoint(btScalar(.3) * way.normalized(), false);
  }
  hull->recalcLocalAabb();
  return hull;
}

btCollisionShape* shape_of(const std::string& kind, pd::test::BulletWorld& world) {
  if (kind == "sphere") return world.shape<btSphereShape>(.25F);
  if (kind == "hull") return hull_of_100(world);
  if (kind == "cylinder") return world.shape<btCylinderShape>(btVector3(.25F, .3F, .25F));
  if (kind == "cone") return world.shape<btConeShape>(.25F, .5F);
  if (kind == "capsule") return world.shape<btCapsuleShape>(.2F, .3F);
  if (kind == "box") return world.shape<btBoxShape>(btVector3(.25F, .2F, .3F));
  if (kind == "compound") {
    auto* compound = world.shape<btCompoundShape>();
    const auto at = [](btScalar x, btScalar y, btScalar z) {
      return btTransform(btQuaternion::getIdentity(), btVector3(x, y, z));
    };
    compound->addChildShape(at(.15F, 0, 0), world.shape<btBoxShape>(btVector3(.15F, .06F, .06F)));
    compound->addChildShape(at(0, .15F, 0), world.shape<btBoxShape>(btVector3(.06F, .15F, .06F)));
    compound->addChildShape(at(0, 0, .18F), world.shape<btSphereShape>(.09F));
    return compound;
  }
  const btVector3 centres[] = {{-.2F, 0, 0}, {.2F, 0, .05F}, {0, .2F, 0}};
  const btScalar radii[] = {.15F, .2F, .1F};
  return world.shape<btMultiSphereShape>(centres, radii, 3);
}

struct Question {
  int layers = 1;
  int cells = 32;
  int settle = 240;
  int steps = 120;
  bool alone = false;
};

/// Of all worlds of a run.
struct Measured {
  std::vector<double> ms;
  std::vector<double> speeds;  ///< of each body, the mean of the steps
  std::vector<double> deepest;
  pd::BulletSolverStatistics queries;
  int contacts = 0;
  int lost = 0;
};

/// @param only  a body's number, the others are left out; -1: all bodies
void add_world(const std::string& kind, const std::string& ground, bool ours, const Question& question, int only,
               Measured& out) {
  pd::test::UnionWorld world(ours);
  const int cells = question.cells;
  // Of corners, by which rough ground is uneven: up to a quarter of a cell, so that its triangles meet at angles of up
  // to 50 degrees where those of waves meet at 13 and less.
  std::vector<double> noise(static_cast<std::size_t>((cells + 1) * (cells + 1)), 0.0);
  Random unevenness;
  for (double& x : noise) x = ground == "rough" ? static_cast<double>(unevenness.next()) * kExtent / cells : 0;
  const auto corner = [&](int i, int k) {
    const double x = kExtent * (2.0 * i / cells - 1), z = kExtent * (2.0 * k / cells - 1);
    const double waves = 0.1 * (x * x + z * z) + 0.15 * std::sin(2 * x) * std::cos(2 * z);
    const double height = ground == "flat" ? 0 : waves + noise[static_cast<std::size_t>(i * (cells + 1) + k)];
    return btVector3(static_cast<btScalar>(x), static_cast<btScalar>(height), static_cast<btScalar>(z));
  };
  std::vector<pd::test::UnionWorld::Triangle> triangles;
  for (int i = 0; i < cells; ++i) {
    for (int k = 0; k < cells; ++k) {
      pd::test::add_rectangle(triangles, corner(i, k), corner(i, k + 1), corner(i + 1, k + 1), corner(i + 1, k));
    }
  }
  btCollisionShape* under =
      ground == "plane"
          ? static_cast<btCollisionShape*>(world.bullet.shape<btStaticPlaneShape>(btVector3(0, 1, 0), 0.F))
          : world.mesh(triangles, CONVEX_DISTANCE_MARGIN);
  world.fixed(under)->setFriction(.7F);
  Random random;
  std::vector<const btRigidBody*> bodies;
  for (int i = 0; i < question.layers * kSide * kSide; ++i) {
    const auto across = [&](int place) { return 1.2F * (static_cast<btScalar>(place) - 2.5F) + .1F * random.next(); };
    const auto above = static_cast<btScalar>(i / (kSide * kSide));
    const btScalar z = across(i / kSide % kSide), y = 3 + above + .3F * random.next();
    const btVector3 at(across(i % kSide), y, z);
    const btScalar turn_w = random.next(), turn_z = random.next(), turn_y = random.next();
    btQuaternion turn(random.next(), turn_y, turn_z, turn_w);
    if (only >= 0 && i != only) continue;
    btRigidBody* body =
        world.moving(shape_of(kind, world.bullet), btTransform(turn.normalized(), at), btVector3(0, 0, 0));
    body->setFriction(.7F);
    body->setRollingFriction(.02F);
    body->setSpinningFriction(.02F);
    bodies.push_back(body);
  }
  world.step(question.settle);
  world.solver.reset_statistics();
  std::vector<double> speeds(bodies.size(), 0.0);
  double deepest = 0;
  for (int i = 0; i < question.steps; ++i) {
    const auto start = std::chrono::steady_clock::now();
    world.step();
    out.ms.push_back(std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      speeds[b] += static_cast<double>(bodies[b]->getLinearVelocity().length()) / question.steps;
    }
    deepest = std::max(deepest, -world.bullet.least_distance());
  }
  out.speeds.insert(out.speeds.end(), speeds.begin(), speeds.end());
  out.deepest.push_back(deepest);
  const auto statistics = world.solver.statistics();
  out.queries.calls += statistics.calls;
  out.queries.warm += statistics.warm;
  out.queries.support_calls += statistics.support_calls;
  out.contacts += world.bullet.num_contacts();
  out.lost += static_cast<int>(std::count_if(bodies.begin(), bodies.end(), [](const btRigidBody* body) {
    return body->getWorldTransform().getOrigin().y() < -1;
  }));
}

void run(const std::string& kind, const std::string& ground, bool ours, const Question& question) {
  Measured measured;
  const int worlds = question.alone ? question.layers * kSide * kSide : 1;
  for (int i = 0; i < worlds; ++i) add_world(kind, ground, ours, question, question.alone ? i : -1, measured);
  const auto quantile = [](std::vector<double>& of, double share) {
    std::sort(of.begin(), of.end());
    return of[std::min(of.size() - 1, static_cast<std::size_t>(share * static_cast<double>(of.size())))];
  };
  const auto calls = static_cast<double>(std::max<std::int64_t>(measured.queries.calls, 1));
  std::printf("%-12s%-7s%-8s%10.4f%10.1f%8.2f%10.2f%10d%6d%10.5f%10.5f%10.5f%10.5f\n", kind.c_str(), ground.c_str(),
              ours ? "pdepth" : "bullet", quantile(measured.ms, .5),
              static_cast<double>(measured.queries.calls) / question.steps,
              static_cast<double>(measured.queries.warm) / calls,
              static_cast<double>(measured.queries.support_calls) / calls, measured.contacts, measured.lost,
              quantile(measured.speeds, .5), quantile(measured.speeds, .9), quantile(measured.speeds, 1),
              quantile(measured.deepest, .9));
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("A step of bodies that rest on a triangle mesh or a plane");
  std::vector<std::string> kinds{"cylinder", "cone", "multisphere", "capsule", "box", "sphere", "hull", "compound"};
  std::vector<std::string> grounds{"flat", "waves", "plane"};
  std::vector<std::string> runs{"bullet", "pdepth"};
  Question question;
  app.add_option("--kinds", kinds)->delimiter(',')->check(CLI::IsMember(kinds));
  app.add_option("--grounds", grounds)
      ->delimiter(',')
      ->check(CLI::IsMember(std::vector<std::string>{"flat", "waves", "rough", "plane"}));
  app.add_option("--runs", runs)->delimiter(',')->check(CLI::IsMember(runs));
  app.add_option("--layers", question.layers, "of 36 bodies each")->check(CLI::PositiveNumber);
  app.add_option("--cells", question.cells, "along each of the 12 m of a mesh")->check(CLI::PositiveNumber);
  app.add_option("--settle", question.settle, "steps before those that are measured")->check(CLI::NonNegativeNumber);
  app.add_option("--steps", question.steps)->check(CLI::PositiveNumber);
  app.add_flag("--alone", question.alone, "each body in a world of its own");
  CLI11_PARSE(app, argc, argv);
  std::printf("%-12s%-7s%-8s%10s%10s%8s%10s%10s%6s%10s%10s%10s%10s\n", "kind", "ground", "run", "p50 ms", "queries",
              "warm", "supports", "contacts", "lost", "speed p50", "p90", "max", "deepest");
  for (const std::string& kind : kinds) {
    for (const std::string& ground : grounds) {
      for (const std::string& name : runs) run(kind, ground, name == "pdepth", question);
    }
  }
  return 0;
}

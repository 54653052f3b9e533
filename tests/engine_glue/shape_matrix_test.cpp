/// @file
/// Every type of shape on every ground, whatever becomes of the solver meanwhile. Each body comes to rest on the
/// ground, or where it does under Bullet's own algorithms, or is named here.
#include "engine_glue/shape_matrix.hpp"

#include <BulletCollision/Gimpact/btGImpactCollisionAlgorithm.h>
#include <BulletSoftBody/btSoftBodyHelpers.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include "pd/bullet/install.hpp"
#include "union/mesh_contacts.hpp"

namespace pd::test {
namespace {

constexpr int kSteps = 90;
constexpr int kTurningPoint = 45;
constexpr double kSpacing = 1.2;
constexpr double kDrop = 0.03;
/// What a body may sink, and what the margins of two shapes may keep them apart.
constexpr double kSunk = 0.02, kMargins = 0.06;
/// What is lower than this fell through the ground.
constexpr double kFallen = 0.5;

enum class Fate { never_installed, alive, persistent, uninstalled, destroyed, opted_out, pieces_alone };

const char* name_of(Fate fate) {
  switch (fate) {
    case Fate::never_installed:
      return "never installed";
    case Fate::alive:
      return "alive";
    case Fate::persistent:
      return "persistent contacts";
    case Fate::uninstalled:
      return "uninstalled";
    case Fate::destroyed:
      return "destroyed";
    case Fate::opted_out:
      return "opted out";
    case Fate::pieces_alone:
      return "pieces alone";
  }
  return "";
}

/// Leaves no zeros behind on the stack, so that what is read before it is written does not look harmless.
[[gnu::noinline]] void soil_stack() {
  volatile char soil[20000];
  std::memset(const_cast<char*>(soil), 0x5a, sizeof soil);
}

/// Bodies stand apart on one ground, at the places of a square.
class MatrixWorld {
 public:
  MatrixWorld(const ShapeMatrix& matrix, const MatrixGround& ground, Fate fate) : fate_(fate) {
    btGImpactCollisionAlgorithm::registerAlgorithm(&world_.dispatcher());
    BulletSolverSettings settings;
    settings.warning = nullptr;
    settings.unions_as_one = fate != Fate::pieces_alone;
    if (fate == Fate::opted_out) {
      settings.takes_pair = [](const btCollisionObject&, const btCollisionObject&, void*) { return false; };
    }
    if (fate != Fate::never_installed) {
      solver_ = std::make_unique<BulletPenetrationDepthSolver>(settings);
      install(world_.world(), *solver_,
              fate == Fate::persistent ? BulletContacts::persistent : BulletContacts::one_shot);
    }
    world_.body(ground.shape, 0, ground.origin);
    const int side = static_cast<int>(std::ceil(std::sqrt(static_cast<double>(matrix.bodies().size()))));
    int place = 0;
    for (const MatrixBody& body : matrix.bodies()) {
      const double x = kSpacing * (place % side - 0.5 * side), z = kSpacing * (place / side - 0.5 * side);
      bodies_.push_back(let_go(body, x + 0.03, z + 0.07));
      ++place;
    }
  }

  /// @return where each body's origin would be if its bounding box stood on the ground
  [[nodiscard]] const std::vector<double>& standing() const { return standing_; }

  /// @return where each body's origin comes to rest above the ground
  std::vector<double> heights_at_rest() {
    for (int i = 0; i < kSteps; ++i) {
      if (i == kTurningPoint && fate_ == Fate::uninstalled) {
        EXPECT_TRUE(uninstall(world_.world(), *solver_));
      }
      if (i == kTurningPoint && fate_ == Fate::destroyed) solver_.reset();
      soil_stack();
      world_.world().stepSimulation(btScalar(1) / 60, 0);
    }
    std::vector<double> heights;
    for (const btRigidBody* body : bodies_) {
      heights.push_back(static_cast<double>(body->getWorldTransform().getOrigin().y()));
    }
    return heights;
  }

 private:
  btRigidBody* let_go(const MatrixBody& body, double x, double z) {
    btVector3 lower, upper;
    body.shape->getAabb(body.pose, lower, upper);
    standing_.push_back(-static_cast<double>(lower.y()));
    btTransform pose = body.pose;
    pose.setOrigin(btVector3(btScalar(x), btScalar(kDrop) - lower.y(), btScalar(z)));
    btRigidBody::btRigidBodyConstructionInfo info(1, nullptr, body.shape, btVector3(.01f, .01f, .01f));
    info.m_startWorldTransform = pose;
    info.m_linearDamping = info.m_angularDamping = btScalar(0.2);
    // Some shapes have no inertia of their own, and all are to rest alike.
    owned_.push_back(std::make_unique<btRigidBody>(info));
    owned_.back()->setActivationState(DISABLE_DEACTIVATION);
    owned_.back()->setRollingFriction(btScalar(0.05));
    world_.world().addRigidBody(owned_.back().get());
    return owned_.back().get();
  }

  Fate fate_;
  std::unique_ptr<BulletPenetrationDepthSolver> solver_;
  BulletWorld world_;
  std::vector<std::unique_ptr<btRigidBody>> owned_;
  std::vector<btRigidBody*> bodies_;
  std::vector<double> standing_;

 public:
  ~MatrixWorld() {
    for (const auto& body : owned_) world_.world().removeRigidBody(body.get());
  }
  MatrixWorld(const MatrixWorld&) = delete;
  MatrixWorld& operator=(const MatrixWorld&) = delete;
};

/// What need not come to rest. Such a body still has a place.
bool is_named(const MatrixBody& body, const MatrixGround& ground, Fate fate) {
  const auto is = [&](const char* word) { return ground.name.find(word) != std::string::npos; };
  // A sheet without thickness: a triangle that is asked alone pushes a thin body out by its nearer side, whichever that
  // is (`unions_as_one`).
  if (fate == Fate::pieces_alone && (is("mesh") || is("heightfield"))) return true;
  // Bullet's GImpact algorithm asks the triangles of its sheet alone, too.
  return body.name == "nested compounds" && ground.name == "GImpact mesh";
}

TEST(ShapeMatrix, EveryShapeOnEveryGroundWhateverBecomesOfTheSolver) {
  const ShapeMatrix matrix;
  for (const MatrixGround& ground : matrix.grounds()) {
    MatrixWorld plain(matrix, ground, Fate::never_installed);
    const std::vector<double> bullets = plain.heights_at_rest();
    for (const Fate fate :
         {Fate::alive, Fate::persistent, Fate::uninstalled, Fate::destroyed, Fate::opted_out, Fate::pieces_alone}) {
      const std::vector<double> ours = MatrixWorld(matrix, ground, fate).heights_at_rest();
      for (std::size_t i = 0; i < ours.size(); ++i) {
        const auto where = [&] { return matrix.bodies()[i].name + " on " + ground.name + ", solver " + name_of(fate); };
        EXPECT_TRUE(std::isfinite(ours[i])) << where();
        if (is_named(matrix.bodies()[i], ground, fate)) continue;
        const double standing = plain.standing()[i];
        // What Bullet's own does not hold need not be held.
        const bool held = bullets[i] > standing - kFallen;
        EXPECT_GE(ours[i], held ? std::min(standing, bullets[i]) - kSunk : -HUGE_VAL) << where();
        EXPECT_LE(ours[i], std::max(standing, bullets[i]) + kMargins) << where();
      }
    }
  }
}

/// A cloth that falls on a ground. @return where its nodes are then
std::vector<btScalar> cloth_on(const MatrixGround& ground, Fate fate) {
  auto solver = std::make_unique<BulletPenetrationDepthSolver>();
  btSoftBodyRigidBodyCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher(&configuration);
  btDbvtBroadphase broadphase;
  btSequentialImpulseConstraintSolver constraints;
  btSoftRigidDynamicsWorld world(&dispatcher, &broadphase, &constraints, &configuration);
  world.getWorldInfo().m_gravity = world.getGravity();
  world.getWorldInfo().m_sparsesdf.Initialize();
  if (fate != Fate::never_installed) install(world, *solver);
  btRigidBody body(0, nullptr, ground.shape);
  body.setWorldTransform(btTransform(btQuaternion::getIdentity(), ground.origin));
  world.addRigidBody(&body);
  const auto corner = [](int x, int z) { return btVector3(btScalar(x) / 2, btScalar(0.1), btScalar(z) / 2); };
  btSoftBody* cloth = btSoftBodyHelpers::CreatePatch(world.getWorldInfo(), corner(-1, -1), corner(1, -1), corner(-1, 1),
                                                     corner(1, 1), 5, 5, 0, true);
  cloth->setTotalMass(btScalar(0.2));
  world.addSoftBody(cloth);
  for (int step = 0; step < 30; ++step) {
    if (step == 15 && fate == Fate::destroyed) solver.reset();
    world.stepSimulation(btScalar(1) / 60, 0);
  }
  std::vector<btScalar> nodes;
  for (int i = 0; i < cloth->m_nodes.size(); ++i) {
    const btVector3& at = cloth->m_nodes[i].m_x;
    nodes.insert(nodes.end(), {at.x(), at.y(), at.z()});
  }
  world.removeSoftBody(cloth);
  delete cloth;
  world.removeRigidBody(&body);
  return nodes;
}

/// Soft bodies are Bullet's own, bit for bit.
TEST(ShapeMatrix, ClothOnEveryGround) {
  const ShapeMatrix matrix;
  for (const MatrixGround& ground : matrix.grounds()) {
    // Bullet has no algorithm for soft bodies on these.
    if (ground.shape->isConcave() && !detail::takes_mesh(ground.shape->getShapeType())) continue;
    if (detail::is_distance_field(*ground.shape)) continue;
    const std::vector<btScalar> bullets = cloth_on(ground, Fate::never_installed);
    // After `uninstall` Bullet makes its pairs anew, with other bits.
    for (const Fate fate : {Fate::alive, Fate::destroyed}) {
      EXPECT_EQ(cloth_on(ground, fate), bullets) << ground.name << ", solver " << name_of(fate);
    }
  }
}

}  // namespace
}  // namespace pd::test

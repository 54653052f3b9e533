/// @file
/// Random worlds for the stepper's laws: hulls, boxes, balls and compounds thrown about a closed room, some of them
/// stacked or joined by a constraint, restitution 0 to 1. A room depends on its seed only.
#pragma once

#include <btBulletDynamicsCommon.h>

#include <cmath>
#include <cstdint>
#include <memory>
#include <random>
#include <vector>

#include "engine_glue/bullet_world.hpp"
#include "pd/bullet/install.hpp"
#include "pd/bullet/stack_solver.hpp"

namespace pd::test {

class RandomRoom {
 public:
  static constexpr double kGravity = 9.81;
  static constexpr double kHalf = 3;  ///< of the room's edge

  /// @param solved_at_once  constraints by `StackSolver`, else by Bullet's sequential impulses
  explicit RandomRoom(std::uint64_t seed_of_room, bool solved_at_once = false) : random_(seed_of_room) {
    install(scene_.world(), solver_);
    if (solved_at_once) scene_.world().setConstraintSolver(&stacks_);
    restitution_ = static_cast<btScalar>(uniform(0, 1));
    if (uniform(0, 1) < 0.2) restitution_ = 0;
    walls();
    const int count = static_cast<int>(uniform(3, 9));
    const bool stack = uniform(0, 1) < 0.3;
    for (int i = 0; i < count; ++i) thrown(i, stack);
    if (uniform(0, 1) < 0.3) joint();
  }
  ~RandomRoom() {
    for (auto& joint : joints_) scene_.world().removeConstraint(joint.get());
  }
  RandomRoom(const RandomRoom&) = delete;
  RandomRoom& operator=(const RandomRoom&) = delete;

  btDiscreteDynamicsWorld& world() { return scene_.world(); }
  BulletPenetrationDepthSolver& solver() { return solver_; }
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
    return mass * kGravity * 2 * kHalf;
  }
  /// Bodies that left the room.
  [[nodiscard]] int lost() const {
    int count = 0;
    for (const auto& body : scene_.bodies()) {
      const btVector3 at = body->getWorldTransform().getOrigin();
      if (!body->isStaticObject() && std::abs(static_cast<double>(at[at.absolute().maxAxis()])) > kHalf + 0.2) ++count;
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
        at[axis] = static_cast<btScalar>(side * (kHalf + 0.5));
        scene_.body(shape, 0, at)->setRestitution(1);
      }
    }
  }

  btCollisionShape* random_shape() {
    const double kind = uniform(0, 4);
    const auto size = [&] { return static_cast<btScalar>(uniform(0.1, 0.35)); };
    if (kind < 1) {
      const btScalar z = size(), y = size();
      auto* box = scene_.shape<btBoxShape>(btVector3(size(), y, z));
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
      body = scene_.body(box, 1, btVector3(0, static_cast<btScalar>(-kHalf + 0.3 + 0.6 * i), 0));
    } else {
      const btVector3 at(btScalar(i % 3 * 1.5 - 1.5), btScalar(i / 3 * 1.3 - 0.6), btScalar(uniform(1.0, 1.6)));
      const auto mass = static_cast<btScalar>(uniform(0.3, 3));
      body = scene_.body(random_shape(), mass, at);
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
  BulletPenetrationDepthSolver solver_;
  StackSolver stacks_;
  BulletWorld scene_;
  std::vector<btRigidBody*> bodies_;
  std::vector<std::unique_ptr<btTypedConstraint>> joints_;
  btScalar restitution_ = 0;
};

}  // namespace pd::test

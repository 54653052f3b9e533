/// @file
/// A small Bullet world for tests: shapes owned, y up, no hidden defaults.
#pragma once

#include <btBulletDynamicsCommon.h>

#include <memory>
#include <vector>

namespace pd::test {

class BulletWorld {
 public:
  BulletWorld()
      : dispatcher_(&configuration_), world_(&dispatcher_, &broadphase_, &constraint_solver_, &configuration_) {
    world_.setGravity(btVector3(0, btScalar(-9.81), 0));
  }
  ~BulletWorld() {
    for (auto& body : bodies_) {
      world_.removeRigidBody(body.get());
    }
  }
  BulletWorld(const BulletWorld&) = delete;
  BulletWorld& operator=(const BulletWorld&) = delete;

  template <class Shape, class... Arguments>
  Shape* shape(Arguments&&... arguments) {
    auto made = std::make_unique<Shape>(std::forward<Arguments>(arguments)...);
    Shape* raw = made.get();
    shapes_.push_back(std::move(made));
    return raw;
  }

  btRigidBody* body(btCollisionShape* collision_shape, btScalar mass, const btTransform& pose) {
    btVector3 inertia(0, 0, 0);
    if (mass > 0) {
      collision_shape->calculateLocalInertia(mass, inertia);
    }
    btRigidBody::btRigidBodyConstructionInfo info(mass, nullptr, collision_shape, inertia);
    info.m_startWorldTransform = pose;
    bodies_.push_back(std::make_unique<btRigidBody>(info));
    world_.addRigidBody(bodies_.back().get());
    return bodies_.back().get();
  }
  btRigidBody* body(btCollisionShape* collision_shape, btScalar mass, const btVector3& at) {
    return body(collision_shape, mass, btTransform(btQuaternion::getIdentity(), at));
  }

  btDiscreteDynamicsWorld& world() { return world_; }
  btCollisionDispatcher& dispatcher() { return dispatcher_; }
  btDefaultCollisionConfiguration& configuration() { return configuration_; }
  btSequentialImpulseConstraintSolver& constraint_solver() { return constraint_solver_; }
  const std::vector<std::unique_ptr<btRigidBody>>& bodies() const { return bodies_; }

  int num_contacts() const {
    int count = 0;
    for (int i = 0; i < dispatcher_.getNumManifolds(); ++i) {
      count += dispatcher_.getManifoldByIndexInternal(i)->getNumContacts();
    }
    return count;
  }
  /// The deepest contact's distance (negative inside), or 1e30 without contacts.
  double least_distance() const {
    double least = 1e30;
    for (int i = 0; i < dispatcher_.getNumManifolds(); ++i) {
      const btPersistentManifold* manifold = dispatcher_.getManifoldByIndexInternal(i);
      for (int k = 0; k < manifold->getNumContacts(); ++k) {
        least = std::min(least, static_cast<double>(manifold->getContactPoint(k).getDistance()));
      }
    }
    return least;
  }

 private:
  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_;
  btDbvtBroadphase broadphase_;
  btSequentialImpulseConstraintSolver constraint_solver_;
  btDiscreteDynamicsWorld world_;
  std::vector<std::unique_ptr<btCollisionShape>> shapes_;
  std::vector<std::unique_ptr<btRigidBody>> bodies_;
};

/// A box as a hull, with the margin outside of it.
inline btConvexHullShape* box_hull(BulletWorld& world, const btVector3& half, btScalar margin) {
  auto* hull = world.shape<btConvexHullShape>();
  for (int i = 0; i < 8; ++i) {
    hull->addPoint(
        btVector3((i & 1) ? half.x() : -half.x(), (i & 2) ? half.y() : -half.y(), (i & 4) ? half.z() : -half.z()),
        false);
  }
  hull->setMargin(margin);
  hull->recalcLocalAabb();
  return hull;
}

}  // namespace pd::test

#include "pd/bullet/snapshot.hpp"

#include <BulletCollision/BroadphaseCollision/btCollisionAlgorithm.h>
#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>
#include <BulletDynamics/ConstraintSolver/btSequentialImpulseConstraintSolver.h>
#include <BulletDynamics/ConstraintSolver/btTypedConstraint.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <algorithm>
#include <optional>
#include <vector>

#include "pair_registry.hpp"

namespace pd {

namespace {

struct BodyState {
  btCollisionObject* object;
  btTransform world;
  btTransform interpolation;
  btVector3 interpolation_linear;
  btVector3 interpolation_angular;
  int activation_state;
  btScalar deactivation_time;
  btScalar hit_fraction;
  // Of rigid bodies only:
  btVector3 linear;
  btVector3 angular;
  btVector3 push;
  btVector3 turn;
  btVector3 force;
  btVector3 torque;
};

struct ManifoldState {
  const btCollisionObject* body0;
  const btCollisionObject* body1;
  int ordinal;  ///< among the manifolds of these two bodies (compounds have several)
  std::vector<btManifoldPoint> points;
  std::optional<detail::PairMemory> memory;
};

struct JointState {
  btTypedConstraint* joint;
  btScalar applied_impulse;
  bool enabled;
};

BodyState save_body(btCollisionObject* object) {
  BodyState state{};
  state.object = object;
  state.world = object->getWorldTransform();
  state.interpolation = object->getInterpolationWorldTransform();
  state.interpolation_linear = object->getInterpolationLinearVelocity();
  state.interpolation_angular = object->getInterpolationAngularVelocity();
  state.activation_state = object->getActivationState();
  state.deactivation_time = object->getDeactivationTime();
  state.hit_fraction = object->getHitFraction();
  if (const btRigidBody* body = btRigidBody::upcast(object)) {
    state.linear = body->getLinearVelocity();
    state.angular = body->getAngularVelocity();
    state.push = body->getPushVelocity();
    state.turn = body->getTurnVelocity();
    state.force = body->getTotalForce();
    state.torque = body->getTotalTorque();
  }
  return state;
}

/// Bullet has no setter for the accumulated force, only additions that it multiplies by the body's factors.
void set_forces(btRigidBody& body, const btVector3& force, const btVector3& torque) {
  const btVector3 linear_factor = body.getLinearFactor();
  const btVector3 angular_factor = body.getAngularFactor();
  body.clearForces();
  body.setLinearFactor(btVector3(1, 1, 1));
  body.setAngularFactor(btVector3(1, 1, 1));
  body.applyCentralForce(force);
  body.applyTorque(torque);
  body.setLinearFactor(linear_factor);
  body.setAngularFactor(angular_factor);
}

void restore_body(const BodyState& state) {
  btCollisionObject* object = state.object;
  object->setWorldTransform(state.world);
  object->setInterpolationWorldTransform(state.interpolation);
  object->setInterpolationLinearVelocity(state.interpolation_linear);
  object->setInterpolationAngularVelocity(state.interpolation_angular);
  object->forceActivationState(state.activation_state);
  object->setDeactivationTime(state.deactivation_time);
  object->setHitFraction(state.hit_fraction);
  if (btRigidBody* body = btRigidBody::upcast(object)) {
    body->setLinearVelocity(state.linear);
    body->setAngularVelocity(state.angular);
    body->setPushVelocity(state.push);
    body->setTurnVelocity(state.turn);
    // The setters above count as the host's own changes of interpolation in no version of Bullet, but the inertia does
    // follow the orientation.
    set_forces(*body, state.force, state.torque);
    body->updateInertiaTensor();
  }
}

btCollisionDispatcher& dispatcher_of(btDiscreteDynamicsWorld& world) {
  return *static_cast<btCollisionDispatcher*>(world.getDispatcher());
}

/// The solver whose seed Bullet shuffles constraints with; other solvers have none.
btSequentialImpulseConstraintSolver* seeded_solver(btDiscreteDynamicsWorld& world) {
  return dynamic_cast<btSequentialImpulseConstraintSolver*>(world.getConstraintSolver());
}

bool same_bodies(const btPersistentManifold& manifold, const ManifoldState& state) {
  return manifold.getBody0() == state.body0 && manifold.getBody1() == state.body1;
}

}  // namespace

struct BulletSnapshot::State {
  btDiscreteDynamicsWorld& world;
  BulletPenetrationDepthSolver* solver;
  std::vector<BodyState> bodies;
  std::vector<ManifoldState> manifolds;
  std::vector<JointState> joints;
  unsigned long seed = 0;

  [[nodiscard]] bool knows(const btPersistentManifold& manifold) const {
    return std::any_of(manifolds.begin(), manifolds.end(),
                       [&](const ManifoldState& state) { return same_bodies(manifold, state); });
  }

  /// Puts the present manifolds into the saved order, those made since behind them.
  /// @return false where one is missing.
  [[nodiscard]] bool reorder() const {
    btCollisionDispatcher& dispatcher = dispatcher_of(world);
    btPersistentManifold** present = dispatcher.getInternalManifoldPointer();
    const int count = dispatcher.getNumManifolds();
    for (int i = 0; i < static_cast<int>(manifolds.size()); ++i) {
      const ManifoldState& wanted = manifolds[i];
      int ordinal = wanted.ordinal;
      for (int k = 0; k < i; ++k) {
        ordinal -= same_bodies(*present[k], wanted) ? 1 : 0;
      }
      int found = i;
      while (found < count && !(same_bodies(*present[found], wanted) && ordinal-- == 0)) {
        ++found;
      }
      if (found >= count) {
        return false;
      }
      std::rotate(present + i, present + found, present + found + 1);
    }
    for (int i = 0; i < count; ++i) {
      present[i]->m_index1a = i;  // Bullet finds a manifold's slot by this when it releases it
    }
    return true;
  }

  /// Pairs that came into being after the snapshot forget their algorithms, as if they were yet to be found.
  void drop_newer_manifolds() const {
    btOverlappingPairCache* cache = world.getPairCache();
    btBroadphasePairArray& pairs = cache->getOverlappingPairArray();
    for (int i = 0; i < pairs.size(); ++i) {
      if (pairs[i].m_algorithm == nullptr) {
        continue;
      }
      btManifoldArray made;
      pairs[i].m_algorithm->getAllContactManifolds(made);
      bool newer = made.size() > 0;
      for (int k = 0; k < made.size(); ++k) {
        newer = newer && !knows(*made[k]);
      }
      if (newer) {
        cache->cleanOverlappingPair(pairs[i], world.getDispatcher());
      }
    }
  }

  void fill_manifolds() const {
    btCollisionDispatcher& dispatcher = dispatcher_of(world);
    for (int i = 0; i < dispatcher.getNumManifolds(); ++i) {
      btPersistentManifold* manifold = dispatcher.getManifoldByIndexInternal(i);
      const bool saved = i < static_cast<int>(manifolds.size()) && same_bodies(*manifold, manifolds[i]);
      manifold->setNumContacts(saved ? static_cast<int>(manifolds[i].points.size()) : 0);
      for (int k = 0; k < manifold->getNumContacts(); ++k) {
        manifold->getContactPoint(k) = manifolds[i].points[k];
      }
      if (detail::PairMemory* memory = solver ? solver->pairs().find(manifold) : nullptr) {
        *memory = saved && manifolds[i].memory ? *manifolds[i].memory : detail::PairMemory();
      }
    }
  }
};

BulletSnapshot::BulletSnapshot(btDiscreteDynamicsWorld& world, BulletPenetrationDepthSolver* solver)
    : state_(std::make_unique<State>(State{world, solver, {}, {}, {}})) {
  const auto& objects = world.getCollisionObjectArray();
  for (int i = 0; i < objects.size(); ++i) {
    state_->bodies.push_back(save_body(objects[i]));
  }
  btCollisionDispatcher& dispatcher = dispatcher_of(world);
  for (int i = 0; i < dispatcher.getNumManifolds(); ++i) {
    const btPersistentManifold* manifold = dispatcher.getManifoldByIndexInternal(i);
    ManifoldState saved{manifold->getBody0(), manifold->getBody1(), 0, {}, {}};
    for (const ManifoldState& earlier : state_->manifolds) {
      saved.ordinal += same_bodies(*manifold, earlier) ? 1 : 0;
    }
    for (int k = 0; k < manifold->getNumContacts(); ++k) {
      saved.points.push_back(manifold->getContactPoint(k));
    }
    if (const detail::PairMemory* memory = solver ? solver->pairs().find(manifold) : nullptr) {
      saved.memory = *memory;
    }
    state_->manifolds.push_back(std::move(saved));
  }
  for (int i = 0; i < world.getNumConstraints(); ++i) {
    btTypedConstraint* joint = world.getConstraint(i);
    state_->joints.push_back({joint, joint->internalGetAppliedImpulse(), joint->isEnabled()});
  }
  if (const auto* seeded = seeded_solver(world)) {
    state_->seed = seeded->getRandSeed();
  }
}

BulletSnapshot::~BulletSnapshot() = default;
BulletSnapshot::BulletSnapshot(BulletSnapshot&&) noexcept = default;
BulletSnapshot& BulletSnapshot::operator=(BulletSnapshot&&) noexcept = default;

void BulletSnapshot::restore() const {
  btDiscreteDynamicsWorld& world = state_->world;
  for (const BodyState& body : state_->bodies) {
    restore_body(body);
  }
  state_->drop_newer_manifolds();
  if (!state_->reorder()) {
    // A pair went apart since: found again at the saved poses, it gets a manifold again, whose points are then
    // replaced.
    world.performDiscreteCollisionDetection();
    state_->drop_newer_manifolds();
    static_cast<void>(state_->reorder());  // a manifold still missing has no pair in the broadphase: nothing to restore
  }
  state_->fill_manifolds();
  for (const JointState& saved : state_->joints) {
    saved.joint->internalSetAppliedImpulse(saved.applied_impulse);
    saved.joint->setEnabled(saved.enabled);
  }
  if (auto* seeded = seeded_solver(world)) {
    seeded->setRandSeed(state_->seed);
  }
}

}  // namespace pd

#include "pd/bullet/snapshot.hpp"

#include <BulletCollision/BroadphaseCollision/btCollisionAlgorithm.h>
#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>
#include <BulletDynamics/ConstraintSolver/btSequentialImpulseConstraintSolver.h>
#include <BulletDynamics/ConstraintSolver/btTypedConstraint.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "pair/pair_registry.hpp"
#include "pair/solver_core.hpp"
#include "pd/bullet/stack_solver.hpp"
#include "rollback/broadphase_state.hpp"
#include "rollback/multibody_state.hpp"
#include "rollback/substep.hpp"
#include "rollback/world_objects.hpp"

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
  std::size_t first;  ///< of its points
  int count;
  std::optional<detail::PairMemory> memory;

  /// In the memory at hand.
  void save(const btPersistentManifold& manifold, const detail::PairMemory* remembered,
            std::vector<btManifoldPoint>& points);
};

struct JointState {
  btTypedConstraint* joint;
  btScalar applied_impulse;
  bool enabled;
};

void ManifoldState::save(const btPersistentManifold& manifold, const detail::PairMemory* remembered,
                         std::vector<btManifoldPoint>& points) {
  body0 = manifold.getBody0();
  body1 = manifold.getBody1();
  first = points.size();
  count = manifold.getNumContacts();
  for (int k = 0; k < count; ++k) points.push_back(manifold.getContactPoint(k));
  if (remembered == nullptr || remembered->is_blank()) {
    memory.reset();
  } else {
    memory = *remembered;
  }
}

/// In the memory at hand.
void save_body(btCollisionObject* object, BodyState& state) {
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
    detail::set_forces(*body, state.force, state.torque);
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

enum class Likeness { other, possible, same };

/// Whether a manifold is the saved one. Those of patches have numbers; of Bullet's compounds there is one for each pair
/// of children, which only their points name.
Likeness compare(const btPersistentManifold& manifold, const detail::PairMemory* memory, const ManifoldState& state,
                 const std::vector<btManifoldPoint>& points) {
  if (manifold.getBody0() != state.body0 || manifold.getBody1() != state.body1) {
    return Likeness::other;
  }
  const int patch = memory != nullptr ? memory->patch : -1;
  const int saved_patch = state.memory ? state.memory->patch : -1;
  if (patch != saved_patch) return Likeness::other;
  if (patch >= 0) return Likeness::same;
  if (manifold.getNumContacts() == 0 || state.count == 0) {
    return Likeness::possible;
  }
  const btManifoldPoint& a = manifold.getContactPoint(0);
  const btManifoldPoint& b = points[state.first];
  return a.m_index0 == b.m_index0 && a.m_index1 == b.m_index1 && a.m_partId0 == b.m_partId0 &&
                 a.m_partId1 == b.m_partId1
             ? Likeness::same
             : Likeness::other;
}

}  // namespace

struct BulletSnapshot::State {
  btDiscreteDynamicsWorld& world;
  BulletPenetrationDepthSolver* solver;
  detail::PairRegistry* pairs = nullptr;  ///< of an installed solver: it outlives the solver
  detail::WorldObjects objects;
  std::vector<BodyState> bodies;
  std::vector<ManifoldState> manifolds;
  std::vector<btManifoldPoint> points;
  std::vector<JointState> joints;
  detail::MultiBodyState multibodies;
  detail::BroadphaseState broadphase;
  unsigned long seed = 0;
  btAlignedObjectArray<unsigned> stack_memory;

  State(btDiscreteDynamicsWorld& of, BulletPenetrationDepthSolver* installed) : world(of), solver(installed) {}

  void save();
  /// True if the world still has what was saved.
  [[nodiscard]] Restored compare_world() const;

  /// Puts the present manifolds into the saved order, those that the saved state does not know behind them.
  /// @return for each manifold in the new order its saved state, or nullptr.
  [[nodiscard]] std::vector<const ManifoldState*> reorder() const {
    btCollisionDispatcher& dispatcher = dispatcher_of(world);
    btPersistentManifold** present = dispatcher.getInternalManifoldPointer();
    const int count = dispatcher.getNumManifolds();
    std::vector<const ManifoldState*> saved;
    for (const ManifoldState& wanted : manifolds) {
      const int placed = static_cast<int>(saved.size());
      int found = -1;
      for (int i = placed; i < count; ++i) {
        const Likeness likeness =
            compare(*present[i], pairs != nullptr ? pairs->find(present[i]) : nullptr, wanted, points);
        if (likeness == Likeness::same || (likeness == Likeness::possible && found < 0)) {
          found = i;
        }
        if (likeness == Likeness::same) {
          break;
        }
      }
      if (found >= 0) {
        std::rotate(present + placed, present + found, present + found + 1);
        saved.push_back(&wanted);
      }
    }
    saved.resize(static_cast<std::size_t>(count), nullptr);
    for (int i = 0; i < count; ++i) {
      present[i]->m_index1a = i;  // Bullet finds a manifold's slot by this when it releases it
    }
    return saved;
  }

  /// Patches that were found later are found again, in the order in which the solver met them then. Requires: those
  /// of saved pairs stand in the saved order, the others behind them.
  void release_later_patches(const std::vector<const ManifoldState*>& saved) const {
    if (pairs == nullptr) return;
    btCollisionDispatcher& dispatcher = dispatcher_of(world);
    for (int i = dispatcher.getNumManifolds() - 1; i >= 0; --i) {
      // Releasing one takes those of higher numbers along, which are behind the saved ones as well.
      if (i >= dispatcher.getNumManifolds() || saved[static_cast<std::size_t>(i)] != nullptr) continue;
      const detail::PairMemory* memory = pairs->find(dispatcher.getManifoldByIndexInternal(i));
      if (memory != nullptr && memory->patch > 0) memory->owner->release_from(memory->patch);
    }
  }

  /// Hands the saved points to the manifolds; those without saved points are emptied.
  void fill_manifolds(const std::vector<const ManifoldState*>& saved) const {
    btCollisionDispatcher& dispatcher = dispatcher_of(world);
    for (int i = 0; i < dispatcher.getNumManifolds(); ++i) {
      btPersistentManifold* manifold = dispatcher.getManifoldByIndexInternal(i);
      manifold->setNumContacts(saved[i] != nullptr ? saved[i]->count : 0);
      for (int k = 0; k < manifold->getNumContacts(); ++k) {
        manifold->getContactPoint(k) = points[saved[i]->first + static_cast<std::size_t>(k)];
      }
      if (detail::PairMemory* memory = pairs != nullptr ? pairs->find(manifold) : nullptr) {
        const int patch = memory->patch;
        detail::ManifoldOwner* const owner = memory->owner;
        *memory = saved[i] != nullptr && saved[i]->memory ? *saved[i]->memory : detail::PairMemory();
        memory->patch = patch;
        memory->owner = owner;
      }
    }
  }
};

void BulletSnapshot::State::save() {
  objects.note(world);
  broadphase.save(world);
  multibodies.save(world);
  points.clear();
  joints.clear();
  const auto& present_objects = world.getCollisionObjectArray();
  bodies.resize(static_cast<std::size_t>(present_objects.size()));
  for (int i = 0; i < present_objects.size(); ++i) {
    save_body(present_objects[i], bodies[static_cast<std::size_t>(i)]);
  }
  btCollisionDispatcher& dispatcher = dispatcher_of(world);
  const int count = dispatcher.getNumManifolds();
  btPersistentManifold** const present = dispatcher.getInternalManifoldPointer();
  manifolds.resize(static_cast<std::size_t>(count));
  const auto save_manifold = [&](int i, const detail::PairMemory* memory) {
    manifolds[static_cast<std::size_t>(i)].save(*present[i], memory, points);
  };
  if (pairs == nullptr && solver != nullptr && solver->core().installed()) pairs = &solver->pairs();
  if (pairs != nullptr) {
    pairs->visit_all(present, count, save_manifold);
  } else {
    for (int i = 0; i < count; ++i) save_manifold(i, nullptr);
  }
  for (int i = 0; i < world.getNumConstraints(); ++i) {
    btTypedConstraint* joint = world.getConstraint(i);
    joints.push_back({joint, joint->internalGetAppliedImpulse(), joint->isEnabled()});
  }
  if (const auto* seeded = seeded_solver(world)) {
    seed = seeded->getRandSeed();
  }
  if (const auto* stacks = dynamic_cast<const StackSolver*>(world.getConstraintSolver())) {
    stack_memory = stacks->memory();
  }
}

Restored BulletSnapshot::State::compare_world() const {
  if (!objects.same(world, detail::WorldObjects::Shapes::left_alone)) return Restored::objects_differ;
  if (static_cast<std::size_t>(world.getNumConstraints()) != joints.size()) return Restored::joints_differ;
  for (int i = 0; i < world.getNumConstraints(); ++i) {
    if (world.getConstraint(i) != joints[static_cast<std::size_t>(i)].joint) return Restored::joints_differ;
  }
  return multibodies.same(world) ? Restored::yes : Restored::multibodies_differ;
}

const char* message_of(Restored restored) {
  switch (restored) {
    case Restored::objects_differ:
      return "a collision object was added to the world or removed from it since it was saved: save it again";
    case Restored::joints_differ:
      return "a joint was added to the world or removed from it since it was saved: save it again";
    case Restored::multibodies_differ:
      return "a multibody, a link or a multibody's constraint was added or removed since the world was saved: save it "
             "again";
    case Restored::yes:
      break;
  }
  return "restored";
}

BulletSnapshot::BulletSnapshot(btDiscreteDynamicsWorld& world, BulletPenetrationDepthSolver* solver) : state_(nullptr) {
  auto state = std::make_unique<State>(world, solver);
  state->save();
  state_ = state.release();
}

void BulletSnapshot::save_again() { state_->save(); }

BulletSnapshot::~BulletSnapshot() { delete state_; }
BulletSnapshot::BulletSnapshot(BulletSnapshot&& other) noexcept : state_(std::exchange(other.state_, nullptr)) {}
BulletSnapshot& BulletSnapshot::operator=(BulletSnapshot&& other) noexcept {
  std::swap(state_, other.state_);
  return *this;
}

Restored BulletSnapshot::restore() const {
  btDiscreteDynamicsWorld& world = state_->world;
  const Restored possible = state_->compare_world();
  if (possible != Restored::yes) return possible;
  for (const BodyState& body : state_->bodies) {
    restore_body(body);
  }
  state_->multibodies.restore();
  state_->broadphase.restore(world);
  const std::vector<const ManifoldState*> saved = state_->reorder();
  state_->release_later_patches(saved);
  state_->fill_manifolds(saved);
  for (const JointState& joint : state_->joints) {
    joint.joint->internalSetAppliedImpulse(joint.applied_impulse);
    joint.joint->setEnabled(joint.enabled);
  }
  if (auto* seeded = seeded_solver(world)) {
    seeded->setRandSeed(state_->seed);
  }
  if (auto* stacks = dynamic_cast<StackSolver*>(world.getConstraintSolver())) stacks->set_memory(state_->stack_memory);
  return Restored::yes;
}

}  // namespace pd

/// @file
/// A Bullet world out of bytes: what a host may do to bodies, shapes, joints and solvers between two steps. Judged by
/// what holds of every step: poses and contact points are finite, manifolds join objects that are there, and the same
/// actions give the same bits.
#include <BulletCollision/CollisionDispatch/btGhostObject.h>
#include <btBulletDynamicsCommon.h>

#include <bit>
#include <memory>
#include <optional>

#include "fuzz/world_shapes.hpp"
#include "pd/bullet/install.hpp"
#include "pd/bullet/rollback.hpp"
#include "pd/bullet/snapshot.hpp"
#include "pd/bullet/solver_settings.hpp"
#include "pd/bullet/stack_solver.hpp"
#include "pd/bullet/world_queries.hpp"

namespace pd::fuzz {

namespace {

bool finite(const btVector3& v) { return std::isfinite(v.x()) && std::isfinite(v.y()) && std::isfinite(v.z()); }

/// The world of one input. The bytes decide what dies first of solver, world and bodies.
class Room {
 public:
  explicit Room(std::span<const std::uint8_t> bytes) : input_(bytes) {
    solver_ = std::make_unique<BulletPenetrationDepthSolver>(settings());
    impulses_ = input_.choice(2) == 0 ? std::make_unique<btSequentialImpulseConstraintSolver>()
                                      : std::make_unique<StackSolver>();
    if (input_.choice(2) == 0) {
      broadphase_ = std::make_unique<btDbvtBroadphase>();
    } else {
      broadphase_ = std::make_unique<btAxisSweep3>(btVector3(-100, -100, -100), btVector3(100, 100, 100));
    }
    world_ =
        std::make_unique<btDiscreteDynamicsWorld>(&dispatcher_, broadphase_.get(), impulses_.get(), &configuration_);
    world_->setGravity(btVector3(0, btScalar(-9.81), 0));
    broadphase_->getOverlappingPairCache()->setInternalGhostPairCallback(&ghost_pairs_);
    install(*world_, *solver_);
  }
  ~Room() {
    saved_.reset();
    if (input_.choice(2) == 0) solver_.reset();
    for (int i = world_->getNumConstraints(); i > 0; --i) world_->removeConstraint(world_->getConstraint(i - 1));
    if (input_.choice(2) == 0) {
      while (!objects_.empty()) remove(0);
      world_.reset();
    } else {
      world_.reset();
      objects_.clear();
    }
  }
  Room(const Room&) = delete;
  Room& operator=(const Room&) = delete;

  /// All actions that the bytes name; returns a hash of all poses after each step.
  std::uint64_t live() {
    for (int i = 0; i < 60 && !input_.empty(); ++i) {
      act();
      if (steps_ > 24) break;
    }
    step();
    return hash_;
  }

 private:
  BulletSolverSettings settings() {
    BulletSolverSettings chosen;
    chosen.one_sided_meshes = input_.choice(2) == 1;
    return chosen;
  }

  void add() {
    btCollisionShape* shape = shapes_.any_shape();
    const int kind = input_.choice(8);
    const btTransform at = shapes_.pose();
    if (kind == 7) {
      auto ghost = std::make_unique<btPairCachingGhostObject>();
      ghost->setCollisionShape(shape);
      ghost->setWorldTransform(at);
      ghost->setCollisionFlags(ghost->getCollisionFlags() | btCollisionObject::CF_NO_CONTACT_RESPONSE);
      world_->addCollisionObject(ghost.get());
      objects_.push_back(std::move(ghost));
      return;
    }
    const btScalar mass = kind < 5 && WorldShapes::may_move(shape) ? shapes_.length() : btScalar(0);
    btVector3 inertia(0, 0, 0);
    if (mass > 0) shape->calculateLocalInertia(mass, inertia);
    btRigidBody::btRigidBodyConstructionInfo info(mass, nullptr, shape, inertia);
    info.m_startWorldTransform = at;
    info.m_friction = shapes_.length() / 2;
    info.m_restitution = btScalar(input_.choice(3)) / 2;
    auto body = std::make_unique<btRigidBody>(info);
    if (kind == 6) body->setCollisionFlags(body->getCollisionFlags() | btCollisionObject::CF_KINEMATIC_OBJECT);
    world_->addRigidBody(body.get());
    objects_.push_back(std::move(body));
  }

  void remove(std::size_t which) {
    btCollisionObject* object = objects_[which].get();
    if (auto* body = btRigidBody::upcast(object)) {
      // A body knows only the joints that end its collisions with the other one.
      for (int i = world_->getNumConstraints(); i > 0; --i) {
        btTypedConstraint* joint = world_->getConstraint(i - 1);
        if (&joint->getRigidBodyA() == body || &joint->getRigidBodyB() == body) world_->removeConstraint(joint);
      }
      world_->removeRigidBody(body);
    } else {
      world_->removeCollisionObject(object);
    }
    objects_.erase(objects_.begin() + static_cast<std::ptrdiff_t>(which));
  }

  void change_shape(btCollisionObject& object) {
    btCollisionShape* shape = object.getCollisionShape();
    switch (input_.choice(6)) {
      case 0:
        shape->setLocalScaling(shapes_.scaling());
        break;
      case 1:
        shape->setMargin(shapes_.length() / 8);
        break;
      case 2: {
        btCollisionShape* other = shapes_.any_shape();
        if (object.isStaticOrKinematicObject() || WorldShapes::may_move(other)) {
          object.setCollisionShape(other);
          // Bullet chooses a pair's algorithm by the kinds of its shapes, once: a host has the pairs made again.
          broadphase_->getOverlappingPairCache()->cleanProxyFromPairs(object.getBroadphaseHandle(), &dispatcher_);
        }
        break;
      }
      case 3:
        if (shape->isCompound()) {
          auto* whole = static_cast<btCompoundShape*>(shape);
          const int count = whole->getNumChildShapes();
          const int kind = input_.choice(3);
          if (kind == 0) {
            whole->addChildShape(shapes_.pose(), shapes_.convex());
          } else if (count > 0 && kind == 1) {
            whole->removeChildShapeByIndex(input_.choice(count));
          } else if (count > 0) {
            whole->updateChildTransform(input_.choice(count), shapes_.pose());
          }
        }
        break;
      case 4:
        if (shape->getShapeType() == CONVEX_HULL_SHAPE_PROXYTYPE) {
          static_cast<btConvexHullShape*>(shape)->addPoint(shapes_.place(), true);
        }
        break;
      default:
        if (shape->getShapeType() == TRIANGLE_MESH_SHAPE_PROXYTYPE) {
          shapes_.bend(static_cast<btBvhTriangleMeshShape&>(*shape));
        }
    }
  }

  void join(btRigidBody& a, btRigidBody& b) {
    if (&a == &b || (a.getInvMass() == 0 && b.getInvMass() == 0)) return;
    std::unique_ptr<btTypedConstraint> joint;
    const btVector3 in_a = shapes_.place(), in_b = shapes_.place(), axis(0, 1, 0);
    if (input_.choice(2) == 0) {
      joint = std::make_unique<btPoint2PointConstraint>(a, b, in_a, in_b);
    } else {
      joint = std::make_unique<btHingeConstraint>(a, b, in_a, in_b, axis, axis);
    }
    world_->addConstraint(joint.get(), input_.choice(2) == 0);
    joints_.push_back(std::move(joint));
  }

  void ask(btCollisionObject& object) {
    struct : btCollisionWorld::ContactResultCallback {
      btScalar addSingleResult(btManifoldPoint& point, const btCollisionObjectWrapper*, int, int,
                               const btCollisionObjectWrapper*, int, int) override {
        PD_LAW(finite(point.getPositionWorldOnA()) && finite(point.m_normalWorldOnB));
        return 0;
      }
    } noted;
    const int kind = input_.choice(4);
    if (kind == 0) {
      world_->contactTest(&object, noted);
    } else if (kind == 1) {
      world_->contactPairTest(&object, objects_[static_cast<std::size_t>(input_.byte()) % objects_.size()].get(),
                              noted);
    } else {
      const btConvexShape* shape = shapes_.convex();
      const btTransform from = shapes_.pose(), to = shapes_.pose();
      if (kind == 2) {
        const auto met = sweep_test(*world_, *shape, from, to);
        if (met && met->hit) PD_LAW(met->hit->fraction >= 0 && met->hit->fraction <= 1);
      } else {
        const auto near = distance_test(*world_, *shape, from, 2);
        if (near && near->nearest) PD_LAW(std::isfinite(near->nearest->distance));
      }
    }
  }

  void act() {
    const int kind = input_.choice(24);
    if (kind < 6 || objects_.empty()) {
      if (objects_.size() < 24) add();
      return;
    }
    const std::size_t which = static_cast<std::size_t>(input_.byte()) % objects_.size();
    btCollisionObject& object = *objects_[which];
    btRigidBody* body = btRigidBody::upcast(&object);
    switch (kind) {
      case 6:
        remove(which);
        break;
      case 7:
      case 8:
        change_shape(object);
        break;
      case 9:
        object.setWorldTransform(shapes_.pose());
        if (body != nullptr) body->setInterpolationWorldTransform(body->getWorldTransform());
        object.activate(true);
        break;
      case 10:
        if (body != nullptr) {
          body->setLinearVelocity(shapes_.place() * btScalar(4));
          body->setAngularVelocity(shapes_.place());
          body->activate(true);
        }
        break;
      case 11:
        uninstall(*world_, *solver_);
        break;
      case 12:
        install(*world_, *solver_, input_.choice(3) == 0 ? BulletContacts::persistent : BulletContacts::one_shot);
        break;
      case 13:
        if (auto* other =
                btRigidBody::upcast(objects_[static_cast<std::size_t>(input_.byte()) % objects_.size()].get());
            body != nullptr && other != nullptr) {
          join(*body, *other);
        }
        break;
      case 14:
        if (world_->getNumConstraints() > 0) {
          world_->removeConstraint(world_->getConstraint(input_.choice(world_->getNumConstraints())));
        }
        break;
      case 15:
        if (saved_) {
          (void)saved_->restore();
        } else {
          saved_.emplace(*world_, solver_.get());
        }
        break;
      case 16:
        ask(object);
        break;
      case 17:
        apply_recommended(world_->getSolverInfo());
        break;
      case 18: {
        RollbackStepper stepper(*world_, *solver_);
        (void)stepper.step(btScalar(1) / 60);
        judge();
        break;
      }
      case 19:
        (void)prepare(*world_, *solver_);
        break;
      case 20:
        change_body(object);
        break;
      case 21:
        world_->stepSimulation(shapes_.length() / 16, 4, btScalar(1) / 120);
        judge();
        break;
      default:
        step();
    }
  }

  void change_body(btCollisionObject& object) {
    btRigidBody* body = btRigidBody::upcast(&object);
    switch (input_.choice(6)) {
      case 0:
        object.setRestitution(shapes_.length() / 2);
        break;
      case 1:
        object.setCcdMotionThreshold(shapes_.length() / 8);
        object.setCcdSweptSphereRadius(shapes_.length() / 8);
        break;
      case 2:
        object.setActivationState(input_.choice(2) == 0 ? DISABLE_DEACTIVATION : DISABLE_SIMULATION);
        break;
      case 3:
        world_->setGravity(shapes_.place() * btScalar(8));
        break;
      case 4:
        world_->updateSingleAabb(&object);
        break;
      default:
        // A body at rest that becomes one that moves, or the other way round, is taken out of the world meanwhile.
        if (body != nullptr && WorldShapes::may_move(body->getCollisionShape()) && !body->isKinematicObject()) {
          world_->removeRigidBody(body);
          const btScalar mass = body->getInvMass() > 0 ? btScalar(0) : shapes_.length();
          btVector3 inertia(0, 0, 0);
          if (mass > 0) body->getCollisionShape()->calculateLocalInertia(mass, inertia);
          body->setMassProps(mass, inertia);
          body->setLinearVelocity(btVector3(0, 0, 0));
          body->setAngularVelocity(btVector3(0, 0, 0));
          world_->addRigidBody(body);
        }
    }
  }

  void step() {
    world_->stepSimulation(btScalar(1) / 60, 0);
    judge();
  }

  void judge() {
    ++steps_;
    for (const auto& object : objects_) {
      const btTransform& at = object->getWorldTransform();
      PD_LAW(finite(at.getOrigin()) && finite(at.getBasis()[0]));
      for (int i = 0; i < 3; ++i) note(at.getOrigin()[i]);
    }
    for (int i = 0; i < dispatcher_.getNumManifolds(); ++i) {
      const btPersistentManifold& manifold = *dispatcher_.getManifoldByIndexInternal(i);
      PD_LAW(manifold.getNumContacts() <= MANIFOLD_CACHE_SIZE);
      for (int k = 0; k < manifold.getNumContacts(); ++k) {
        const btManifoldPoint& point = manifold.getContactPoint(k);
        PD_LAW(finite(point.getPositionWorldOnA()) && finite(point.getPositionWorldOnB()));
        PD_LAW(std::isfinite(point.getDistance()));
        PD_LAW(std::abs(point.m_normalWorldOnB.length() - 1) < btScalar(1e-3));
      }
      for (const btCollisionObject* side : {manifold.getBody0(), manifold.getBody1()}) {
        bool there = false;
        for (const auto& object : objects_) there = there || object.get() == side;
        PD_LAW(there);
      }
    }
  }
  void note(btScalar value) {
    hash_ = (hash_ ^ std::bit_cast<std::uint64_t>(static_cast<double>(value))) * 0x100000001b3;
  }

  Input input_;
  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_{&configuration_};
  btGhostPairCallback ghost_pairs_;
  std::unique_ptr<btBroadphaseInterface> broadphase_;
  WorldShapes shapes_{input_};
  std::vector<std::unique_ptr<btTypedConstraint>> joints_;
  std::vector<std::unique_ptr<btCollisionObject>> objects_;
  std::unique_ptr<btSequentialImpulseConstraintSolver> impulses_;
  std::unique_ptr<btDiscreteDynamicsWorld> world_;
  std::unique_ptr<BulletPenetrationDepthSolver> solver_;
  std::optional<BulletSnapshot> saved_;
  std::uint64_t hash_ = 0xcbf29ce484222325;
  int steps_ = 0;
};

std::uint64_t live(std::span<const std::uint8_t> bytes) { return Room(bytes).live(); }

}  // namespace

}  // namespace pd::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::uint64_t first = pd::fuzz::live({data, size});
  PD_LAW(first == pd::fuzz::live({data, size}));
  return 0;
}

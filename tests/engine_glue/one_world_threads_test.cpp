/// @file
/// One world whose pairs are dispatched by several threads (btCollisionDispatcherMt). Bullet does so only where it was
/// built with BT_THREADSAFE, which Debian's is not: tests/long/threads.sh builds it from Debian's source package.
#include <LinearMath/btScalar.h>

#if BT_THREADSAFE

#include <BulletCollision/CollisionDispatch/btCollisionDispatcherMt.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "engine_glue/union_worlds.hpp"

namespace pd::test {
namespace {

constexpr int kThreads = 8;  // Bullet takes no more than there are cores
constexpr int kGrain = 1;    // pairs a task: as mixed as can be

/// Bullet's threads, for the life of the process: a scheduler that is made twice leaves its threads behind.
btITaskScheduler& scheduler() {
  static btITaskScheduler* const threads = btCreateDefaultTaskScheduler();
  return *threads;
}

void use_threads(int count) {
  scheduler().setNumThreads(count);
  btSetTaskScheduler(&scheduler());
}

/// Puts manifolds into the order of their pairs after every dispatch: which thread made one first no longer shows.
class OrderedDispatcher : public btCollisionDispatcherMt {
 public:
  explicit OrderedDispatcher(btCollisionConfiguration* configuration)
      : btCollisionDispatcherMt(configuration, kGrain) {}

  void dispatchAllCollisionPairs(btOverlappingPairCache* pairs, const btDispatcherInfo& info,
                                 btDispatcher* dispatcher) override {
    btCollisionDispatcherMt::dispatchAllCollisionPairs(pairs, info, dispatcher);
    std::vector<std::pair<std::pair<int, int>, btCollisionAlgorithm*>> algorithms;
    for (int i = 0; i < pairs->getNumOverlappingPairs(); ++i) {
      const btBroadphasePair& pair = pairs->getOverlappingPairArray()[i];
      if (pair.m_algorithm == nullptr) continue;
      algorithms.push_back({{pair.m_pProxy0->getUid(), pair.m_pProxy1->getUid()}, pair.m_algorithm});
    }
    std::sort(algorithms.begin(), algorithms.end());
    btManifoldArray ordered;
    for (const auto& [uids, algorithm] : algorithms) algorithm->getAllContactManifolds(ordered);
    ASSERT_EQ(ordered.size(), m_manifoldsPtr.size());
    for (int i = 0; i < ordered.size(); ++i) {
      m_manifoldsPtr[i] = ordered[i];
      ordered[i]->m_index1a = i;
    }
  }
};

/// A mesh with walls, boxes, hulls, spheres, capsules, cylinders, multispheres and compounds that fall into a heap.
class Heap {
 public:
  explicit Heap(int threads) {
    use_threads(threads);
    dispatcher_ = std::make_unique<OrderedDispatcher>(&configuration_);
    world_ = std::make_unique<btDiscreteDynamicsWorld>(dispatcher_.get(), &broadphase_, &constraint_solver_,
                                                       &configuration_);
    // Islands in the order of their bodies, too.
    world_->getDispatchInfo().m_deterministicOverlappingPairs = true;
    world_->setGravity(btVector3(0, btScalar(-9.81), 0));
    install(*world_, solver_);
    fill();
  }
  ~Heap() {
    for (auto& body : bodies_) world_->removeRigidBody(body.get());
  }
  Heap(const Heap&) = delete;
  Heap& operator=(const Heap&) = delete;

  void step(int count) {
    for (int i = 0; i < count; ++i) world_->stepSimulation(btScalar(1) / 60, 0);
  }

  /// Poses and velocities.
  [[nodiscard]] std::vector<btScalar> state() const {
    std::vector<btScalar> numbers;
    for (const auto& body : bodies_) {
      btScalar matrix[16];
      body->getWorldTransform().getOpenGLMatrix(matrix);
      numbers.insert(numbers.end(), matrix, matrix + 16);
      for (const btVector3& v : {body->getLinearVelocity(), body->getAngularVelocity()}) {
        numbers.insert(numbers.end(), {v.x(), v.y(), v.z()});
      }
    }
    return numbers;
  }

  /// Every point of every manifold, with what the solver is told of it.
  [[nodiscard]] std::vector<btScalar> points() const {
    std::vector<btScalar> numbers;
    for (int i = 0; i < dispatcher_->getNumManifolds(); ++i) {
      const btPersistentManifold& manifold = *dispatcher_->getManifoldByIndexInternal(i);
      numbers.push_back(static_cast<btScalar>(manifold.getNumContacts()));
      for (int k = 0; k < manifold.getNumContacts(); ++k) {
        const btManifoldPoint& point = manifold.getContactPoint(k);
        for (const btVector3& v : {point.m_positionWorldOnA, point.m_positionWorldOnB, point.m_normalWorldOnB,
                                   point.m_localPointA, point.m_localPointB}) {
          numbers.insert(numbers.end(), {v.x(), v.y(), v.z()});
        }
        numbers.insert(numbers.end(), {point.getDistance(), point.m_appliedImpulse, point.m_combinedFriction});
      }
    }
    return numbers;
  }

  [[nodiscard]] const BulletPenetrationDepthSolver& solver() const { return solver_; }
  [[nodiscard]] btDiscreteDynamicsWorld& world() { return *world_; }
  [[nodiscard]] std::vector<std::unique_ptr<btRigidBody>>& bodies() { return bodies_; }

 private:
  static btVector3 vector(double x, double y, double z) {
    return btVector3(static_cast<btScalar>(x), static_cast<btScalar>(y), static_cast<btScalar>(z));
  }

  template <class Shape, class... Arguments>
  Shape* shape(Arguments&&... arguments) {
    auto made = std::make_unique<Shape>(std::forward<Arguments>(arguments)...);
    Shape* const raw = made.get();
    shapes_.push_back(std::move(made));
    return raw;
  }

  void add(btCollisionShape* body_shape, btScalar mass, const btTransform& pose) {
    btVector3 inertia(0, 0, 0);
    if (mass > 0) body_shape->calculateLocalInertia(mass, inertia);
    btRigidBody::btRigidBodyConstructionInfo info(mass, nullptr, body_shape, inertia);
    info.m_startWorldTransform = pose;
    bodies_.push_back(std::make_unique<btRigidBody>(info));
    bodies_.back()->setActivationState(DISABLE_DEACTIVATION);
    world_->addRigidBody(bodies_.back().get());
  }

  void fill() {
    std::vector<UnionWorld::Triangle> triangles;
    add_floor(triangles, -3, 3, -3, 3, 6, 6);
    for (const auto& t : triangles) mesh_.addTriangle(t[0], t[1], t[2]);
    add(shape<btBvhTriangleMeshShape>(&mesh_, true), 0, btTransform::getIdentity());
    for (const double side : {-2.2, 2.2}) {
      add(shape<btBoxShape>(vector(0.2, 3, 3)), 0, btTransform(btQuaternion::getIdentity(), vector(side, 3, 0)));
      add(shape<btBoxShape>(vector(3, 3, 0.2)), 0, btTransform(btQuaternion::getIdentity(), vector(0, 3, side)));
    }
    auto* hull = shape<btConvexHullShape>();
    for (int i = 0; i < 24; ++i) {
      hull->addPoint(vector(0.3 * std::sin(i), 0.3 * std::cos(2.3 * i), 0.3 * std::sin(1.7 * i + 1)));
    }
    const btVector3 centres[3] = {vector(-0.2, 0, 0), vector(0.2, 0, 0), vector(0, 0.2, 0.1)};
    const btScalar radii[3] = {btScalar(0.2), btScalar(0.1), btScalar(0.15)};
    auto* ell = shape<btCompoundShape>();
    auto* bar = shape<btBoxShape>(vector(0.35, 0.1, 0.1));
    ell->addChildShape(btTransform(btQuaternion::getIdentity(), vector(0, 0, 0)), bar);
    ell->addChildShape(btTransform(btQuaternion::getIdentity(), vector(0.25, 0.3, 0)),
                       shape<btBoxShape>(vector(0.1, 0.2, 0.1)));
    btCollisionShape* const kinds[] = {shape<btBoxShape>(vector(0.25, 0.2, 0.3)),
                                       hull,
                                       shape<btSphereShape>(btScalar(0.25)),
                                       shape<btCapsuleShape>(btScalar(0.15), btScalar(0.4)),
                                       shape<btCylinderShape>(vector(0.2, 0.25, 0.2)),
                                       shape<btMultiSphereShape>(centres, radii, 3),
                                       ell};
    for (int i = 0; i < 56; ++i) {
      const btQuaternion turn(static_cast<btScalar>(i + 1), static_cast<btScalar>(2 * i), static_cast<btScalar>(3 * i));
      add(kinds[i % 7], 1, btTransform(turn, vector(0.9 * (i % 3 - 1), 0.6 + 0.3 * (i / 3), 0.9 * ((i / 9) % 3 - 1))));
    }
  }

  BulletPenetrationDepthSolver solver_;
  btTriangleMesh mesh_;
  std::vector<std::unique_ptr<btCollisionShape>> shapes_;
  btDefaultCollisionConfiguration configuration_;
  btDbvtBroadphase broadphase_;
  btSequentialImpulseConstraintSolver constraint_solver_;
  std::unique_ptr<OrderedDispatcher> dispatcher_;
  std::unique_ptr<btDiscreteDynamicsWorld> world_;
  std::vector<std::unique_ptr<btRigidBody>> bodies_;
};

/// Step by step from one thread's poses: the points of several are the same bits, impulses carried over included,
/// and so is where they lead.
TEST(OneWorldThreads, PointsAndTrajectoriesAreThoseOfOneThread) {
  constexpr int kSteps = 150;
  std::vector<std::vector<btScalar>> points, states;
  {
    Heap alone(1);
    for (int i = 0; i < kSteps; ++i) {
      alone.step(1);
      points.push_back(alone.points());
      states.push_back(alone.state());
    }
    EXPECT_GT(points.back().size(), 2000u);
    EXPECT_EQ(alone.solver().statistics().unsupported, 0);
  }
  for (int run = 0; run < 2; ++run) {
    Heap together(kThreads);
    ASSERT_GT(btGetTaskScheduler()->getNumThreads(), 1) << "one core: nothing is shown here";
    for (int i = 0; i < kSteps; ++i) {
      together.step(1);
      ASSERT_EQ(together.points(), points[static_cast<std::size_t>(i)]) << "step " << i;
      ASSERT_EQ(together.state(), states[static_cast<std::size_t>(i)]) << "step " << i;
    }
  }
}

}  // namespace
}  // namespace pd::test

#endif  // BT_THREADSAFE

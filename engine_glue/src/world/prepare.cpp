#include <BulletCollision/CollisionShapes/btCompoundShape.h>
#include <BulletCollision/CollisionShapes/btConvexShape.h>
#include <BulletDynamics/Featherstone/btMultiBodyConstraintSolver.h>
#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>

#include <algorithm>
#include <unordered_set>

#include "pd/bullet/install.hpp"
#include "pd/bullet/shape_cache.hpp"
#include "shapes/cached_shape.hpp"

namespace pd {

namespace {

class Preparation {
 public:
  explicit Preparation(BulletShapeCache& cache) : cache_(cache) {}

  void add(const btCollisionShape& shape) {
    if (!seen_.insert(&shape).second) return;
    if (shape.isCompound()) {
      const auto& compound = static_cast<const btCompoundShape&>(shape);
      for (int i = 0; i < compound.getNumChildShapes(); ++i) add(*compound.getChildShape(i));
    } else if (shape.isConvex()) {
      const auto entry = cache_.find(static_cast<const btConvexShape&>(shape), 0);
      entry->used.store(true, std::memory_order_relaxed);
      ++done_.shapes;
      if (!entry->body) ++done_.without_form;
    }
  }
  [[nodiscard]] const PreparedShapes& done() const { return done_; }

 private:
  BulletShapeCache& cache_;
  std::unordered_set<const btCollisionShape*> seen_;
  PreparedShapes done_;
};

/// Bullet's arrays of a multibody's rows grow by one row at a time, and are copied each time. Once they are as large as
/// a step needs, they stay so.
class RowsOfMultiBodies : private btMultiBodyConstraintSolver {
 public:
  RowsOfMultiBodies() = delete;

  static void reserve(btMultiBodyConstraintSolver& solver, const btMultiBodyDynamicsWorld& world) {
    // Points that a collider may have in a piled up world, rows of a point, and numbers of a row for both bodies.
    constexpr double kPoints = 16, kRows = 3, kBodies = 2;
    constexpr double kMostNumbers = 1 << 22;
    double numbers = 0, degrees = 0;
    for (int i = 0; i < world.getNumMultibodies(); ++i) {
      const btMultiBody& body = *world.getMultiBody(i);
      const double of_body = 6 + body.getNumDofs();
      degrees += of_body;
      numbers += (1 + body.getNumLinks()) * kPoints * kRows * kBodies * of_body;
    }
    const int count = static_cast<int>(std::min(numbers, kMostNumbers));
    btMultiBodyJacobianData& data = solver.*(&RowsOfMultiBodies::m_data);
    data.m_jacobians.reserve(count);
    data.m_deltaVelocitiesUnitImpulse.reserve(count);
    data.m_deltaVelocities.reserve(static_cast<int>(std::min(degrees, kMostNumbers)));
  }
};

}  // namespace

PreparedShapes prepare(btCollisionWorld& world, BulletPenetrationDepthSolver& solver) {
  Preparation preparation(solver.cache());
  const btCollisionObjectArray& objects = world.getCollisionObjectArray();
  for (int i = 0; i < objects.size(); ++i) preparation.add(*objects[i]->getCollisionShape());
  if (auto* articulated = dynamic_cast<btMultiBodyDynamicsWorld*>(&world)) {
    auto* rows = dynamic_cast<btMultiBodyConstraintSolver*>(articulated->getConstraintSolver());
    if (rows != nullptr) RowsOfMultiBodies::reserve(*rows, *articulated);
  }
  return preparation.done();
}

}  // namespace pd

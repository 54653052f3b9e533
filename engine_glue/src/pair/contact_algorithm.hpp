/// @file
/// The contact algorithm of a convex pair: one exact answer a step, and the whole manifold from it at once.
#pragma once

#include <BulletCollision/CollisionDispatch/btActivatingCollisionAlgorithm.h>
#include <BulletCollision/CollisionDispatch/btCollisionCreateFunc.h>
#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>
#include <BulletCollision/CollisionDispatch/btManifoldResult.h>
#include <BulletCollision/NarrowPhaseCollision/btConvexPenetrationDepthSolver.h>
#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>

#include "pair/own_manifold.hpp"
#include "pd/contact/manifold.hpp"

namespace pd::detail {

class Installation;
class SolverCore;
struct PairAnswer;

/// Bullet's own algorithm finds one point a step and needs several steps for a face; this one has up to four from the
/// first step. Impulses go from last step's points to this step's by feature, else by place, so that the constraint
/// solver starts warm. A manifold that Bullet shares between pairs (mesh triangles) is added to and never cleared.
class ContactAlgorithm final : public btActivatingCollisionAlgorithm {
 public:
  ContactAlgorithm(const btCollisionAlgorithmConstructionInfo& info, const btCollisionObjectWrapper* a,
                   const btCollisionObjectWrapper* b, const Installation& installation);

  void processCollision(const btCollisionObjectWrapper* a, const btCollisionObjectWrapper* b,
                        const btDispatcherInfo& info, btManifoldResult* result) override;
  /// Exact first contact of the motion from each body's present to its interpolation transform, as a fraction of it;
  /// 1 without contact. (No world of Bullet 3 calls it.)
  btScalar calculateTimeOfImpact(btCollisionObject* a, btCollisionObject* b, const btDispatcherInfo& info,
                                 btManifoldResult* result) override;
  void getAllContactManifolds(btManifoldArray& manifolds) override;
  /// Whether boxes that are children of compounds are taken without their margin.
  [[nodiscard]] bool sharp_parts() const;

  struct CreateFunc : public btCollisionAlgorithmCreateFunc {
    /// `closest`: stands in the dispatcher's table of closest points, else in that of contacts
    CreateFunc(const Installation& i, bool closest) : installation(i), for_closest_points(closest) {}
    btCollisionAlgorithm* CreateCollisionAlgorithm(btCollisionAlgorithmConstructionInfo& info,
                                                   const btCollisionObjectWrapper* a,
                                                   const btCollisionObjectWrapper* b) override;
    const Installation& installation;
    bool for_closest_points;
  };

 private:
  void process_by_bullet(btConvexPenetrationDepthSolver& solver, const btConvexShape& a, const btTransform& transform_a,
                         const btConvexShape& b, const btTransform& transform_b, const btDispatcherInfo& info,
                         btManifoldResult* result);

  const Installation& installation_;
  OwnManifold manifold_;
};

}  // namespace pd::detail

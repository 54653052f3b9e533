/// @file
/// The contact algorithm of a convex body and a `btStaticPlaneShape`: the whole manifold from the first step.
#pragma once

#include <BulletCollision/CollisionDispatch/btActivatingCollisionAlgorithm.h>
#include <BulletCollision/CollisionDispatch/btCollisionCreateFunc.h>
#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>
#include <BulletCollision/CollisionDispatch/btManifoldResult.h>

#include "pair/own_manifold.hpp"

namespace pd::detail {

class BulletsStandIn;
class Installation;

/// Bullet's own algorithm finds one point a step, the farthest in the plane, so that a face needs several steps to lie
/// down. The body is taken as it is there: boxes sharp, other shapes core and margin; the plane's margin counts for
/// nothing.
class PlaneAlgorithm final : public btActivatingCollisionAlgorithm {
 public:
  /// @param swapped  a is the plane
  PlaneAlgorithm(const btCollisionAlgorithmConstructionInfo& info, const btCollisionObjectWrapper* a,
                 const btCollisionObjectWrapper* b, const Installation& installation, bool swapped);
  ~PlaneAlgorithm() override;

  void processCollision(const btCollisionObjectWrapper* a, const btCollisionObjectWrapper* b,
                        const btDispatcherInfo& info, btManifoldResult* result) override;
  /// 1: as without motion; no world of Bullet 3 asks.
  btScalar calculateTimeOfImpact(btCollisionObject*, btCollisionObject*, const btDispatcherInfo&,
                                 btManifoldResult*) override {
    return btScalar(1);
  }
  void getAllContactManifolds(btManifoldArray& manifolds) override;

  struct CreateFunc : public btCollisionAlgorithmCreateFunc {
    CreateFunc(const Installation& i, bool swapped) : installation(i) { m_swapped = swapped; }
    btCollisionAlgorithm* CreateCollisionAlgorithm(btCollisionAlgorithmConstructionInfo& info,
                                                   const btCollisionObjectWrapper* a,
                                                   const btCollisionObjectWrapper* b) override;
    const Installation& installation;
  };

 private:
  /// @return false: Bullet's algorithm is to answer
  bool find(const btCollisionObjectWrapper& body, const btCollisionObjectWrapper& plane, bool first,
            btManifoldResult& result, FreshPoints& fresh);

  const Installation& installation_;
  bool swapped_;
  OwnManifold manifold_;
  std::unique_ptr<BulletsStandIn> bullets_;
};

}  // namespace pd::detail

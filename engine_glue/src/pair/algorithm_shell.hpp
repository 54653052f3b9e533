/// @file
/// The part that all of our collision algorithms share: how Bullet makes them, and when Bullet's own one is made
/// instead.
#pragma once

#include <BulletCollision/CollisionDispatch/btActivatingCollisionAlgorithm.h>
#include <BulletCollision/CollisionDispatch/btConvexConvexAlgorithm.h>
#include <BulletCollision/CollisionDispatch/btManifoldResult.h>

#include "pair/solver_in_world.hpp"

namespace pd::detail {

class AlgorithmShell : public btActivatingCollisionAlgorithm {
 public:
  /// 1: as without motion; no world of Bullet 3 asks.
  btScalar calculateTimeOfImpact(btCollisionObject*, btCollisionObject*, const btDispatcherInfo&,
                                 btManifoldResult*) override {
    return btScalar(1);
  }

 protected:
  using btActivatingCollisionAlgorithm::btActivatingCollisionAlgorithm;
};

/// Makes algorithms of one class for pairs that the host leaves to us. `Algorithm::Kind` is the rest of what its
/// constructor takes. It says from which table Bullet's own algorithm comes where a pair is not ours, and it may
/// decline pairs by `takes(world, a, b)`.
template <class Algorithm>
struct CreateFuncOf final : public btCollisionAlgorithmCreateFunc {
  CreateFuncOf(const SolverInWorld& w, const typename Algorithm::Kind& k) : world(w), kind(k) {}
  btCollisionAlgorithm* CreateCollisionAlgorithm(btCollisionAlgorithmConstructionInfo& info,
                                                 const btCollisionObjectWrapper* a,
                                                 const btCollisionObjectWrapper* b) override {
    // Bullet's pool gives out pieces of a fixed size and checks it by assertion only.
    static_assert(sizeof(Algorithm) <= sizeof(btConvexConvexAlgorithm));
    bool ours = world.takes(*a, *b);
    if constexpr (requires { kind.takes(world, *a, *b); }) ours = ours && kind.takes(world, *a, *b);
    if (!ours) return world.bullets_algorithm(info, a, b, kind.table);
    void* memory = info.m_dispatcher1->allocateCollisionAlgorithm(sizeof(Algorithm));
    return new (memory) Algorithm(info, a, b, world, kind);
  }

  const SolverInWorld& world;
  typename Algorithm::Kind kind;
};

}  // namespace pd::detail

/// @file
/// Bullet's own algorithm behind one of ours, for what ours does not answer.
#pragma once

#include <BulletCollision/CollisionDispatch/btCollisionCreateFunc.h>
#include <BulletCollision/CollisionDispatch/btManifoldResult.h>

#include "pair/solver_in_world.hpp"

namespace pd::detail {

/// Made when it is first needed, with manifolds of its own.
class BulletsStandIn {
 public:
  BulletsStandIn(const SolverInWorld& world, btDispatcher& dispatcher) : world_(world), dispatcher_(dispatcher) {}
  ~BulletsStandIn() { release(); }
  BulletsStandIn(const BulletsStandIn&) = delete;
  BulletsStandIn& operator=(const BulletsStandIn&) = delete;

  /// @param table  of the dispatcher's own configuration, from which the algorithm comes
  void process(const btCollisionObjectWrapper* a, const btCollisionObjectWrapper* b, const btDispatcherInfo& info,
               btManifoldResult* result, ContactTable table = ContactTable::contacts) {
    if (algorithm_ == nullptr) {
      // Bullet's constructor leaves the manifold unset, and its compound algorithm hands the manifold on to its
      // children's pairs.
      btCollisionAlgorithmConstructionInfo own(&dispatcher_, 0);
      own.m_manifold = nullptr;
      algorithm_ = world_.bullets_algorithm(own, a, b, table);
    }
    algorithm_->processCollision(a, b, info, result);
  }
  /// Its points with it: ours answers.
  void release() {
    if (algorithm_ == nullptr) return;
    algorithm_->~btCollisionAlgorithm();
    dispatcher_.freeCollisionAlgorithm(algorithm_);
    algorithm_ = nullptr;
  }
  void append_to(btManifoldArray& manifolds) {
    if (algorithm_ != nullptr) algorithm_->getAllContactManifolds(manifolds);
  }

 private:
  const SolverInWorld& world_;
  btDispatcher& dispatcher_;
  btCollisionAlgorithm* algorithm_ = nullptr;
};

}  // namespace pd::detail

/// @file
/// The manifold of a pair that has one algorithm, and what is remembered of it.
#pragma once

#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/CollisionDispatch/btManifoldResult.h>

#include <memory>
#include <typeinfo>

#include "pair/manifold_points.hpp"
#include "pair/pair_registry.hpp"
#include "pair/solver_core.hpp"
#include "pair/step_reach.hpp"

namespace pd::detail {

/// Taken from the dispatcher at the first query, and given back with the pair; or one that Bullet shares between pairs,
/// which is added to, never cleared, and has no memory. A query between steps (contactTest, getClosestPoints) makes an
/// algorithm of its own, which lives for that query: memory begins with the second question, or with a step.
class OwnManifold {
 public:
  OwnManifold(SolverCore& core, btDispatcher& dispatcher, btPersistentManifold* shared)
      : core_(core), dispatcher_(dispatcher), manifold_(shared), shared_(shared != nullptr) {}
  ~OwnManifold() {
    if (shared_ || manifold_ == nullptr) return;
    if (memory_) core_.pairs.remove(manifold_);
    dispatcher_.releaseManifold(manifold_);
  }
  OwnManifold(const OwnManifold&) = delete;
  OwnManifold& operator=(const OwnManifold&) = delete;

  /// @return whether it was taken just now
  bool take(const btCollisionObjectWrapper& a, const btCollisionObjectWrapper& b, const btManifoldResult& result) {
    if (shared_) return false;
    const bool first = manifold_ == nullptr;
    if (first) manifold_ = dispatcher_.getNewManifold(a.getCollisionObject(), b.getCollisionObject());
    const bool in_step = typeid(result) == typeid(btManifoldResult);
    if (!memory_ && (in_step || !first)) {
      memory_ = std::make_unique<PairMemory>();
      core_.pairs.add(manifold_, memory_.get());
    }
    return first;
  }

  /// Requires `take`.
  [[nodiscard]] btPersistentManifold& get() const { return *manifold_; }
  /// Null: it is shared, or this is the only question of a query.
  [[nodiscard]] PairMemory* memory() const { return memory_.get(); }

  /// True if no point of the last step carried a load.
  [[nodiscard]] bool carries_nothing() const {
    for (int k = 0; k < manifold_->getNumContacts(); ++k) {
      if (manifold_->getContactPoint(k).m_appliedImpulse > 0) return false;
    }
    return true;
  }
  void clear() {
    if (!shared_) manifold_->clearManifold();
  }
  /// Puts this step's points in place of the last step's, or adds them to a shared one.
  void replace(FreshPoints fresh, const StepTime& seconds, btManifoldResult& result) {
    const btCollisionObject& a = *manifold_->getBody0();
    const btCollisionObject& b = *manifold_->getBody1();
    if (fresh.count > 0 && (is_link(a) || is_link(b))) {
      const btScalar threshold = manifold_->getContactBreakingThreshold();
      StepReach(a, b, result, threshold, seconds).leave_out_idle_of_links(fresh);
    }
    if (!memory_) {
      add_points(*manifold_, fresh, seconds, result);
      return;
    }
    replace_points({*manifold_, *memory_, fresh, seconds, result});
  }
  /// After Bullet's detector has added points of its own.
  void refresh(btManifoldResult& result) {
    if (!shared_) result.refreshContactPoints();
  }
  void append_to(btManifoldArray& manifolds) const {
    if (!shared_ && manifold_ != nullptr) manifolds.push_back(manifold_);
  }

 private:
  SolverCore& core_;
  btDispatcher& dispatcher_;
  btPersistentManifold* manifold_;
  bool shared_;
  std::unique_ptr<PairMemory> memory_;
};

}  // namespace pd::detail

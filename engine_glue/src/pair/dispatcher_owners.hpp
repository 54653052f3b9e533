/// @file
/// Who stands behind a dispatcher's near callback: Bullet hands the callback its dispatcher and nothing else.
#pragma once

#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>

#include <map>
#include <mutex>
#include <shared_mutex>

namespace pd::detail {

/// One owner of a kind for each dispatcher. Worlds may step on several threads.
template <class Owner>
class DispatcherOwners {
 public:
  static DispatcherOwners& instance() {
    static DispatcherOwners owners;
    return owners;
  }
  /// @return false if the dispatcher has an owner already
  bool add(const btCollisionDispatcher* dispatcher, Owner* owner) {
    const std::unique_lock lock(mutex_);
    return owners_.emplace(dispatcher, owner).second;
  }
  void remove(const btCollisionDispatcher* dispatcher) {
    const std::unique_lock lock(mutex_);
    owners_.erase(dispatcher);
  }
  [[nodiscard]] Owner* find(const btCollisionDispatcher& dispatcher) {
    const std::shared_lock lock(mutex_);
    const auto found = owners_.find(&dispatcher);
    return found == owners_.end() ? nullptr : found->second;
  }

 private:
  std::shared_mutex mutex_;
  std::map<const btCollisionDispatcher*, Owner*> owners_;
};

}  // namespace pd::detail

/// @file
/// A solver in one dispatcher, as the algorithms of its pairs know it.
#pragma once

#include <BulletCollision/CollisionDispatch/btCollisionCreateFunc.h>
#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>

#include <atomic>
#include <cstdint>

#include "pair/solver_core.hpp"

namespace pd::detail {

/// Which of a dispatcher's two tables of algorithms a pair comes from.
enum class ContactTable : std::uint8_t { contacts, closest_points };

/// Never moves and, once a dispatcher knows it, never dies: see SolverCore.
class SolverInWorld {
 public:
  /// @param dispatcher  nullptr: create functions that a host registers itself
  SolverInWorld(SolverCore& core, btCollisionDispatcher* dispatcher) : core_(core), dispatcher_(dispatcher) {}
  virtual ~SolverInWorld() = default;
  SolverInWorld(const SolverInWorld&) = delete;
  SolverInWorld& operator=(const SolverInWorld&) = delete;

  [[nodiscard]] SolverCore& core() const { return core_; }
  [[nodiscard]] btCollisionDispatcher* dispatcher() const { return dispatcher_; }
  /// Of the present step; 0 until the world has made its first step.
  [[nodiscard]] std::uint64_t stamp() const { return stamp_.load(std::memory_order_relaxed); }

  /// Whether the host leaves the pair to us (`BulletSolverSettings::takes_pair`).
  [[nodiscard]] bool takes(const btCollisionObjectWrapper& a, const btCollisionObjectWrapper& b) const;
  /// The algorithm of the dispatcher's own configuration, for pairs that are left to it. Requires a dispatcher.
  [[nodiscard]] btCollisionAlgorithm* bullets_algorithm(btCollisionAlgorithmConstructionInfo& info,
                                                        const btCollisionObjectWrapper* a,
                                                        const btCollisionObjectWrapper* b,
                                                        ContactTable table = ContactTable::contacts) const;

 protected:
  void begin_step() { stamp_.store(core_.next_stamp(), std::memory_order_relaxed); }

 private:
  SolverCore& core_;
  btCollisionDispatcher* dispatcher_;
  std::atomic<std::uint64_t> stamp_{0};
};

}  // namespace pd::detail

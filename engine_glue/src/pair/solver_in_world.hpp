/// @file
/// A solver in dispatchers, as the algorithms of their pairs know it.
#pragma once

#include <BulletCollision/CollisionDispatch/btCollisionCreateFunc.h>
#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>

#include <atomic>
#include <cstdint>

#include "pair/solver_core.hpp"

namespace pd::detail {

/// Which of a dispatcher's two tables of algorithms a pair comes from.
enum class ContactTable : std::uint8_t { contacts, closest_points };

/// Never moves and, once a dispatcher knows it, never dies: see SolverCore. Bullet tells nobody when a dispatcher dies,
/// so nothing is kept here of those that are served.
class SolverInWorld {
 public:
  explicit SolverInWorld(SolverCore& core) : core_(core) {}
  virtual ~SolverInWorld() = default;
  SolverInWorld(const SolverInWorld&) = delete;
  SolverInWorld& operator=(const SolverInWorld&) = delete;

  [[nodiscard]] SolverCore& core() const { return core_; }
  /// Of the present step; 0 until a world has made its first step. Where worlds share this, a step of one of them ends
  /// the stamp of all: shapes are compared more often than needed then, and never less.
  [[nodiscard]] std::uint64_t stamp() const { return stamp_.load(std::memory_order_relaxed); }

  /// True if the host leaves the pair to us (`BulletSolverSettings::takes_pair`).
  [[nodiscard]] bool takes(const btCollisionObjectWrapper& a, const btCollisionObjectWrapper& b) const;
  /// The algorithm of the dispatcher's own configuration, for pairs that are left to it. Requires a
  /// btCollisionDispatcher.
  [[nodiscard]] btCollisionAlgorithm* bullets_algorithm(btCollisionAlgorithmConstructionInfo& info,
                                                        const btCollisionObjectWrapper* a,
                                                        const btCollisionObjectWrapper* b,
                                                        ContactTable table = ContactTable::contacts) const;

 protected:
  void begin_step() { stamp_.store(core_.next_stamp(), std::memory_order_relaxed); }

 private:
  SolverCore& core_;
  std::atomic<std::uint64_t> stamp_{0};
};

}  // namespace pd::detail

/// @file
/// A solver in dispatchers, as the algorithms of their pairs know it.
#pragma once

#include <BulletCollision/CollisionDispatch/btCollisionCreateFunc.h>
#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>
#include <BulletCollision/CollisionDispatch/btCollisionWorld.h>

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
  /// The stamp under which an algorithm compares shapes: that of the present step, or 0 (nobody compared them) outside
  /// of steps, in a world that has not stepped, and for an algorithm at its `first` question, which may be a query of
  /// the host. Where worlds share this, a step of one of them ends the stamp of all: shapes are compared more often
  /// than needed then, and never less.
  [[nodiscard]] std::uint64_t stamp(const btDispatcherInfo& info, bool first) const {
    return first || info.m_stepCount != 0 ? 0 : stamp_.load(std::memory_order_relaxed);
  }
  /// Marks a world as between two steps. Hosts detect and query there as often as they like, and change shapes
  /// meanwhile. Bullet sets this number of its own to 0 when a step begins, and never reads it.
  static void mark_between_steps(btCollisionWorld& world) { world.getDispatchInfo().m_stepCount = 1; }

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

/// @file
/// The state of a Bullet world between two steps, saved and restored so that a replay gives the same bits.
///
/// Transforms and velocities are not enough (replays were up to 0.115 m off): a step also reads last step's contact
/// points with their impulses, push and turn velocities, interpolation state and forces. It reads activation, the
/// constraint solver's random seed, and the multibodies' joints, too. The order of the manifolds matters too, since the
/// solver works them in that order.
#pragma once

#include <BulletDynamics/Dynamics/btDiscreteDynamicsWorld.h>

#include "pd/bullet/penetration_depth_solver.hpp"

namespace pd {

/// The outcome of `BulletSnapshot::restore`.
enum class Restored : unsigned char {
  yes,
  objects_differ,      ///< a collision object was added to the world or removed from it
  joints_differ,       ///< a joint was added to the world or removed from it
  multibodies_differ,  ///< a multibody, one of its links or one of its constraints was added or removed
};
/// In one line, for a log: what differs, and what to do.
const char* message_of(Restored restored);

/// Holds for the world that it was taken from, as long as no body or joint is added or removed. Pointers to bodies are
/// kept, not owned. May be restored any number of times, also after the solver is gone.
///
/// Bit for bit means: the same calls of `stepSimulation(h, 0)` after `restore` give the same transforms, velocities and
/// contact points. The broadphase's trees and pairs belong to it (of btDbvtBroadphase; other broadphases are updated to
/// the restored poses, so that pairs found later may come in another order). Bullet's trees follow the addresses of
/// their nodes: where a body fell asleep or woke in between, a later pair may come in another order too. A compound's
/// children have a manifold each, made and dropped in an order that Bullet keeps nowhere. Worlds with compounds come
/// back with all their contact points. But where such a manifold is made or dropped in the replayed steps, the last
/// bits may differ.
///
/// Not saved: the remainder of time that `stepSimulation(h, n > 0)` carries, the inner impulses of joints beyond their
/// total, soft bodies, motion states (they follow at the next step). `m_userPersistentData` of contact points is
/// restored as a pointer.
class BulletSnapshot {
 public:
  /// @param solver  the one installed in the world: its pairs' warm starts are saved with their manifolds; nullptr
  ///                where none is installed.
  BulletSnapshot(btDiscreteDynamicsWorld& world, BulletPenetrationDepthSolver* solver);
  ~BulletSnapshot();
  BulletSnapshot(BulletSnapshot&&) noexcept;
  BulletSnapshot& operator=(BulletSnapshot&&) noexcept;

  /// Saves the world's present state in place of the one held, in the same memory. Requires: the solver lives.
  void save_again();

  /// Brings the world back, or changes nothing where the world has other bodies or joints than the one saved.
  /// Time: that of a broadphase update, plus one collision detection where pairs have to be made again.
  [[nodiscard]] Restored restore() const;

 private:
  struct State;
  State* state_;  ///< owned; nullptr where moved from
};

}  // namespace pd

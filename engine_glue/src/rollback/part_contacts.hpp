/// @file
/// What a part of a step makes of the contact points that Bullet's narrow phase finds for it (`substep.hpp` says why).
#pragma once

#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>

#include <mutex>
#include <vector>

#include "rollback/impact_energy.hpp"

namespace pd::detail {

/// While it lives, the dispatcher's narrow phase
///   - drops contact points at a distance above `farthest` of pairs that bounce, where they approach faster than
///     `gentle`, and of pairs that have no nearer point and approach faster than `slow`;
///   - gives the others the restitution that their impact may have;
///   - has the pair that sank in the part before put back, by split impulses, to where bodies touch, by at most the
///   slop.
class PartContacts {
 public:
  struct Rule {
    btScalar farthest;
    btScalar slow;
    btScalar gentle;
    const btCollisionObject* sunk_a;  ///< null: none
    const btCollisionObject* sunk_b;
    btScalar touching;  ///< distance at which bodies touch
    btScalar slop;
  };

  PartContacts(btDispatcher* dispatcher, const Rule& rule, ImpactEnergy& energy);
  ~PartContacts();
  PartContacts(const PartContacts&) = delete;
  PartContacts& operator=(const PartContacts&) = delete;

 private:
  /// Of a point whose share of depth that a step mends was changed.
  struct KeptErp {
    btManifoldPoint* point;
    btScalar value;
  };

  static void near(btBroadphasePair& pair, btCollisionDispatcher& dispatcher, const btDispatcherInfo& info);

  void drop_of_bouncing(btPersistentManifold& manifold) const;
  void drop_of_fast(btPersistentManifold& manifold) const;
  void put_back(btPersistentManifold& manifold);

  btCollisionDispatcher* dispatcher_;
  Rule rule_;
  ImpactEnergy& energy_;
  btNearCallback host_ = nullptr;
  std::mutex keeping_;
  std::vector<KeptErp> kept_;
};

}  // namespace pd::detail

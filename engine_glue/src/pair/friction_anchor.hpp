/// @file
/// Friction with a memory: where two bodies stuck to each other when a contact point began to hold.
///
/// Bullet's solver forgets friction impulses every step and resists velocities only, so that what its iterations leave
/// over adds up to creep. A contact point therefore keeps the two material points that lay on each other when it began
/// to hold, its anchor, and Bullet's own positional term for points with `BT_CONTACT_FLAG_FRICTION_ANCHOR` draws them
/// together again, within the friction cone. The anchor stands in the point's own `m_localPointA` and `m_localPointB`,
/// where snapshots, sleeping bodies and `refreshContactPoints` find it; no other memory is needed.
///
/// Depth, normal and distance of a point are always those of this step's exact answer. An anchor moves along the normal
/// only, onto today's surfaces, so that rounding never lets it drift along them.
#pragma once

#include <BulletCollision/CollisionDispatch/btManifoldResult.h>
#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>

#include "pair/manifold_points.hpp"

namespace pd::detail {

/// A point that left its anchor by more than this share of the breaking threshold rolled or moved on: Bullet drops
/// points at the whole of it.
inline constexpr btScalar kReachShare = btScalar(0.5);
/// Two anchors further apart than this share of the breaking threshold slid, slowly enough for the cone not to tell.
inline constexpr btScalar kSlipShare = btScalar(0.1);

/// What one manifold entry knew before this step's points came.
struct FrictionAnchor {
  btVector3 local_a = btVector3(0, 0, 0);
  btVector3 local_b = btVector3(0, 0, 0);
  btScalar lateral_impulse_1 = 0;
  btScalar lateral_impulse_2 = 0;
  bool slid = true;  ///< friction gave way last step: the anchor counts no more
};

/// The entry of the manifold that Bullet gives to a new point at `local_a`, by the same rule
/// (`btPersistentManifold::getCacheEntry`): the nearest one within the breaking threshold, -1 without one.
[[nodiscard]] int entry_near(const btPersistentManifold& manifold, const btVector3& local_a);

/// Whether friction gave way at a point in the last step.
[[nodiscard]] bool anchor_slid(const btManifoldPoint& point);

/// Reads the anchor of an entry.
[[nodiscard]] FrictionAnchor anchor_of(const btManifoldPoint& point);

/// Adds one point by `result` (which calls the host's callbacks and combines the materials), and hands the entry's
/// anchor on where friction held it.
///
/// @param entry   where the point will go (`entry_near`); -1 for a new entry
/// @param anchor  of that entry, before this step's points came; not read for a new entry
/// @return the entry that holds the point now; -1 where `result` keeps its points elsewhere (contact tests)
int add_anchored_point(btManifoldResult& result, btPersistentManifold& manifold, const FreshPoint& point, int entry,
                       const FrictionAnchor& anchor);

/// Whether points of a manifold may be made without Bullet: its own result, no callback that is told of each point and
/// may change it, and no body that asks for anchors itself.
[[nodiscard]] bool points_are_alike(const btManifoldResult& result);

/// What Bullet would give a new point that takes over the place of `old`, apart from places: materials, flags and
/// friction directions. Requires points_are_alike.
[[nodiscard]] btManifoldPoint pattern_of(const btManifoldResult& result, const btManifoldPoint& old,
                                         const btVector3& normal);

}  // namespace pd::detail

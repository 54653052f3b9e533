#include "friction_anchor.hpp"

namespace pd::detail {

namespace {

/// The share of the friction cone beyond which friction counts as given way: at the limit itself the solver stores
/// mu * N up to the rounding of its iterations. (.5 to 1 made no difference in any scene.)
constexpr btScalar kHoldingShare = btScalar(0.998);
/// A point that left its anchor by more than this share of the breaking threshold rolled or moved on: Bullet drops
/// points at the whole of it.
constexpr btScalar kReachShare = btScalar(0.5);
/// Two anchors further apart than this share of the breaking threshold slid, slowly enough for the cone not to tell.
constexpr btScalar kSlipShare = btScalar(0.1);

btVector3 tangential(const btVector3& v, const btVector3& normal) { return v - normal * v.dot(normal); }

/// Moves the point's local points back to the anchor, and its world point on A by the slip.
void hold(btManifoldPoint& point, const FrictionAnchor& anchor, const btPersistentManifold& manifold) {
  const btTransform& pose_a = manifold.getBody0()->getWorldTransform();
  const btTransform& pose_b = manifold.getBody1()->getWorldTransform();
  const btVector3& normal = point.m_normalWorldOnB;
  // From today's points to the anchor's material points where they are today.
  const btVector3 way_a = pose_a(anchor.local_a) - point.m_positionWorldOnA;
  const btVector3 way_b = pose_b(anchor.local_b) - point.m_positionWorldOnB;
  const btVector3 along_a = tangential(way_a, normal);
  const btVector3 along_b = tangential(way_b, normal);
  const btVector3 slip = along_a - along_b;
  const btScalar threshold = manifold.getContactBreakingThreshold();
  const btScalar reach = kReachShare * threshold;
  const btScalar allowed = kSlipShare * threshold;
  if (along_a.length2() > reach * reach || along_b.length2() > reach * reach || slip.length2() > allowed * allowed) {
    return;
  }
  point.m_localPointA = anchor.local_a - (normal * way_a.dot(normal)) * pose_a.getBasis();
  point.m_localPointB = anchor.local_b - (normal * way_b.dot(normal)) * pose_b.getBasis();
  point.m_positionWorldOnA += slip;
  point.m_contactPointFlags |= BT_CONTACT_FLAG_FRICTION_ANCHOR;
}

}  // namespace

int entry_near(const btPersistentManifold& manifold, const btVector3& local_a) {
  btScalar least = manifold.getContactBreakingThreshold() * manifold.getContactBreakingThreshold();
  int nearest = -1;
  for (int i = 0; i < manifold.getNumContacts(); ++i) {
    const btScalar gap = (manifold.getContactPoint(i).m_localPointA - local_a).length2();
    if (gap < least) {
      least = gap;
      nearest = i;
    }
  }
  return nearest;
}

FrictionAnchor anchor_of(const btManifoldPoint& point) {
  const btScalar lateral = point.m_appliedImpulseLateral1 * point.m_appliedImpulseLateral1 +
                           point.m_appliedImpulseLateral2 * point.m_appliedImpulseLateral2;
  const btScalar holding = kHoldingShare * point.m_combinedFriction * point.m_appliedImpulse;
  return {point.m_localPointA, point.m_localPointB, point.m_appliedImpulseLateral1, point.m_appliedImpulseLateral2,
          lateral > holding * holding};
}

int add_anchored_point(btManifoldResult& result, btPersistentManifold& manifold, const btVector3& normal,
                       const btVector3& point_on_b, btScalar distance, int entry, const FrictionAnchor& anchor) {
  if (entry >= 0 && distance <= manifold.getContactBreakingThreshold()) {
    // Bullet keeps the old point of a body that asks for anchors itself (CF_HAS_FRICTION_ANCHOR) unless it slid, with
    // last step's depth and normal. So the entry is made to look as if it had.
    btManifoldPoint& old = manifold.getContactPoint(entry);
    old.m_combinedFriction = 0;
    old.m_appliedImpulseLateral1 = 1;
  }
  const int before = manifold.getNumContacts();
  result.addContactPoint(normal, point_on_b, distance);
  if (manifold.getNumContacts() > before) {
    return before;
  }
  if (entry < 0) {
    return -1;  // a contact test, or the point took the place of another one in a full manifold
  }
  btManifoldPoint& point = manifold.getContactPoint(entry);
  point.m_appliedImpulseLateral1 = anchor.lateral_impulse_1;
  point.m_appliedImpulseLateral2 = anchor.lateral_impulse_2;
  // A host's moving surface (contact motion) has to slide.
  const bool driven = point.m_contactMotion1 != 0 || point.m_contactMotion2 != 0;
  if (!anchor.slid && !driven) {
    hold(point, anchor, manifold);
  }
  return entry;
}

}  // namespace pd::detail

#include "pair/friction_anchor.hpp"

#include <array>
#include <typeinfo>

namespace pd::detail {

namespace {

/// The share of the friction cone beyond which friction counts as given way: at the limit itself the solver stores
/// mu * N up to the rounding of its iterations. (.5 to 1 made no difference in any scene.)
constexpr btScalar kHoldingShare = btScalar(0.998);

/// Moves the point's local points back to the anchor, and its world point on A by the slip.
void hold(btManifoldPoint& point, const FrictionAnchor& anchor, const btPersistentManifold& manifold) {
  const btTransform& pose_a = manifold.getBody0()->getWorldTransform();
  const btTransform& pose_b = manifold.getBody1()->getWorldTransform();
  const btScalar threshold = manifold.getContactBreakingThreshold();
  const btVector3& normal = point.m_normalWorldOnB;
  // From today's points to the anchor's material points where they are today.
  const btVector3 way_a = pose_a(anchor.local_a) - point.m_positionWorldOnA;
  const btVector3 way_b = pose_b(anchor.local_b) - point.m_positionWorldOnB;
  const btVector3 lift_a = normal * way_a.dot(normal), lift_b = normal * way_b.dot(normal);
  const btVector3 along_a = way_a - lift_a, along_b = way_b - lift_b;
  const btVector3 slip = along_a - along_b;
  const btScalar reach = kReachShare * threshold, allowed = kSlipShare * threshold;
  if (along_a.length2() > reach * reach || along_b.length2() > reach * reach || slip.length2() > allowed * allowed) {
    return;
  }
  point.m_localPointA = anchor.local_a - lift_a * pose_a.getBasis();
  point.m_localPointB = anchor.local_b - lift_b * pose_b.getBasis();
  point.m_positionWorldOnA += slip;
  point.m_contactPointFlags |= BT_CONTACT_FLAG_FRICTION_ANCHOR;
}

/// Hides a manifold's entries but one from Bullet's search for the entry that a new point replaces: it takes the
/// nearest within the breaking threshold, so that of two new points nearer to each other than that the second would
/// replace the first, however deep that one is.
class OthersOutOfReach {
 public:
  OthersOutOfReach(btPersistentManifold& manifold, int entry)
      : manifold_(manifold), entry_(entry), count_(manifold.getNumContacts()) {
    for (int i = 0; i < count_; ++i) {
      if (i == entry_) continue;
      places_[i] = manifold_.getContactPoint(i).m_localPointA;
      manifold_.getContactPoint(i).m_localPointA.setValue(kFar, kFar, kFar);
    }
  }
  ~OthersOutOfReach() {
    for (int i = 0; i < count_; ++i) {
      if (i != entry_) manifold_.getContactPoint(i).m_localPointA = places_[i];
    }
  }
  OthersOutOfReach(const OthersOutOfReach&) = delete;
  OthersOutOfReach& operator=(const OthersOutOfReach&) = delete;

 private:
  static constexpr btScalar kFar = btScalar(1e18);  ///< its square is a number of single precision

  btPersistentManifold& manifold_;
  int entry_;
  int count_;
  std::array<btVector3, MANIFOLD_CACHE_SIZE> places_;
};

/// What the entry knew goes to the point that it holds now.
void hand_on(btManifoldPoint& point, const FrictionAnchor& anchor, const btPersistentManifold& manifold) {
  point.m_appliedImpulseLateral1 = anchor.lateral_impulse_1;
  point.m_appliedImpulseLateral2 = anchor.lateral_impulse_2;
  // A host's moving surface (contact motion) has to slide.
  const bool driven = point.m_contactMotion1 != 0 || point.m_contactMotion2 != 0;
  if (!anchor.slid && !driven) {
    hold(point, anchor, manifold);
  }
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

bool anchor_slid(const btManifoldPoint& point) {
  const btScalar lateral = point.m_appliedImpulseLateral1 * point.m_appliedImpulseLateral1 +
                           point.m_appliedImpulseLateral2 * point.m_appliedImpulseLateral2;
  const btScalar holding = kHoldingShare * point.m_combinedFriction * point.m_appliedImpulse;
  return lateral > holding * holding;
}

FrictionAnchor anchor_of(const btManifoldPoint& point) {
  return {point.m_localPointA, point.m_localPointB, point.m_appliedImpulseLateral1, point.m_appliedImpulseLateral2,
          anchor_slid(point)};
}

int add_anchored_point(btManifoldResult& result, btPersistentManifold& manifold, const FreshPoint& point, int entry,
                       const FrictionAnchor& anchor) {
  if (entry >= 0 && point.distance <= manifold.getContactBreakingThreshold()) {
    // Bullet keeps the old point of a body that asks for anchors itself (CF_HAS_FRICTION_ANCHOR) unless it slid, with
    // last step's depth and normal. So the entry is made to look as if it had.
    btManifoldPoint& old = manifold.getContactPoint(entry);
    old.m_combinedFriction = 0;
    old.m_appliedImpulseLateral1 = 1;
  }
  const int before = manifold.getNumContacts();
  {
    const OthersOutOfReach hidden(manifold, entry);
    result.addContactPoint(point.normal, point.point_on_b, point.distance);
  }
  if (manifold.getNumContacts() > before) {
    return before;
  }
  if (entry < 0) {
    return -1;  // a contact test, or the point took the place of another one in a full manifold
  }
  hand_on(manifold.getContactPoint(entry), anchor, manifold);
  return entry;
}

bool points_are_alike(const btManifoldResult& result) {
  const int flags = result.getBody0Internal()->getCollisionFlags() | result.getBody1Internal()->getCollisionFlags();
  const bool told = gContactAddedCallback != nullptr && (flags & btCollisionObject::CF_CUSTOM_MATERIAL_CALLBACK) != 0;
  return !told && (flags & btCollisionObject::CF_HAS_FRICTION_ANCHOR) == 0 &&
         typeid(result) == typeid(btManifoldResult);
}

btManifoldPoint pattern_of(const btManifoldResult& result, const btManifoldPoint& old, const btVector3& normal) {
  const btCollisionObject* const a = result.getBody0Internal();
  const btCollisionObject* const b = result.getBody1Internal();
  btManifoldPoint pattern(old.m_localPointA, old.m_localPointB, normal, 0);
  pattern.m_combinedFriction = gCalculateCombinedFrictionCallback(a, b);
  pattern.m_combinedRestitution = gCalculateCombinedRestitutionCallback(a, b);
  pattern.m_combinedRollingFriction = gCalculateCombinedRollingFrictionCallback(a, b);
  pattern.m_combinedSpinningFriction = gCalculateCombinedSpinningFrictionCallback(a, b);
  const int flags = a->getCollisionFlags() | b->getCollisionFlags();
  if ((flags & btCollisionObject::CF_HAS_CONTACT_STIFFNESS_DAMPING) != 0) {
    pattern.m_combinedContactDamping1 = gCalculateCombinedContactDampingCallback(a, b);
    pattern.m_combinedContactStiffness1 = gCalculateCombinedContactStiffnessCallback(a, b);
    pattern.m_contactPointFlags |= BT_CONTACT_FLAG_CONTACT_STIFFNESS_DAMPING;
  }
  btPlaneSpace1(normal, pattern.m_lateralFrictionDir1, pattern.m_lateralFrictionDir2);
  pattern.m_partId0 = old.m_partId0;
  pattern.m_partId1 = old.m_partId1;
  pattern.m_index0 = old.m_index0;
  pattern.m_index1 = old.m_index1;
  return pattern;
}

}  // namespace pd::detail

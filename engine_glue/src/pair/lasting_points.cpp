#include "pair/lasting_points.hpp"

#include "pair/friction_anchor.hpp"
#include "shapes/lane_vectors.hpp"

namespace pd::detail {

namespace {

/// Of the breaking threshold: what lies between, `replace_points` decides by other sums.
constexpr btScalar kSamePlace = btScalar(0.9);

/// Four points of the manifold, the first again where there are fewer, so that its lane says the same.
struct Entries {
  std::array<btManifoldPoint*, 4> at;

  [[nodiscard]] FourVectors gather(btVector3 btManifoldPoint::*member) const {
    return detail::gather({&(at[0]->*member), &(at[1]->*member), &(at[2]->*member), &(at[3]->*member)});
  }
  void scatter(const FourVectors& v, btVector3 btManifoldPoint::*member) const {
    Lanes out[4];
    spread(v, out);
    for (std::size_t k = 0; k < 4; ++k) __builtin_memcpy((at[k]->*member).m_floats, &out[k], sizeof(Lanes));
  }
};

void friction_held(const Entries& entries, LaneFlags& out) {
  const auto held = [&](std::size_t k) { return anchor_slid(*entries.at[k]) ? LaneInteger{0} : LaneInteger{-1}; };
  out = LaneFlags{held(0), held(1), held(2), held(3)};
}

/// Apart from places, distance and flags, and from what a point takes over from the last step: impulses, life time and
/// the host's data.
void copy_kind(const btManifoldPoint& from, btManifoldPoint& to) {
  to.m_normalWorldOnB = from.m_normalWorldOnB;
  to.m_combinedFriction = from.m_combinedFriction;
  to.m_combinedRollingFriction = from.m_combinedRollingFriction;
  to.m_combinedSpinningFriction = from.m_combinedSpinningFriction;
  to.m_combinedRestitution = from.m_combinedRestitution;
  to.m_partId0 = from.m_partId0;
  to.m_partId1 = from.m_partId1;
  to.m_index0 = from.m_index0;
  to.m_index1 = from.m_index1;
  to.m_contactMotion1 = from.m_contactMotion1;
  to.m_contactMotion2 = from.m_contactMotion2;
  to.m_contactCFM = from.m_contactCFM;
  to.m_contactERP = from.m_contactERP;
  to.m_frictionCFM = from.m_frictionCFM;
  to.m_lateralFrictionDir1 = from.m_lateralFrictionDir1;
  to.m_lateralFrictionDir2 = from.m_lateralFrictionDir2;
}

/// As `btManifoldResult::addContactPoint` does.
void set_numbers(const PieceNumbers& numbers, const btPersistentManifold& manifold, const btManifoldResult& result,
                 btManifoldPoint& out) {
  const bool swapped = manifold.getBody0() != result.getBody0Internal();
  out.m_partId0 = swapped ? numbers.part_1 : numbers.part_0;
  out.m_partId1 = swapped ? numbers.part_0 : numbers.part_1;
  out.m_index0 = swapped ? numbers.index_1 : numbers.index_0;
  out.m_index1 = swapped ? numbers.index_0 : numbers.index_1;
}

void turn_to(const btVector3& normal, btManifoldPoint& out) {
  out.m_normalWorldOnB = normal;
  btPlaneSpace1(normal, out.m_lateralFrictionDir1, out.m_lateralFrictionDir2);
}

}  // namespace

bool may_all_last(const btPersistentManifold& manifold, const PairMemory& memory, const FreshPoints& fresh,
                  const btManifoldResult& result) {
  const int count = fresh.count;
  if (count == 0 || count != memory.num_points || count != manifold.getNumContacts()) return false;
  const btScalar threshold = manifold.getContactBreakingThreshold();
  Lanes known, is;
  LaneFlags same = ~LaneFlags{};
  bool near = true;
  for (int i = 0; i < count; ++i) {
    load_lanes(memory.points[i].local_a, known);
    load_lanes(manifold.getContactPoint(i).m_localPointA, is);
    same &= known == is;
    near &= fresh.points[i].distance <= threshold;
  }
  if (!near || !all(same)) return false;
  return points_are_alike(result);
}

bool order_by_feature(const PairMemory& memory, const FreshPoints& fresh, LastingPoints& all) {
  all.count = 0;
  unsigned taken = 0;
  // A cut face begins at another corner now and then, so that what follows mostly follows again.
  int k = 0;
  for (int i = 0; i < fresh.count; ++i) {
    int tried = 0;
    while (fresh.points[k].feature_id != memory.points[i].feature_id) {
      if (++tried == fresh.count) return false;
      k = k + 1 < fresh.count ? k + 1 : 0;
    }
    taken |= 1U << k;
    all.add(i, k);
    k = k + 1 < fresh.count ? k + 1 : 0;
  }
  return taken + 1 == 1U << fresh.count;  // none twice
}

bool replace_lasting_points(const PointsOfStep& step, const LastingPoints& lasting, PlacesKnown known) {
  btPersistentManifold& manifold = step.manifold;
  PairMemory& memory = step.memory;
  const btManifoldResult& result = step.result;
  const int count = lasting.count;
  const auto new_point = [&](int i) -> const FreshPoint& {
    return step.fresh.points[lasting.points[i < count ? i : 0]];
  };
  const auto old_point = [&](int i) { return &manifold.getContactPoint(lasting.entries[i < count ? i : 0]); };
  const Entries entries{{old_point(0), old_point(1), old_point(2), old_point(3)}};
  const btTransform& pose_a = manifold.getBody0()->getWorldTransform();
  const btTransform& pose_b = manifold.getBody1()->getWorldTransform();
  const btScalar threshold = manifold.getContactBreakingThreshold();
  const FreshPoint* const points[4] = {&new_point(0), &new_point(1), &new_point(2), &new_point(3)};
  const FourVectors world_b =
      gather({&points[0]->point_on_b, &points[1]->point_on_b, &points[2]->point_on_b, &points[3]->point_on_b});
  const FourVectors normal = gather({&points[0]->normal, &points[1]->normal, &points[2]->normal, &points[3]->normal});
  const FourVectors world_a = world_b + scaled(normal, Lanes{points[0]->distance, points[1]->distance,
                                                             points[2]->distance, points[3]->distance});
  // The end loads what is stored here. By then no store of it is still on its way.
  const btManifoldPoint pattern = pattern_of(result, *entries.at[0], points[0]->normal);
  const FourVectors old_a = entries.gather(&btManifoldPoint::m_localPointA);
  const FourVectors old_b = entries.gather(&btManifoldPoint::m_localPointB);

  // From today's points to the anchor's material points where they are today.
  const FourVectors way_a = apply(pose_a, old_a) - world_a;
  if (known == PlacesKnown::no) {
    Lanes moved;
    dot(way_a, way_a, moved);
    if (!all(moved < kSamePlace * threshold * threshold)) return false;
  }
  const FourVectors way_b = apply(pose_b, old_b) - world_b;
  Lanes height_a, height_b, length_a, length_b, length_slip;
  dot(way_a, normal, height_a);
  dot(way_b, normal, height_b);
  const FourVectors lift_a = scaled(normal, height_a), lift_b = scaled(normal, height_b);
  const FourVectors along_a = way_a - lift_a, along_b = way_b - lift_b;
  const FourVectors slip = along_a - along_b;
  dot(along_a, along_a, length_a);
  dot(along_b, along_b, length_b);
  dot(slip, slip, length_slip);
  const btScalar reach = kReachShare * threshold, allowed = kSlipShare * threshold;
  LaneFlags held;
  friction_held(entries, held);
  held &= ~((length_a > reach * reach) | (length_b > reach * reach) | (length_slip > allowed * allowed));
  FourVectors local_a = old_a - turn_back(pose_a, lift_a);
  FourVectors local_b = old_b - turn_back(pose_b, lift_b);
  FourVectors shown_a = world_a + slip;
  if (!all(held)) {
    local_a = select(held, local_a, apply_inverse(pose_a, world_a));
    local_b = select(held, local_b, apply_inverse(pose_b, world_b));
    shown_a = select(held, shown_a, world_a);
  }

  const bool same_step = step.seconds == memory.seconds;
  PieceNumbers numbers;
  bool told = false;
  for (int k = 0; k < count; ++k) {
    btManifoldPoint& point = *entries.at[static_cast<std::size_t>(k)];
    RememberedPoint& remembered = memory.points[lasting.entries[k]];
    copy_kind(pattern, point);
    if (step.pieces != nullptr) {
      told |= step.pieces->numbers(points[k]->piece, numbers);
      if (told) set_numbers(numbers, manifold, result, point);
      if (!(points[k]->normal == pattern.m_normalWorldOnB)) turn_to(points[k]->normal, point);
    }
    point.m_distance1 = points[k]->distance;
    point.m_positionWorldOnB = points[k]->point_on_b;
    point.m_contactPointFlags = pattern.m_contactPointFlags | (held[k] != 0 ? BT_CONTACT_FLAG_FRICTION_ANCHOR : 0);
    remembered.feature_id = points[k]->feature_id;
    point.m_appliedImpulse = remembered.impulse.next(point.m_appliedImpulse, same_step);
    ++point.m_lifeTime;
  }
  entries.scatter(local_a, &btManifoldPoint::m_localPointA);
  entries.scatter(local_b, &btManifoldPoint::m_localPointB);
  entries.scatter(shown_a, &btManifoldPoint::m_positionWorldOnA);
  for (int k = 0; k < count; ++k) {
    memory.points[lasting.entries[k]].local_a = entries.at[static_cast<std::size_t>(k)]->m_localPointA;
  }
  memory.seconds = step.seconds;
  return true;
}

}  // namespace pd::detail

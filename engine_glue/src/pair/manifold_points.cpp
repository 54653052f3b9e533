#include "pair/manifold_points.hpp"

#include <algorithm>
#include <limits>

#include "pair/friction_anchor.hpp"
#include "pair/lasting_points.hpp"
#include "pd/bullet/scalar.hpp"

namespace pd::detail {

namespace {

/// New point for each old one, and the old one's number in memory: -1 where none.
struct Matching {
  std::array<int, 4> heir{-1, -1, -1, -1};
  std::array<int, 4> known{-1, -1, -1, -1};
};

/// The number of a manifold's point in memory, recognised by its exact place; -1 where somebody else moved it.
/// @param i  of the point: the likeliest one
int remembered(const PairMemory& memory, const btManifoldPoint& point, int i) {
  if (i < memory.num_points && memory.points[i].local_a == point.m_localPointA) return i;
  for (int r = 0; r < memory.num_points; ++r) {
    if (memory.points[r].local_a == point.m_localPointA) return r;
  }
  return -1;
}

/// Pairs last step's manifold points with this step's: by feature where the place is the same within the breaking
/// threshold, else by place, nearest first, and then by feature wherever it has gone (what slides fast keeps its
/// impulse). Place comes before a feature that is elsewhere: where the edges of two faces nearly coincide, a crossing
/// of theirs goes from one end to the other by rounding.
Matching match_points(const btPersistentManifold& manifold, const PairMemory& memory, const FreshPoints& fresh,
                      const std::array<btVector3, 4>& fresh_local_a) {
  Matching matching;
  std::array<bool, 4> taken{};
  const int count = manifold.getNumContacts();
  int left = std::min(count, fresh.count);
  const btScalar threshold = manifold.getContactBreakingThreshold();
  const btScalar reach = threshold * threshold;
  const auto gap = [&](int i, int k) {
    return (manifold.getContactPoint(i).m_localPointA - fresh_local_a[k]).length2();
  };
  const auto match = [&](int i, int k) {
    matching.heir[i] = k;
    taken[k] = true;
    --left;
  };
  const auto by_feature = [&](btScalar within) {
    for (int i = 0; i < count; ++i) {
      const int r = matching.known[i];
      if (matching.heir[i] >= 0 || r < 0) continue;
      for (int k = 0; k < fresh.count; ++k) {
        if (!taken[k] && fresh.points[k].feature_id == memory.points[r].feature_id && gap(i, k) < within) {
          match(i, k);
          break;
        }
      }
    }
  };
  for (int i = 0; i < count; ++i) matching.known[i] = remembered(memory, manifold.getContactPoint(i), i);
  by_feature(reach);
  while (left > 0) {
    int best_old = -1;
    int best_new = -1;
    btScalar best = reach;
    for (int i = 0; i < count; ++i) {
      for (int k = 0; k < fresh.count; ++k) {
        if (matching.heir[i] < 0 && !taken[k] && gap(i, k) < best) {
          best = gap(i, k);
          best_old = i;
          best_new = k;
        }
      }
    }
    if (best_old < 0) break;
    match(best_old, best_new);
  }
  if (left > 0) by_feature(std::numeric_limits<btScalar>::infinity());
  return matching;
}

/// Takes out what `refreshContactPoints` will take out at the end of the step: points that have parted or moved on, by
/// Bullet's rule. In a manifold shared by many triangles they would keep fresh points from their places until then.
void forget_parted(btPersistentManifold& manifold) {
  const btTransform& pose_a = manifold.getBody0()->getWorldTransform();
  const btTransform& pose_b = manifold.getBody1()->getWorldTransform();
  const btScalar threshold = manifold.getContactBreakingThreshold();
  for (int i = manifold.getNumContacts() - 1; i >= 0; --i) {
    const btManifoldPoint& point = manifold.getContactPoint(i);
    const btVector3 on_a = pose_a(point.m_localPointA);
    const btVector3 on_b = pose_b(point.m_localPointB);
    const btScalar distance = (on_a - on_b).dot(point.m_normalWorldOnB);
    const btVector3 drift = on_b - (on_a - point.m_normalWorldOnB * distance);
    if (!(distance <= threshold) || drift.length2() > threshold * threshold) manifold.removeContactPoint(i);
  }
}

btVector3 local_on_a(const ManifoldPoses& poses, const FreshPoint& point) {
  Lanes on_b, normal, local;
  load_lanes(point.point_on_b, on_b);
  load_lanes(point.normal, normal);
  poses.a.apply_inverse(on_b + normal * point.distance, local);
  return from_lanes(local);
}

ManifoldPoses poses_of(const btPersistentManifold& manifold) {
  return {LaneTransform(manifold.getBody0()->getWorldTransform()),
          LaneTransform(manifold.getBody1()->getWorldTransform())};
}

}  // namespace

namespace {

FreshPoint fresh_point(const btVector3& normal, const ContactPoint& point) {
  return {normal, to_bullet(point.position_b), static_cast<btScalar>(-point.depth), point.feature_id};
}

}  // namespace

FreshPoint fresh_point(const Vec3& normal, const ContactPoint& point) { return fresh_point(to_bullet(normal), point); }

FreshPoints fresh_points(const ContactManifold& manifold) {
  FreshPoints fresh;
  const btVector3 normal = to_bullet(manifold.normal);
  for (int k = 0; k < manifold.count; ++k) {
    const auto i = static_cast<std::size_t>(k);
    fresh.points[i] = fresh_point(normal, manifold.points[i]);
  }
  fresh.count = manifold.count;
  return fresh;
}

void add_points(btPersistentManifold& manifold, const FreshPoints& fresh, btManifoldResult& result) {
  forget_parted(manifold);
  const ManifoldPoses poses = poses_of(manifold);
  // Points nearer to each other than the breaking threshold replace each other here: the deepest comes last.
  std::array<int, 4> order{0, 1, 2, 3};
  std::stable_sort(order.begin(), order.begin() + fresh.count,
                   [&](int i, int k) { return fresh.points[i].distance > fresh.points[k].distance; });
  for (int i = 0; i < fresh.count; ++i) {
    const FreshPoint& point = fresh.points[order[i]];
    const int entry = entry_near(manifold, local_on_a(poses, point));
    const FrictionAnchor anchor = entry >= 0 ? anchor_of(manifold.getContactPoint(entry)) : FrictionAnchor();
    add_anchored_point(result, manifold, poses, point.normal, point.point_on_b, point.distance, entry, anchor);
  }
}

namespace {

/// What the new points take over from the old ones.
struct Heritage {
  std::array<FrictionAnchor, 4> anchors;       ///< of entries
  std::array<ImpulseTrend, 4> impulses;        ///< of new points
  std::array<int, 4> entries{-1, -1, -1, -1};  ///< of new points; -1: no old point goes on in it
};

/// Takes points without an heir out of the manifold, and moves the others to theirs: Bullet's `addContactPoint` hands
/// impulses, life time and user data to the new point that falls on an old one, which keeps Bullet's contact callbacks
/// right, as clearing would not.
void keep_matched(btPersistentManifold& manifold, const PairMemory& memory, Matching& matching, btScalar seconds,
                  const std::array<btVector3, 4>& local_a, Heritage& heritage) {
  for (int i = manifold.getNumContacts() - 1; i >= 0; --i) {
    const int heir = matching.heir[i];
    if (heir < 0) {
      // Moves the last point into the gap: those behind are dealt with already.
      const int last = manifold.getNumContacts() - 1;
      heritage.anchors[i] = heritage.anchors[last];
      matching.heir[i] = matching.heir[last];
      manifold.removeContactPoint(i);
    } else {
      btManifoldPoint& old = manifold.getContactPoint(i);
      heritage.anchors[i] = anchor_of(old);
      ImpulseTrend& impulse = heritage.impulses[heir];
      if (const int r = matching.known[i]; r >= 0) impulse = memory.points[r].impulse;
      old.m_appliedImpulse = impulse.next(old.m_appliedImpulse, seconds == memory.seconds);
      old.m_localPointA = local_a[heir];
    }
  }
  for (int i = 0; i < manifold.getNumContacts(); ++i) heritage.entries[matching.heir[i]] = i;
}

}  // namespace

namespace {

/// Whatever became of the old points.
/// @param may_last  `may_all_last`
/// @param pieces    for `replace_lasting_points`
void replace_any_points(btPersistentManifold& manifold, PairMemory& memory, const FreshPoints& fresh, bool may_last,
                        const PointSurroundings* pieces, btScalar seconds, btManifoldResult& result,
                        PointSurroundings& surroundings) {
  const ManifoldPoses poses = poses_of(manifold);
  std::array<btVector3, 4> local_a;
  for (int k = 0; k < fresh.count; ++k) local_a[k] = local_on_a(poses, fresh.points[k]);
  Matching matching = match_points(manifold, memory, fresh, local_a);
  const auto goes_on = [](int heir) { return heir >= 0; };
  if (may_last && std::all_of(matching.heir.begin(), matching.heir.begin() + fresh.count, goes_on)) {
    replace_lasting_points(manifold, memory, fresh, matching.heir, PlacesKnown::yes, seconds, result, pieces);
    return;
  }
  Heritage heritage;
  keep_matched(manifold, memory, matching, seconds, local_a, heritage);
  const btScalar threshold = manifold.getContactBreakingThreshold();
  const bool alike = points_are_alike(result);
  // What the points have in common: as Bullet gave it to one of them, or as it would.
  btManifoldPoint pattern;
  int pattern_of_point = -1;
  for (int k = 0; k < fresh.count; ++k) {
    const FreshPoint& point = fresh.points[k];
    int entry = heritage.entries[k];
    const bool lasts = alike && entry >= 0 && point.distance <= threshold;
    if (lasts && pattern_of_point < 0 && surroundings.lasting()) {
      pattern = pattern_of(result, manifold.getContactPoint(entry), point.normal);
      pattern_of_point = k;
    }
    if (lasts && pattern_of_point >= 0 && surroundings.same(k, pattern_of_point) &&
        point.normal == pattern.m_normalWorldOnB) {
      replace_like(pattern, poses, threshold, local_a[k], point.point_on_b, point.distance, heritage.anchors[entry],
                   manifold.getContactPoint(entry));
    } else {
      surroundings.enter(k);
      entry = add_anchored_point(result, manifold, poses, point.normal, point.point_on_b, point.distance, entry,
                                 heritage.anchors[std::max(entry, 0)]);
      surroundings.leave();
      if (alike && entry >= 0 && point.distance <= threshold) {
        pattern = manifold.getContactPoint(entry);
        pattern_of_point = k;
      }
    }
    if (entry >= 0) {
      memory.points[entry].feature_id = point.feature_id;
      memory.points[entry].impulse = heritage.impulses[k];
    }
  }
  memory.seconds = seconds;
  memory.num_points = manifold.getNumContacts();
  for (int i = 0; i < memory.num_points; ++i) {
    memory.points[i].local_a = manifold.getContactPoint(i).m_localPointA;
    ++manifold.getContactPoint(i).m_lifeTime;
  }
}

}  // namespace

void replace_points(btPersistentManifold& manifold, PairMemory& memory, const FreshPoints& fresh, btScalar seconds,
                    btManifoldResult& result, PointSurroundings& surroundings) {
  const bool one_piece = surroundings.lasting();
  const PointSurroundings* const pieces = one_piece ? nullptr : &surroundings;
  PieceNumbers numbers;
  const bool may_last = fresh.count > 0 && (one_piece || surroundings.numbers(0, numbers)) &&
                        may_all_last(manifold, memory, fresh, result);
  PointOrder order;
  if (!may_last || !order_by_feature(memory, fresh, order) ||
      !replace_lasting_points(manifold, memory, fresh, order, PlacesKnown::no, seconds, result, pieces)) {
    replace_any_points(manifold, memory, fresh, may_last, pieces, seconds, result, surroundings);
  }
  // Bullet calls it from `refreshContactPoints`, which its own algorithms end with.
  if (gContactProcessedCallback != nullptr) {
    for (int i = manifold.getNumContacts() - 1; i >= 0; --i) {
      gContactProcessedCallback(manifold.getContactPoint(i), const_cast<btCollisionObject*>(manifold.getBody0()),
                                const_cast<btCollisionObject*>(manifold.getBody1()));
    }
  }
}

}  // namespace pd::detail

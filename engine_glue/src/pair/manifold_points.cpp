#include "pair/manifold_points.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "pair/bounce.hpp"
#include "pair/friction_anchor.hpp"
#include "pair/lasting_points.hpp"
#include "pd/bullet/scalar.hpp"
#include "shapes/body_motion.hpp"

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

/// Makes room for a new point in a full manifold. Bullet replaces the point that costs the least area, whatever its
/// normal, so that triangles of one slope of a groove push out the points of the other. Here a point of the most common
/// direction goes: the one nearest to another of that direction, but not the deepest of all.
/// @return false: the new point is the one to leave out
bool make_room(btPersistentManifold& manifold, const FreshPoint& fresh) {
  constexpr btScalar kOfOneWay = btScalar(0.9);  // cos 25 degrees
  struct Place {
    btVector3 normal, position;
    btScalar distance;
  };
  std::array<Place, MANIFOLD_CACHE_SIZE + 1> all;
  for (int i = 0; i < MANIFOLD_CACHE_SIZE; ++i) {
    const btManifoldPoint& point = manifold.getContactPoint(i);
    all[i] = {point.m_normalWorldOnB, point.m_positionWorldOnB, point.getDistance()};
  }
  all[MANIFOLD_CACHE_SIZE] = {fresh.normal, fresh.point_on_b, fresh.distance};
  const auto deepest =
      std::min_element(all.begin(), all.end(), [](const Place& x, const Place& y) { return x.distance < y.distance; });
  int least = MANIFOLD_CACHE_SIZE, most_alike = -1;
  btScalar nearest = 0;
  for (int i = 0; i <= MANIFOLD_CACHE_SIZE; ++i) {
    if (&all[i] == &*deepest) continue;
    int alike = 0;
    btScalar gap = BT_LARGE_FLOAT;
    for (int k = 0; k <= MANIFOLD_CACHE_SIZE; ++k) {
      if (k == i || all[i].normal.dot(all[k].normal) < kOfOneWay) continue;
      ++alike;
      gap = std::min(gap, (all[i].position - all[k].position).length2());
    }
    if (alike < most_alike || (alike == most_alike && gap > nearest)) continue;
    least = i;
    most_alike = alike;
    nearest = gap;
  }
  if (least == MANIFOLD_CACHE_SIZE) return false;
  manifold.removeContactPoint(least);
  return true;
}

/// The points on A, in its frame.
std::array<btVector3, 4> local_on_a(const btTransform& pose_a, const FreshPoints& fresh) {
  std::array<btVector3, 4> local;
  for (int k = 0; k < fresh.count; ++k) {
    const FreshPoint& point = fresh.points[k];
    local[k] = pose_a.invXform(point.point_on_b + point.normal * point.distance);
  }
  return local;
}

}  // namespace

void set_fresh_point(const btVector3& normal, const ContactPoint& point, FreshPoint& out) {
  out.normal = normal;
  out.point_on_b = to_bullet(point.position_b);
  out.distance = static_cast<btScalar>(-point.depth);
  out.feature_id = point.feature_id;
}

void set_fresh_points(const ContactManifold& manifold, FreshPoints& out) {
  const btVector3 normal = to_bullet(manifold.normal);
  for (int k = 0; k < manifold.count; ++k) {
    const auto i = static_cast<std::size_t>(k);
    set_fresh_point(normal, manifold.points[i], out.points[i]);
  }
  out.count = manifold.count;
}

void add_points(btPersistentManifold& manifold, const FreshPoints& found, const StepTime& seconds,
                btManifoldResult& result) {
  forget_parted(manifold);
  const Bounce bounce(manifold, result, seconds);
  FreshPoints fresh = found;
  if (bounce.possible()) bounce.leave_out(fresh);
  const std::array<btVector3, 4> local_a = local_on_a(manifold.getBody0()->getWorldTransform(), fresh);
  // Points nearer to each other than the breaking threshold replace each other here: the deepest comes last.
  std::array<int, 4> order{0, 1, 2, 3};
  std::stable_sort(order.begin(), order.begin() + fresh.count,
                   [&](int i, int k) { return fresh.points[i].distance > fresh.points[k].distance; });
  for (int i = 0; i < fresh.count; ++i) {
    const FreshPoint& point = fresh.points[order[i]];
    const int entry = entry_near(manifold, local_a[order[i]]);
    if (entry < 0 && manifold.getNumContacts() == MANIFOLD_CACHE_SIZE && !make_room(manifold, point)) continue;
    const FrictionAnchor anchor = entry >= 0 ? anchor_of(manifold.getContactPoint(entry)) : FrictionAnchor();
    const int added = add_anchored_point(result, manifold, point, entry, anchor);
    ImpulseTrend none;
    if (bounce.possible() && added >= 0) bounce.set(manifold.getContactPoint(added), none);
  }
}

namespace {

/// Takes points without an heir out of the manifold, and brings memory into the order of those that are left.
void drop_parted(btPersistentManifold& manifold, PairMemory& memory, Matching& matching) {
  std::array<RememberedPoint, 4> kept;
  for (int i = manifold.getNumContacts() - 1; i >= 0; --i) {
    if (matching.heir[i] >= 0) continue;
    // Moves the last point into the gap: those behind are dealt with already.
    const int last = manifold.getNumContacts() - 1;
    matching.heir[i] = matching.heir[last];
    matching.known[i] = matching.known[last];
    manifold.removeContactPoint(i);
  }
  for (int i = 0; i < manifold.getNumContacts(); ++i) {
    const int r = matching.known[i];
    kept[i].impulse = r >= 0 ? memory.points[r].impulse : ImpulseTrend();
  }
  memory.points = kept;
}

/// One point by Bullet's `addContactPoint`. Bullet hands impulses, life time and user data to the new point that falls
/// on an old one, which keeps its contact callbacks right, as clearing would not; so the old point moves to the new
/// one.
/// @param entry  that goes on as the point, or -1
void add_by_bullet(const PointsOfStep& step, const FreshPoint& point, const btVector3& local_a, int entry,
                   bool same_step) {
  ImpulseTrend impulse;
  FrictionAnchor anchor;
  if (entry >= 0) {
    btManifoldPoint& old = step.manifold.getContactPoint(entry);
    anchor = anchor_of(old);
    impulse = step.memory.points[entry].impulse;
    old.m_appliedImpulse = impulse.next(old.m_appliedImpulse, same_step);
    old.m_localPointA = local_a;
  }
  entry = add_anchored_point(step.result, step.manifold, point, entry, anchor);
  if (entry < 0) return;
  step.memory.points[entry].feature_id = point.feature_id;
  step.memory.points[entry].impulse = impulse;
  ++step.manifold.getContactPoint(entry).m_lifeTime;
}

/// True if the points, of which there is one at least, may be written without Bullet.
bool are_told_by_numbers(const PointsOfStep& step) {
  PieceNumbers numbers;
  return step.pieces == nullptr || step.pieces->numbers(step.fresh.points[0].piece, numbers);
}

/// Whatever became of the old points.
void replace_any_points(const PointsOfStep& step) {
  const auto& [manifold, memory, fresh, seconds, result, pieces] = step;
  const std::array<btVector3, 4> local_a = local_on_a(manifold.getBody0()->getWorldTransform(), fresh);
  Matching matching = match_points(manifold, memory, fresh, local_a);
  drop_parted(manifold, memory, matching);
  const bool same_step = seconds == memory.seconds;
  const btScalar threshold = manifold.getContactBreakingThreshold();
  // No point is left if a link of a multibody needs none of them in this step, or if all are about to bounce. Then
  // there is no piece to ask for its numbers.
  const bool together = fresh.count > 0 && points_are_alike(result) && are_told_by_numbers(step);
  std::array<int, 4> entries{-1, -1, -1, -1};  // of new points; -1: no old point goes on in it
  std::array<bool, 4> written{};               // new points
  LastingPoints lasting;
  for (int i = 0; i < manifold.getNumContacts(); ++i) {
    const int k = matching.heir[i];
    entries[k] = i;
    written[k] = together && fresh.points[k].distance <= threshold;
    if (written[k]) lasting.add(i, k);
  }
  if (lasting.count > 0) replace_lasting_points(step, lasting, PlacesKnown::yes);
  for (int k = 0; k < fresh.count; ++k) {
    if (written[k]) continue;
    if (pieces != nullptr) pieces->enter(fresh.points[k].piece);
    add_by_bullet(step, fresh.points[k], local_a[k], entries[k], same_step);
    if (pieces != nullptr) pieces->leave();
  }
  memory.seconds = seconds;
  memory.num_points = manifold.getNumContacts();
  for (int i = 0; i < memory.num_points; ++i) memory.points[i].local_a = manifold.getContactPoint(i).m_localPointA;
}

void replace_all_points(const PointsOfStep& step) {
  LastingPoints all;
  const bool may_last = step.fresh.count > 0 && are_told_by_numbers(step) &&
                        may_all_last(step.manifold, step.memory, step.fresh, step.result) &&
                        order_by_feature(step.memory, step.fresh, all);
  if (!may_last || !replace_lasting_points(step, all, PlacesKnown::no)) replace_any_points(step);
}

/// Returns the number of the point from which the sweeps over a link's points shall begin: the one that carried most in
/// the last step, or the deepest one if none carried anything.
int first_point_of_link(const btPersistentManifold& manifold) {
  constexpr btScalar kSameDepth = 0x1p-16F;  ///< of the breaking threshold
  const btScalar same_depth = kSameDepth * manifold.getContactBreakingThreshold();
  int most = 0, deepest = 0;
  for (int i = 1; i < manifold.getNumContacts(); ++i) {
    const btManifoldPoint& point = manifold.getContactPoint(i);
    if (point.m_appliedImpulse > manifold.getContactPoint(most).m_appliedImpulse) most = i;
    if (point.getDistance() < manifold.getContactPoint(deepest).getDistance() - same_depth) deepest = i;
  }
  return manifold.getContactPoint(most).m_appliedImpulse > 0 ? most : deepest;
}

/// Puts the points of a multibody's link into an order in which the sweeps converge soon: from the one that carried
/// most around the face, along its shorter side first, and around a square in one sense. A multibody's rows begin at
/// zero in every step, and each sweep over them is dear. Begun where most of the load is, the first sweep ends near the
/// solution, and the order lasts from step to step.
void order_points_of_links(btPersistentManifold& manifold, PairMemory& memory) {
  const int count = manifold.getNumContacts();
  if (count < 2 || !(is_link(*manifold.getBody0()) || is_link(*manifold.getBody1()))) return;
  constexpr btScalar kSameGap = btScalar(1 - 0x1p-10);
  const auto exchange = [&](int i, int k) {
    if (i == k) return;
    std::swap(manifold.getContactPoint(i), manifold.getContactPoint(k));
    std::swap(memory.points[static_cast<std::size_t>(i)], memory.points[static_cast<std::size_t>(k)]);
  };
  exchange(0, first_point_of_link(manifold));
  const btManifoldPoint& first = manifold.getContactPoint(0);
  const auto way = [&](int i) { return manifold.getContactPoint(i).m_positionWorldOnB - first.m_positionWorldOnB; };
  const auto is_before = [&](int i, int k) {
    const btVector3 to_i = way(i), to_k = way(k);
    if (to_i.length2() < kSameGap * to_k.length2()) return true;
    return to_k.length2() >= kSameGap * to_i.length2() && to_i.cross(to_k).dot(first.m_normalWorldOnB) > 0;
  };
  int next = 1;
  for (int i = 2; i < count; ++i) {
    if (is_before(i, next)) next = i;
  }
  exchange(1, next);
  if (count == 4 && way(2).length2() < kSameGap * way(3).length2()) exchange(2, 3);
}

}  // namespace

void replace_points(const PointsOfStep& step) {
  const auto& [manifold, memory, fresh, seconds, result, pieces] = step;
  const Bounce bounce(manifold, result, seconds);
  if (bounce.possible()) {
    FreshPoints touching = fresh;
    bounce.leave_out(touching);
    replace_all_points({manifold, memory, touching, seconds, result, pieces});
    for (int i = 0; i < memory.num_points; ++i) {
      bounce.set(manifold.getContactPoint(i), memory.points[static_cast<std::size_t>(i)].impulse);
    }
  } else {
    replace_all_points(step);
  }
  order_points_of_links(manifold, memory);
  // Bullet calls it from `refreshContactPoints`, which its own algorithms end with.
  if (gContactProcessedCallback != nullptr) {
    for (int i = manifold.getNumContacts() - 1; i >= 0; --i) {
      gContactProcessedCallback(manifold.getContactPoint(i), const_cast<btCollisionObject*>(manifold.getBody0()),
                                const_cast<btCollisionObject*>(manifold.getBody1()));
    }
  }
}

}  // namespace pd::detail

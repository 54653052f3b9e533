#include "contact_algorithm.hpp"

#include <BulletCollision/CollisionDispatch/btCollisionConfiguration.h>
#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/CollisionDispatch/btConvexConvexAlgorithm.h>
#include <BulletCollision/NarrowPhaseCollision/btGjkPairDetector.h>
#include <BulletCollision/NarrowPhaseCollision/btVoronoiSimplexSolver.h>

#include <algorithm>
#include <limits>
#include <typeinfo>

#include "friction_anchor.hpp"
#include "installation.hpp"
#include "moving_body.hpp"
#include "pd/bullet/scalar.hpp"
#include "solver_core.hpp"

namespace pd::detail {

// Bullet's pool gives out pieces of a fixed size and checks it by assertion only; this one is always large enough.
static_assert(sizeof(ContactAlgorithm) <= sizeof(btConvexConvexAlgorithm));

namespace {

const btConvexShape& convex_shape(const btCollisionObjectWrapper* wrapper) {
  return *static_cast<const btConvexShape*>(wrapper->getCollisionShape());
}

/// Whether the bounding boxes are further apart than contacts reach. Bullet's broadphase widens boxes by 2 cm whatever
/// the bodies' size, so that most pairs of small bodies end here.
bool boxes_apart(const btConvexShape& a, const btTransform& pose_a, const btConvexShape& b, const btTransform& pose_b,
                 btScalar reach) {
  btVector3 lower_a;
  btVector3 upper_a;
  btVector3 lower_b;
  btVector3 upper_b;
  a.getAabb(pose_a, lower_a, upper_a);
  b.getAabb(pose_b, lower_b, upper_b);
  for (int i = 0; i < 3; ++i) {
    if (lower_a[i] > upper_b[i] + reach || lower_b[i] > upper_a[i] + reach) {
      return true;
    }
  }
  return false;
}

/// How far apart two surfaces may be for a contact, as in Bullet's own algorithms: the breaking threshold and what a
/// closest-point query asks for beyond it. Contact tests have results of their own, which take every point that they
/// are given; Bullet's algorithm for two spheres gives them those within the query's threshold alone.
btScalar reach_of_contacts(const btManifoldResult& result, const btPersistentManifold& manifold, const btConvexShape& a,
                           const btConvexShape& b) {
  const btScalar asked = result.m_closestPointDistanceThreshold;
  const bool spheres = a.getShapeType() == SPHERE_SHAPE_PROXYTYPE && b.getShapeType() == SPHERE_SHAPE_PROXYTYPE;
  return spheres && typeid(result) != typeid(btManifoldResult) ? asked : manifold.getContactBreakingThreshold() + asked;
}

/// New point for each old one: -1 where none.
using Matching = std::array<int, 4>;

/// Pairs last step's manifold points with this step's: by feature where the place is the same within the breaking
/// threshold, else by place, nearest first, and then by feature wherever it has gone (what slides fast keeps its
/// impulse). Place comes before a feature that is elsewhere: where the edges of two faces nearly coincide, a crossing
/// of theirs goes from one end to the other by rounding.
Matching match_points(const btPersistentManifold& manifold, const PairMemory& memory, const ContactManifold& fresh,
                      const std::array<btVector3, 4>& fresh_local_a) {
  Matching matching{-1, -1, -1, -1};
  std::array<bool, 4> taken{};
  const int count = manifold.getNumContacts();
  const btScalar reach = manifold.getContactBreakingThreshold() * manifold.getContactBreakingThreshold();
  const auto gap = [&](int i, int k) {
    return (manifold.getContactPoint(i).m_localPointA - fresh_local_a[k]).length2();
  };
  const auto match = [&](int i, int k) {
    matching[i] = k;
    taken[k] = true;
  };
  const auto by_feature = [&](btScalar within) {
    for (int i = 0; i < count; ++i) {
      if (matching[i] >= 0) continue;
      const btVector3& local = manifold.getContactPoint(i).m_localPointA;
      int r = 0;
      while (r < memory.num_points && !(memory.points[r].local_a == local)) ++r;
      if (r == memory.num_points) continue;
      for (int k = 0; k < fresh.count; ++k) {
        if (!taken[k] && fresh.points[k].feature_id == memory.points[r].feature_id && gap(i, k) < within) {
          match(i, k);
          break;
        }
      }
    }
  };
  by_feature(reach);
  for (;;) {
    int best_old = -1;
    int best_new = -1;
    btScalar best = reach;
    for (int i = 0; i < count; ++i) {
      for (int k = 0; k < fresh.count; ++k) {
        if (matching[i] < 0 && !taken[k] && gap(i, k) < best) {
          best = gap(i, k);
          best_old = i;
          best_new = k;
        }
      }
    }
    if (best_old < 0) break;
    match(best_old, best_new);
  }
  by_feature(std::numeric_limits<btScalar>::infinity());
  return matching;
}

}  // namespace

ContactAlgorithm::ContactAlgorithm(const btCollisionAlgorithmConstructionInfo& info, const btCollisionObjectWrapper* a,
                                   const btCollisionObjectWrapper* b, const Installation& installation)
    : btActivatingCollisionAlgorithm(info, a, b), installation_(installation), manifold_(info.m_manifold) {}

ContactAlgorithm::~ContactAlgorithm() {
  if (owns_manifold_) {
    installation_.core().pairs.remove(manifold_);
    m_dispatcher->releaseManifold(manifold_);
  }
}

void ContactAlgorithm::getAllContactManifolds(btManifoldArray& manifolds) {
  if (owns_manifold_) {
    manifolds.push_back(manifold_);
  }
}

btCollisionAlgorithm* ContactAlgorithm::CreateFunc::CreateCollisionAlgorithm(btCollisionAlgorithmConstructionInfo& info,
                                                                             const btCollisionObjectWrapper* a,
                                                                             const btCollisionObjectWrapper* b) {
  const BulletSolverSettings& settings = installation.core().settings;
  if (settings.takes_pair && installation.dispatcher() != nullptr &&
      !settings.takes_pair(*a->getCollisionObject(), *b->getCollisionObject(), settings.user)) {
    const int type_a = a->getCollisionShape()->getShapeType();
    const int type_b = b->getCollisionShape()->getShapeType();
    btCollisionConfiguration* configuration = installation.dispatcher()->getCollisionConfiguration();
    btCollisionAlgorithmCreateFunc* own = for_closest_points
                                              ? configuration->getClosestPointsAlgorithmCreateFunc(type_a, type_b)
                                              : configuration->getCollisionAlgorithmCreateFunc(type_a, type_b);
    return own->CreateCollisionAlgorithm(info, a, b);
  }
  void* memory = info.m_dispatcher1->allocateCollisionAlgorithm(sizeof(ContactAlgorithm));
  return new (memory) ContactAlgorithm(info, a, b, installation);
}

void ContactAlgorithm::take_manifold(const btCollisionObjectWrapper* a, const btCollisionObjectWrapper* b) {
  manifold_ = m_dispatcher->getNewManifold(a->getCollisionObject(), b->getCollisionObject());
  owns_manifold_ = true;
  memory_ = std::make_unique<PairMemory>();
  installation_.core().pairs.add(manifold_, memory_.get());
}

void ContactAlgorithm::processCollision(const btCollisionObjectWrapper* a, const btCollisionObjectWrapper* b,
                                        const btDispatcherInfo& info, btManifoldResult* result) {
  SolverCore& core = installation_.core();
  const bool first = manifold_ == nullptr;
  if (first) {
    take_manifold(a, b);
  }
  result->setPersistentManifold(manifold_);

  const btConvexShape& shape_a = convex_shape(a);
  const btConvexShape& shape_b = convex_shape(b);
  const btTransform& pose_a = a->getWorldTransform();
  const btTransform& pose_b = b->getWorldTransform();
  const btScalar threshold = reach_of_contacts(*result, *manifold_, shape_a, shape_b);
  if (boxes_apart(shape_a, pose_a, shape_b, pose_b, threshold)) {
    if (owns_manifold_) {
      manifold_->clearManifold();
    }
    return;
  }
  if (core.closed()) {
    btGjkEpaPenetrationDepthSolver epa;
    process_by_bullet(epa, shape_a, pose_a, shape_b, pose_b, info, result);
    return;
  }
  auto buffers = core.buffers.lease();
  PairAnswer answer;
  // An algorithm that is used for the first time may belong to a query between two steps, whose shapes nobody compared.
  const std::uint64_t stamp = first ? 0 : installation_.stamp();
  const auto outcome =
      core.answer(shape_a, pose_a, shape_b, pose_b, BoxCorners::sharp, stamp,
                  memory_ ? memory_->shapes : buffers->recent, memory_ ? &memory_->warm : nullptr, *buffers, answer);
  if (outcome == SolverCore::Outcome::unsupported) {
    process_by_bullet(core.fallback(), shape_a, pose_a, shape_b, pose_b, info, result);
    return;
  }
  ContactManifold fresh;
  if (outcome == SolverCore::Outcome::answered) {
    fresh = contact_manifold(answer.a, answer.b, answer.depth, static_cast<double>(threshold), buffers->manifold,
                             DeepestPoint::as_lifted);
  }
  if (owns_manifold_) {
    replace_points(fresh, result);
  } else {
    add_points(fresh, result);
  }
}

void ContactAlgorithm::add_points(const ContactManifold& fresh, btManifoldResult* result) {
  const btVector3 normal = to_bullet(fresh.normal);
  const btTransform& body_a = manifold_->getBody0()->getWorldTransform();
  for (int k = 0; k < fresh.count; ++k) {
    const btVector3 point_on_b = to_bullet(fresh.points[k].position_b);
    const auto distance = static_cast<btScalar>(-fresh.points[k].depth);
    const int entry = entry_near(*manifold_, body_a.invXform(point_on_b + normal * distance));
    const FrictionAnchor anchor = entry >= 0 ? anchor_of(manifold_->getContactPoint(entry)) : FrictionAnchor();
    add_anchored_point(*result, *manifold_, normal, point_on_b, distance, entry, anchor);
  }
}

void ContactAlgorithm::replace_points(const ContactManifold& fresh, btManifoldResult* result) {
  const btVector3 normal = to_bullet(fresh.normal);
  const btTransform& body_a = manifold_->getBody0()->getWorldTransform();
  std::array<btVector3, 4> local_a;
  for (int k = 0; k < fresh.count; ++k) {
    const auto distance = static_cast<btScalar>(-fresh.points[k].depth);
    local_a[k] = body_a.invXform(to_bullet(fresh.points[k].position_b) + normal * distance);
  }
  Matching matching = match_points(*manifold_, *memory_, fresh, local_a);
  // Bullet's `addContactPoint` hands impulses, life time and user data to the new point that falls on an old one. So a
  // matched old point is moved to its heir first; that keeps Bullet's contact callbacks right, which clearing would
  // not.
  std::array<FrictionAnchor, 4> anchors;
  for (int i = manifold_->getNumContacts() - 1; i >= 0; --i) {
    if (matching[i] < 0) {
      // Moves the last point into the gap: those behind are dealt with already.
      const int last = manifold_->getNumContacts() - 1;
      anchors[i] = anchors[last];
      manifold_->removeContactPoint(i);
    } else {
      btManifoldPoint& old = manifold_->getContactPoint(i);
      anchors[i] = anchor_of(old);
      old.m_localPointA = local_a[matching[i]];
    }
  }
  for (int k = 0; k < fresh.count; ++k) {
    const int near = entry_near(*manifold_, local_a[k]);
    const int entry =
        add_anchored_point(*result, *manifold_, normal, to_bullet(fresh.points[k].position_b),
                           static_cast<btScalar>(-fresh.points[k].depth), near, anchors[std::max(near, 0)]);
    if (entry >= 0) {
      memory_->points[entry].feature_id = fresh.points[k].feature_id;
    }
  }
  memory_->num_points = manifold_->getNumContacts();
  for (int i = 0; i < memory_->num_points; ++i) {
    memory_->points[i].local_a = manifold_->getContactPoint(i).m_localPointA;
    ++manifold_->getContactPoint(i).m_lifeTime;
  }
  // Bullet calls it from `refreshContactPoints`, which its own algorithms end with.
  if (gContactProcessedCallback != nullptr) {
    for (int i = manifold_->getNumContacts() - 1; i >= 0; --i) {
      gContactProcessedCallback(manifold_->getContactPoint(i), const_cast<btCollisionObject*>(manifold_->getBody0()),
                                const_cast<btCollisionObject*>(manifold_->getBody1()));
    }
  }
}

void ContactAlgorithm::process_by_bullet(btConvexPenetrationDepthSolver& solver, const btConvexShape& a,
                                         const btTransform& transform_a, const btConvexShape& b,
                                         const btTransform& transform_b, const btDispatcherInfo& info,
                                         btManifoldResult* result) {
  if (is_finite(transform_a) && is_finite(transform_b)) {
    btVoronoiSimplexSolver simplex;
    btGjkPairDetector detector(&a, &b, &simplex, &solver);
    btGjkPairDetector::ClosestPointInput input;
    const btScalar reach = a.getMargin() + b.getMargin() + manifold_->getContactBreakingThreshold() +
                           result->m_closestPointDistanceThreshold;
    input.m_maximumDistanceSquared = reach * reach;
    input.m_transformA = transform_a;
    input.m_transformB = transform_b;
    detector.getClosestPoints(input, *result, info.m_debugDraw);
  }
  if (owns_manifold_) {
    result->refreshContactPoints();
  }
}

btScalar ContactAlgorithm::calculateTimeOfImpact(btCollisionObject* a, btCollisionObject* b, const btDispatcherInfo&,
                                                 btManifoldResult*) {
  SolverCore& core = installation_.core();
  if (core.closed() || !a->getCollisionShape()->isConvex() || !b->getCollisionShape()->isConvex()) {
    return btScalar(1);
  }
  const auto shape_a = core.cache.find_or_convert(*static_cast<btConvexShape*>(a->getCollisionShape()));
  const auto shape_b = core.cache.find_or_convert(*static_cast<btConvexShape*>(b->getCollisionShape()));
  if (!shape_a || !shape_b) {
    return btScalar(1);
  }
  auto buffers = core.buffers.lease();
  const auto impact = time_of_impact(
      moving_shape(*shape_a, a->getWorldTransform(), a->getInterpolationWorldTransform(), 1),
      moving_shape(*shape_b, b->getWorldTransform(), b->getInterpolationWorldTransform(), 1), 1, buffers->scratch);
  return impact.hit ? static_cast<btScalar>(impact.time) : btScalar(1);
}

}  // namespace pd::detail

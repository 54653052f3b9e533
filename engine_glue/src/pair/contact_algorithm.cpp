#include "pair/contact_algorithm.hpp"

#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/NarrowPhaseCollision/btGjkPairDetector.h>
#include <BulletCollision/NarrowPhaseCollision/btVoronoiSimplexSolver.h>

#include <algorithm>
#include <limits>
#include <typeinfo>

#include "pair/box_contacts.hpp"
#include "pair/flight_memory.hpp"
#include "pair/friction_anchor.hpp"
#include "pair/manifold_points.hpp"
#include "pair/passing_bodies.hpp"
#include "pair/points_of_pieces.hpp"
#include "pair/solver_core.hpp"
#include "pair/step_reach.hpp"
#include "pd/bullet/scalar.hpp"
#include "pieces/piece_wrapper.hpp"
#include "shapes/cached_shape.hpp"
#include "shapes/compound_children.hpp"

namespace pd::detail {

namespace {

const btConvexShape& convex_shape(const btCollisionObjectWrapper* wrapper) {
  return *static_cast<const btConvexShape*>(wrapper->getCollisionShape());
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

}  // namespace

ContactAlgorithm::ContactAlgorithm(const btCollisionAlgorithmConstructionInfo& info, const btCollisionObjectWrapper* a,
                                   const btCollisionObjectWrapper* b, const SolverInWorld& world, Kind)
    : AlgorithmShell(info, a, b), world_(world), manifold_(world.core(), *info.m_dispatcher1, info.m_manifold) {}

void ContactAlgorithm::getAllContactManifolds(btManifoldArray& manifolds) { manifold_.append_to(manifolds); }

bool ContactAlgorithm::sharp_parts() const { return world_.core().settings.unions_as_one; }

void ContactAlgorithm::processCollision(const btCollisionObjectWrapper* a, const btCollisionObjectWrapper* b,
                                        const btDispatcherInfo& info, btManifoldResult* result) {
  SolverCore& core = world_.core();
  const bool first = manifold_.take(*a, *b, *result);
  btPersistentManifold& manifold = manifold_.get();
  PairMemory* const memory = manifold_.memory();
  result->setPersistentManifold(&manifold);
  const btConvexShape& shape_a = convex_shape(a);
  const btConvexShape& shape_b = convex_shape(b);
  // Pieces of unions have neighbours that may cover their contacts.
  const bool of_union = core.settings.unions_as_one && (is_piece(*a) || is_piece(*b));
  const bool boxes = !of_union && are_boxes(shape_a, shape_b);

  const btTransform& pose_a = a->getWorldTransform();
  const btTransform& pose_b = b->getWorldTransform();
  const btScalar threshold = reach_of_contacts(*result, manifold, shape_a, shape_b);
  // A pair that had points is asked at once: it hardly ever parts in a step, and the query says so if it does.
  const bool touched = memory != nullptr && memory->num_points > 0;
  const bool own_boxes = boxes && memory != nullptr;
  const BoxesInFlight in_flight{shape_a, pose_a, shape_b, pose_b, threshold};
  if (own_boxes && memory->flight.known()) {
    if (flies_on(in_flight, info, *result)) return;
    memory->flight.forget();
  }
  // Bullet's broadphase widens boxes by 2 cm whatever the bodies' size, so that most pairs of small bodies end here.
  if (!touched && apart(box_of(shape_a, pose_a), box_of(shape_b, pose_b), threshold)) {
    manifold_.clear();
    return;
  }
  if (core.closed()) {
    btGjkEpaPenetrationDepthSolver epa;
    process_by_bullet(epa, *a, *b, info, *result);
    return;
  }
  const auto this_step = [&] { return StepReach(*result, threshold, info.m_timeStep); };
  const btScalar reach = own_boxes && !touched ? this_step().of_boxes(shape_a, shape_b) : threshold;
  auto buffers = core.buffers.lease();
  FreshPoints fresh;
  PairAnswer* answer = nullptr;  // the buffers' own, since making it costs more than boxes take to be compared
  const std::uint64_t stamp = world_.stamp(info, first);
  const auto asked_reach = static_cast<double>(threshold);
  const double contact_reach = std::min(asked_reach, static_cast<double>(manifold.getContactBreakingThreshold()));
  const bool asked_for_more = contact_reach < asked_reach;
  if (!boxes || asked_for_more ||
      !box_contacts(shape_a, pose_a, shape_b, pose_b, static_cast<double>(reach), *buffers, fresh)) {
    const SharpCorners corners{true, of_union && is_part(*a), of_union && is_part(*b)};
    const PairQuestion asked{.a = shape_a,
                             .pose_a = pose_a,
                             .b = shape_b,
                             .pose_b = pose_b,
                             .shapes = memory != nullptr ? memory->shapes : buffers->recent,
                             .warm = memory != nullptr ? &memory->warm : nullptr,
                             .stamp = stamp,
                             .corners = corners,
                             .beyond = touched ? kAnyDistance : static_cast<double>(threshold),
                             .boxes_asked = boxes && !asked_for_more};
    ContactManifold points;
    answer = &(buffers->answer = PairAnswer());
    const auto outcome = core.contacts(asked, contact_reach, *buffers, *answer, points);
    if (outcome == SolverCore::Outcome::unsupported) {
      process_by_bullet(core.fallback(), *a, *b, info, *result);
      return;
    }
    if (outcome == SolverCore::Outcome::answered) {
      if (of_union) {
        buffers->near.begin_pair(stamp);
        keep_points_of_pieces({.a = *a,
                               .b = *b,
                               .contact_reach = contact_reach,
                               .asked_reach = asked_reach,
                               .seconds = static_cast<double>(info.m_timeStep),
                               .shapes = {core.cache, stamp}},
                              *answer, *buffers, points);
      } else {
        far_pair(contact_reach, asked_reach, answer->depth, points);
      }
      set_fresh_points(points, fresh);
    }
  }
  if (memory != nullptr && !of_union && on_one_line(fresh, kEdge * threshold) && this_step().against_fixed()) {
    if (answer == nullptr) {
      const CachedShape& found_a = core.find(shape_a, stamp, memory->shapes[0], *buffers);
      const CachedShape& found_b = core.find(shape_b, stamp, memory->shapes[1], *buffers);
      answer = &(buffers->answer = {.depth = {},
                                    .a = {found_a.sharp.get(), to_pd(pose_a)},
                                    .b = {found_b.sharp.get(), to_pd(pose_b)},
                                    .boxes = true});
    }
    if (answer->a.shape != nullptr && answer->b.shape != nullptr &&
        pass_each_other(answer->a, answer->b, fresh, this_step())) {
      fresh.count = 0;
    }
  }
  const bool idle = own_boxes && StepReach::may_be_idle(fresh, threshold);
  if (idle) this_step().leave_out_idle(fresh);
  if (!own_boxes || fresh.count == 0 || !manifold_.carries_nothing()) {
    manifold_.replace(fresh, time_of(info), *result);
    return;
  }
  const StepReach unloaded = this_step();
  const btVector3 normal = fresh.points[0].normal;
  unloaded.leave_out_flying(fresh);
  manifold_.replace(fresh, time_of(info), *result);
  const bool all_lasting = !idle && manifold.getNumContacts() == fresh.count;
  if (all_lasting && unloaded.as_fast_as_each_other() && !Bounce(manifold, *result, time_of(info)).possible()) {
    memory->flight.begin(in_flight, normal, unloaded, manifold);
  }
}

bool ContactAlgorithm::flies_on(const BoxesInFlight& boxes, const btDispatcherInfo& info, btManifoldResult& result) {
  PairMemory& memory = *manifold_.memory();
  if (!memory.flight.same_place(boxes, manifold_.get()) || !manifold_.carries_nothing() || world_.core().closed())
    return false;
  // Callbacks are told of each point in each step.
  if (!points_are_alike(result) || gContactProcessedCallback != nullptr) return false;
  if (!memory.flight.same_flight(StepReach(result, boxes.threshold, info.m_timeStep))) return false;
  memory.flight.move_points(boxes, manifold_.get());
  memory.seconds = time_of(info);
  return true;
}

void ContactAlgorithm::process_by_bullet(btConvexPenetrationDepthSolver& solver, const btCollisionObjectWrapper& of_a,
                                         const btCollisionObjectWrapper& of_b, const btDispatcherInfo& info,
                                         btManifoldResult& result) {
  if (is_finite(of_a.getWorldTransform()) && is_finite(of_b.getWorldTransform())) {
    const btConvexShape& a = convex_shape(&of_a);
    const btConvexShape& b = convex_shape(&of_b);
    btVoronoiSimplexSolver simplex;
    btGjkPairDetector detector(&a, &b, &simplex, &solver);
    btGjkPairDetector::ClosestPointInput input;
    const btScalar reach = a.getMargin() + b.getMargin() + manifold_.get().getContactBreakingThreshold() +
                           result.m_closestPointDistanceThreshold;
    input.m_maximumDistanceSquared = reach * reach;
    input.m_transformA = of_a.getWorldTransform();
    input.m_transformB = of_b.getWorldTransform();
    detector.getClosestPoints(input, result, info.m_debugDraw);
  }
  manifold_.refresh(result);
}

}  // namespace pd::detail

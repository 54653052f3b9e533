#include "pair/plane_algorithm.hpp"

#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>

#include "pair/bullets_stand_in.hpp"
#include "pair/plane_ground.hpp"
#include "pair/solver_core.hpp"

namespace pd::detail {

PlaneAlgorithm::PlaneAlgorithm(const btCollisionAlgorithmConstructionInfo& info, const btCollisionObjectWrapper* a,
                               const btCollisionObjectWrapper* b, const SolverInWorld& world, Kind kind)
    : AlgorithmShell(info, a, b),
      world_(world),
      swapped_(kind.swapped),
      manifold_(world.core(), *info.m_dispatcher1, info.m_manifold),
      bullets_(std::make_unique<BulletsStandIn>(world, *info.m_dispatcher1)) {}

PlaneAlgorithm::~PlaneAlgorithm() = default;

void PlaneAlgorithm::getAllContactManifolds(btManifoldArray& manifolds) {
  manifold_.append_to(manifolds);
  bullets_->append_to(manifolds);
}

bool PlaneAlgorithm::find(const btCollisionObjectWrapper& body, const btCollisionObjectWrapper& plane,
                          std::uint64_t stamp, btManifoldResult& result, FreshPoints& fresh) {
  SolverCore& core = world_.core();
  if (core.closed()) return false;
  if (!is_finite(plane.getWorldTransform())) return true;
  const Halfspace3 ground = ground_of(plane);
  const auto threshold =
      static_cast<double>(manifold_.get().getContactBreakingThreshold() + result.m_closestPointDistanceThreshold);
  const auto& convex = static_cast<const btConvexShape&>(*body.getCollisionShape());
  PairMemory* const memory = manifold_.memory();
  const bool touched = memory != nullptr && memory->num_points > 0;
  if (!touched && box_above(convex, body.getWorldTransform(), ground, threshold)) return true;
  auto buffers = core.buffers.lease();
  const GroundQuestion asked{.body = convex,
                             .pose = body.getWorldTransform(),
                             .ground = ground,
                             .stamp = stamp,
                             .shape = memory != nullptr ? memory->shapes[0] : buffers->recent[0],
                             .threshold = threshold,
                             .sharp_box = true};
  HalfspaceContact found;
  const SolverCore::Outcome outcome = core.stand_on(asked, *buffers, found);
  if (outcome == SolverCore::Outcome::answered) set_fresh_points(found.manifold, fresh);
  return outcome != SolverCore::Outcome::unsupported;
}

void PlaneAlgorithm::processCollision(const btCollisionObjectWrapper* a, const btCollisionObjectWrapper* b,
                                      const btDispatcherInfo& info, btManifoldResult* result) {
  const btCollisionObjectWrapper& body = swapped_ ? *b : *a;
  const btCollisionObjectWrapper& plane = swapped_ ? *a : *b;
  const bool first = manifold_.take(body, plane, *result);
  result->setPersistentManifold(&manifold_.get());
  FreshPoints fresh;
  if (find(body, plane, world_.stamp(info, first), *result, fresh)) {
    bullets_->release();
    manifold_.replace(fresh, time_of(info), *result);
    return;
  }
  manifold_.clear();
  bullets_->process(a, b, info, result);
}

}  // namespace pd::detail

#include "union/union_algorithm.hpp"

#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/CollisionDispatch/btConvexConvexAlgorithm.h>

#include <utility>

#include "pair/bullets_stand_in.hpp"
#include "pair/solver_core.hpp"
#include "world/installation.hpp"

namespace pd::detail {

// Bullet's pool of algorithms holds no larger ones.
static_assert(sizeof(UnionAlgorithm) <= sizeof(btConvexConvexAlgorithm));

/// What lives between steps.
struct UnionAlgorithm::State {
  State(const Installation& of, const btCollisionAlgorithmConstructionInfo& info, bool is_swapped,
        std::unique_ptr<UnionContacts> finder)
      : installation(of),
        swapped(is_swapped),
        contacts(std::move(finder)),
        manifolds(of.core(), *info.m_dispatcher1),
        bullets(of, *info.m_dispatcher1) {}

  const Installation& installation;
  bool swapped;
  std::unique_ptr<UnionContacts> contacts;
  PatchManifolds manifolds;
  Patches patches;
  BulletsStandIn bullets;
  bool used = false;
};

UnionAlgorithm::UnionAlgorithm(const btCollisionAlgorithmConstructionInfo& info, const btCollisionObjectWrapper* a,
                               const btCollisionObjectWrapper* b, const Installation& installation, bool swapped,
                               std::unique_ptr<UnionContacts> contacts)
    : btActivatingCollisionAlgorithm(info, a, b),
      state_(std::make_unique<State>(installation, info, swapped, std::move(contacts))) {}

UnionAlgorithm::~UnionAlgorithm() = default;

btCollisionAlgorithm* UnionAlgorithm::CreateFunc::CreateCollisionAlgorithm(btCollisionAlgorithmConstructionInfo& info,
                                                                           const btCollisionObjectWrapper* a,
                                                                           const btCollisionObjectWrapper* b) {
  if (!installation.takes(*a, *b) || !installation.core().settings.unions_as_one) {
    return installation.bullets_algorithm(info, a, b);
  }
  void* memory = info.m_dispatcher1->allocateCollisionAlgorithm(sizeof(UnionAlgorithm));
  return new (memory) UnionAlgorithm(info, a, b, installation, m_swapped, contacts());
}

void UnionAlgorithm::getAllContactManifolds(btManifoldArray& manifolds) {
  state_->manifolds.append_to(manifolds);
  state_->bullets.append_to(manifolds);
}

void UnionAlgorithm::processCollision(const btCollisionObjectWrapper* a, const btCollisionObjectWrapper* b,
                                      const btDispatcherInfo& info, btManifoldResult* result) {
  State& s = *state_;
  const btCollisionObjectWrapper& one = s.swapped ? *b : *a;
  const btCollisionObjectWrapper& other = s.swapped ? *a : *b;
  btPersistentManifold& first = s.manifolds.first(*one.getCollisionObject(), *other.getCollisionObject());
  result->setPersistentManifold(&first);
  if (!s.installation.core().closed()) {
    // What is used for the first time may belong to a query between two steps, whose shapes nobody compared.
    const std::uint64_t stamp = std::exchange(s.used, true) ? s.installation.stamp() : 0;
    const btScalar threshold = first.getContactBreakingThreshold() + result->m_closestPointDistanceThreshold;
    const UnionQuestion question{one, other, static_cast<double>(info.m_timeStep), threshold, stamp, *result};
    s.patches.clear();
    if (s.contacts->find(question, s.installation.core(), s.manifolds.memory(), s.patches)) {
      s.bullets.release();
      s.contacts->replace(question, s.patches, s.manifolds);
      return;
    }
  }
  s.manifolds.clear();
  s.bullets.process(a, b, info, result);
}

}  // namespace pd::detail

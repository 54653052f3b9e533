#include "union/union_algorithm.hpp"

#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>

#include <utility>

#include "pair/bullets_stand_in.hpp"
#include "pair/solver_core.hpp"
#include "union/flat_wrapper.hpp"
#include "union/mesh_contacts.hpp"

namespace pd::detail {

/// What lives between steps.
struct UnionAlgorithm::State {
  State(const SolverInWorld& of, const btCollisionAlgorithmConstructionInfo& info, const Kind& kind)
      : world(of),
        swapped(kind.swapped),
        contacts(kind.contacts()),
        manifolds(of.core(), *info.m_dispatcher1),
        bullets(of, *info.m_dispatcher1) {}

  const SolverInWorld& world;
  bool swapped;
  std::unique_ptr<UnionContacts> contacts;
  PatchManifolds manifolds;
  Patches patches;
  BulletsStandIn bullets;
  FlatMemory flat[2];  ///< of the question's a and b
  bool used = false;

  /// Fills `patches`. Trials that begin at one state take what the first one found: it is the longest, so that no point
  /// is missing. @return false: Bullet's own algorithm has to answer
  bool find(const UnionQuestion& question);

 private:
  /// Keeps what was found last.
  struct Found {
    std::uint64_t trials = 0;  ///< `SolverCore::trials`
    btScalar threshold = 0;
    btTransform pose_a, pose_b;
    UnionPairMemory memory;  ///< as it was left
  } found_;
};

bool UnionAlgorithm::State::find(const UnionQuestion& question) {
  SolverCore& core = world.core();
  const std::uint64_t trials = core.trials();
  const btTransform& pose_a = question.a.getWorldTransform();
  const btTransform& pose_b = question.b.getWorldTransform();
  UnionPairMemory& memory = manifolds.memory();
  if (trials != 0 && trials == found_.trials && question.threshold == found_.threshold && pose_a == found_.pose_a &&
      pose_b == found_.pose_b) {
    memory = found_.memory;
    return true;
  }
  patches.clear();
  found_.trials = 0;
  if (!contacts->find(question, core, manifolds.memory(), patches)) return false;
  if (trials == 0) return true;
  found_.trials = trials;
  found_.threshold = question.threshold;
  found_.pose_a = pose_a;
  found_.pose_b = pose_b;
  found_.memory = memory;
  return true;
}

bool UnionAlgorithm::Kind::takes(const SolverInWorld& world, const btCollisionObjectWrapper& a,
                                 const btCollisionObjectWrapper& b) {
  const bool field = is_distance_field(*a.getCollisionShape()) || is_distance_field(*b.getCollisionShape());
  return !field && world.takes(a, b) && world.core().settings.unions_as_one;
}

UnionAlgorithm::UnionAlgorithm(const btCollisionAlgorithmConstructionInfo& info, const btCollisionObjectWrapper* a,
                               const btCollisionObjectWrapper* b, const SolverInWorld& world, const Kind& kind)
    : AlgorithmShell(info, a, b), state_(std::make_unique<State>(world, info, kind)) {}

UnionAlgorithm::~UnionAlgorithm() = default;

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
  if (!s.world.core().closed()) {
    // An algorithm that is used for the first time may belong to a query between two steps, whose shapes nobody
    // compared: a stamp of its own has each of them compared once.
    SolverCore& core = s.world.core();
    const std::uint64_t stamp = std::exchange(s.used, true) ? s.world.stamp() : core.next_stamp();
    const btScalar threshold = first.getContactBreakingThreshold() + result->m_closestPointDistanceThreshold;
    const FlatWrapper flat_one(one, core.flat_compounds, stamp, s.flat[0]);
    const FlatWrapper flat_other(other, core.flat_compounds, stamp, s.flat[1]);
    const UnionQuestion question{flat_one.wrapper(), flat_other.wrapper(), time_of(info), threshold, stamp, *result};
    if (s.find(question)) {
      s.bullets.release();
      s.contacts->replace(question, s.patches, s.manifolds);
      return;
    }
  }
  s.manifolds.clear();
  s.bullets.process(a, b, info, result);
}

}  // namespace pd::detail

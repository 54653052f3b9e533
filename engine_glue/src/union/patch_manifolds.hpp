/// @file
/// The manifolds of one pair of bodies, one for each patch of contact points.
#pragma once

#include <BulletCollision/BroadphaseCollision/btCollisionAlgorithm.h>
#include <BulletCollision/BroadphaseCollision/btDispatcher.h>
#include <BulletCollision/CollisionDispatch/btManifoldResult.h>

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "pair/manifold_points.hpp"
#include "pair/pair_registry.hpp"
#include "pd/union_contact/patches.hpp"

namespace pd::detail {

class SolverCore;

class PatchManifolds final : public ManifoldOwner {
 public:
  /// Directions of contact that a pair of bodies may have, with four points each.
  static constexpr int kMost = 8;

  PatchManifolds(SolverCore& core, btDispatcher& dispatcher) : core_(core), dispatcher_(dispatcher) {}
  ~PatchManifolds() override;
  PatchManifolds(const PatchManifolds&) = delete;
  PatchManifolds& operator=(const PatchManifolds&) = delete;

  /// The pair's first manifold; there is always one, so that hosts see the pair.
  btPersistentManifold& first(const btCollisionObject& a, const btCollisionObject& b) { return *at(0, a, b).manifold; }
  /// What the pair remembers beside its points.
  PairMemory& memory() { return manifolds_[0]->memory; }

  /// Puts this step's points in place of last step's: a patch goes to the manifold that had its normal. `pieces` are
  /// entered with the number of the point's piece. Requires: `first` was called. Leaves `result` at the first.
  /// @param seconds of the step
  void replace(Patches& patches, const StepTime& seconds, btManifoldResult& result, PointSurroundings& pieces);

  void clear();
  void release_from(int patch) override;
  void append_to(btManifoldArray& manifolds) const;

 private:
  struct Kept {
    btPersistentManifold* manifold = nullptr;
    PairMemory memory;
  };
  using LastPatches = std::array<LastPatch, kMost>;
  /// What the manifolds hold from the last step, where the bodies are now; `of` gets the manifolds' numbers.
  std::span<const LastPatch> last_patches(std::array<int, kMost>& of, LastPatches& patches) const;
  Kept& at(std::size_t i, const btCollisionObject& a, const btCollisionObject& b);

  SolverCore& core_;
  btDispatcher& dispatcher_;
  std::vector<std::unique_ptr<Kept>> manifolds_;
};

}  // namespace pd::detail

/// @file
/// The contact algorithm of a convex body and a `btStaticPlaneShape`: the whole manifold from the first step.
#pragma once

#include "pair/algorithm_shell.hpp"
#include "pair/own_manifold.hpp"

namespace pd::detail {

class BulletsStandIn;

/// Bullet's own algorithm finds one point a step, the farthest in the plane, so that a face needs several steps to lie
/// down. The body is taken as it is there: boxes sharp, other shapes core and margin; the plane's margin counts for
/// nothing.
class PlaneAlgorithm final : public AlgorithmShell {
 public:
  struct Kind {
    bool swapped;  ///< a is the plane
    static constexpr ContactTable table = ContactTable::contacts;
  };
  PlaneAlgorithm(const btCollisionAlgorithmConstructionInfo& info, const btCollisionObjectWrapper* a,
                 const btCollisionObjectWrapper* b, const SolverInWorld& world, Kind kind);
  ~PlaneAlgorithm() override;

  void processCollision(const btCollisionObjectWrapper* a, const btCollisionObjectWrapper* b,
                        const btDispatcherInfo& info, btManifoldResult* result) override;
  void getAllContactManifolds(btManifoldArray& manifolds) override;

 private:
  /// @return false: Bullet's algorithm is to answer
  bool find(const btCollisionObjectWrapper& body, const btCollisionObjectWrapper& plane, std::uint64_t stamp,
            btManifoldResult& result, FreshPoints& fresh);

  const SolverInWorld& world_;
  bool swapped_;
  OwnManifold manifold_;
  std::unique_ptr<BulletsStandIn> bullets_;
};

}  // namespace pd::detail

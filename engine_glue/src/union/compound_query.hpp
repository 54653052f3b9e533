/// @file
/// Queries between steps (contactTest, contactPairTest) of pairs with a compound.
#pragma once

#include "pair/algorithm_shell.hpp"
#include "pair/bullets_stand_in.hpp"

namespace pd::detail {

/// Tells the points of each pair of children, as Bullet's own algorithms do, which make an algorithm with a manifold
/// for each of them. Here the children are found, placed and compared once a query.
class CompoundQuery final : public AlgorithmShell {
 public:
  struct Kind {
    static constexpr ContactTable table = ContactTable::closest_points;
    [[nodiscard]] static bool takes(const SolverInWorld& world, const btCollisionObjectWrapper&,
                                    const btCollisionObjectWrapper&) {
      return world.core().settings.unions_as_one;
    }
  };
  CompoundQuery(const btCollisionAlgorithmConstructionInfo& info, const btCollisionObjectWrapper* a,
                const btCollisionObjectWrapper* b, const SolverInWorld& world, Kind)
      : AlgorithmShell(info, a, b), world_(world), bullets_(world, *info.m_dispatcher1) {}

  void processCollision(const btCollisionObjectWrapper* a, const btCollisionObjectWrapper* b,
                        const btDispatcherInfo& info, btManifoldResult* result) override;
  void getAllContactManifolds(btManifoldArray& manifolds) override { bullets_.append_to(manifolds); }

 private:
  const SolverInWorld& world_;
  /// Answers where the points are to stay in manifolds, and after the solver's end.
  BulletsStandIn bullets_;
};

}  // namespace pd::detail

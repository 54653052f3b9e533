/// @file
/// The contact algorithm of a convex pair: one exact answer a step, and the whole manifold from it at once.
#pragma once

#include "pair/algorithm_shell.hpp"
#include "pair/own_manifold.hpp"

namespace pd::detail {

/// Bullet's own algorithm finds one point a step and needs several steps for a face; this one has up to four from the
/// first step. Impulses go from last step's points to this step's by feature, else by place, so that the constraint
/// solver starts warm. A manifold that Bullet shares between pairs (mesh triangles) is added to and never cleared.
class ContactAlgorithm final : public AlgorithmShell {
 public:
  struct Kind {
    ContactTable table;  ///< of the dispatcher, in which the algorithm stands
  };
  ContactAlgorithm(const btCollisionAlgorithmConstructionInfo& info, const btCollisionObjectWrapper* a,
                   const btCollisionObjectWrapper* b, const SolverInWorld& world, Kind kind);

  void processCollision(const btCollisionObjectWrapper* a, const btCollisionObjectWrapper* b,
                        const btDispatcherInfo& info, btManifoldResult* result) override;
  void getAllContactManifolds(btManifoldArray& manifolds) override;
  /// True if boxes that are children of compounds are taken without their margin.
  [[nodiscard]] bool sharp_parts() const;

 private:
  /// True if two boxes fly together as in the last step: their points are moved along, and nothing is asked.
  bool flies_on(const BoxesInFlight& boxes, const btDispatcherInfo& info, btManifoldResult& result);
  void process_by_bullet(btConvexPenetrationDepthSolver& solver, const btCollisionObjectWrapper& a,
                         const btCollisionObjectWrapper& b, const btDispatcherInfo& info, btManifoldResult& result);

  const SolverInWorld& world_;
  OwnManifold manifold_;
};

}  // namespace pd::detail

/// @file
/// A solver in one dispatcher: the create functions that the dispatcher points to, and the count of the world's steps.
#pragma once

#include <BulletCollision/CollisionDispatch/btConvexConvexAlgorithm.h>
#include <BulletDynamics/Dynamics/btActionInterface.h>
#include <LinearMath/btScalar.h>

#include <atomic>
#include <cstdint>

#include "pair/contact_algorithm.hpp"
#include "pair/plane_algorithm.hpp"
#include "union/union_algorithm.hpp"

class btCollisionDispatcher;

namespace pd::detail {

class SolverCore;

/// Never moves and, once a dispatcher knows it, never dies: see SolverCore.
class Installation {
 public:
  /// @param dispatcher  nullptr: create functions that a host registers itself
  Installation(SolverCore& core, btCollisionDispatcher* dispatcher);
  Installation(const Installation&) = delete;
  Installation& operator=(const Installation&) = delete;

  [[nodiscard]] SolverCore& core() const { return core_; }
  [[nodiscard]] btCollisionDispatcher* dispatcher() const { return dispatcher_; }
  /// Of the present step; 0 until the world made its first step with `step_action`.
  [[nodiscard]] std::uint64_t stamp() const { return stamp_.load(std::memory_order_relaxed); }

  /// For the table of contacts (`closest` false) or that of closest points.
  [[nodiscard]] btCollisionAlgorithmCreateFunc* one_shot(bool closest) { return closest ? &closest_ : &contacts_; }
  /// For the table of contacts: a convex body or compound against a mesh, or (`swapped`) the other way round.
  [[nodiscard]] btCollisionAlgorithmCreateFunc* mesh(bool swapped) { return swapped ? &swapped_mesh_ : &mesh_; }
  /// For the table of contacts: pairs with a compound, of compounds and convex bodies.
  [[nodiscard]] btCollisionAlgorithmCreateFunc* compound() { return &compound_; }
  /// For the table of contacts: convex against plane, or (`swapped`) plane against convex.
  [[nodiscard]] btCollisionAlgorithmCreateFunc* plane(bool swapped) { return swapped ? &swapped_plane_ : &plane_; }
  /// For the table of contacts: compound against plane, or (`swapped`) plane against compound.
  [[nodiscard]] btCollisionAlgorithmCreateFunc* compound_on_plane(bool swapped) {
    return swapped ? &swapped_compound_on_plane_ : &compound_on_plane_;
  }
  /// Whether the host leaves the pair to us (`BulletSolverSettings::takes_pair`).
  [[nodiscard]] bool takes(const btCollisionObjectWrapper& a, const btCollisionObjectWrapper& b) const;
  /// The algorithm of the dispatcher's own configuration, for pairs that are left to it. Requires a dispatcher.
  [[nodiscard]] btCollisionAlgorithm* bullets_algorithm(btCollisionAlgorithmConstructionInfo& info,
                                                        const btCollisionObjectWrapper* a,
                                                        const btCollisionObjectWrapper* b) const;
  [[nodiscard]] btCollisionAlgorithmCreateFunc* persistent() { return &persistent_; }
  [[nodiscard]] btConvexPenetrationDepthSolver* depth_solver() { return &depth_solver_; }
  /// Tells that a step has ended; for `btDynamicsWorld::addAction`.
  [[nodiscard]] btActionInterface* step_action() { return &step_action_; }

 private:
  /// Asks the core with this world's stamp.
  class DepthSolver final : public btConvexPenetrationDepthSolver {
   public:
    explicit DepthSolver(const Installation& installation) : installation_(installation) {}
    bool calcPenDepth(btSimplexSolverInterface& simplex, const btConvexShape* a, const btConvexShape* b,
                      const btTransform& pose_a, const btTransform& pose_b, btVector3& v, btVector3& witness_a,
                      btVector3& witness_b, btIDebugDraw* draw) override;

   private:
    const Installation& installation_;
  };

  class StepAction final : public btActionInterface {
   public:
    explicit StepAction(Installation& installation) : installation_(installation) {}
    void updateAction(btCollisionWorld* world, btScalar step) override;
    void debugDraw(btIDebugDraw*) override {}

   private:
    Installation& installation_;
  };

  SolverCore& core_;
  btCollisionDispatcher* dispatcher_;
  std::atomic<std::uint64_t> stamp_{0};
  DepthSolver depth_solver_;
  StepAction step_action_;
  ContactAlgorithm::CreateFunc contacts_;
  ContactAlgorithm::CreateFunc closest_;
  UnionAlgorithm::CreateFunc mesh_;
  UnionAlgorithm::CreateFunc swapped_mesh_;
  UnionAlgorithm::CreateFunc compound_;
  UnionAlgorithm::CreateFunc compound_on_plane_;
  UnionAlgorithm::CreateFunc swapped_compound_on_plane_;
  PlaneAlgorithm::CreateFunc plane_;
  PlaneAlgorithm::CreateFunc swapped_plane_;
  btConvexConvexAlgorithm::CreateFunc persistent_;
};

}  // namespace pd::detail

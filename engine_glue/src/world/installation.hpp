/// @file
/// A solver in dispatchers: the create functions that they point to, and the count of their worlds' steps.
#pragma once

#include <BulletCollision/CollisionDispatch/btConvexConvexAlgorithm.h>
#include <BulletDynamics/Dynamics/btActionInterface.h>
#include <LinearMath/btScalar.h>

#include "pair/contact_algorithm.hpp"
#include "pair/plane_algorithm.hpp"
#include "pair/solver_in_world.hpp"
#include "union/compound_query.hpp"
#include "union/union_algorithm.hpp"

namespace pd::detail {

class Installation final : public SolverInWorld {
 public:
  /// For the world of a dispatcher, which tells of its steps: one of a fixed number, in constant time.
  static Installation& of_world(SolverCore& core, const btCollisionDispatcher* dispatcher);
  /// For all dispatchers whose steps nobody counts, or for the tables of hosts.
  static Installation& of(SolverCore& core, InstalledIn in);

  Installation(SolverCore& core, InstalledIn in);

  /// For the table of contacts (`closest` false) or that of closest points.
  [[nodiscard]] btCollisionAlgorithmCreateFunc* one_shot(bool closest) { return closest ? &closest_ : &contacts_; }
  /// For the table of contacts: a convex body or compound against a mesh, or (`swapped`) the other way round.
  [[nodiscard]] btCollisionAlgorithmCreateFunc* mesh(bool swapped) { return swapped ? &swapped_mesh_ : &mesh_; }
  /// For the table of contacts: pairs with a compound, of compounds and convex bodies.
  [[nodiscard]] btCollisionAlgorithmCreateFunc* compound() { return &compound_; }
  /// For the table of closest points: the same pairs.
  [[nodiscard]] btCollisionAlgorithmCreateFunc* compound_query() { return &compound_query_; }
  /// For the table of contacts: convex against plane, or (`swapped`) plane against convex.
  [[nodiscard]] btCollisionAlgorithmCreateFunc* plane(bool swapped) { return swapped ? &swapped_plane_ : &plane_; }
  /// For the table of contacts: compound against plane, or (`swapped`) plane against compound.
  [[nodiscard]] btCollisionAlgorithmCreateFunc* compound_on_plane(bool swapped) {
    return swapped ? &swapped_compound_on_plane_ : &compound_on_plane_;
  }
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

  static Installation& at(SolverCore& core, std::size_t place, InstalledIn in);

  DepthSolver depth_solver_;
  StepAction step_action_;
  CreateFuncOf<ContactAlgorithm> contacts_;
  CreateFuncOf<ContactAlgorithm> closest_;
  CreateFuncOf<UnionAlgorithm> mesh_;
  CreateFuncOf<UnionAlgorithm> swapped_mesh_;
  CreateFuncOf<UnionAlgorithm> compound_;
  CreateFuncOf<CompoundQuery> compound_query_;
  CreateFuncOf<UnionAlgorithm> compound_on_plane_;
  CreateFuncOf<UnionAlgorithm> swapped_compound_on_plane_;
  CreateFuncOf<PlaneAlgorithm> plane_;
  CreateFuncOf<PlaneAlgorithm> swapped_plane_;
  btConvexConvexAlgorithm::CreateFunc persistent_;
};

}  // namespace pd::detail

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

class Installation final : public SolverInWorld, public btConvexPenetrationDepthSolver, public btActionInterface {
 public:
  /// For the world of a dispatcher, which tells of its steps: one of a fixed number, in constant time.
  static Installation& of_world(SolverCore& core, const btCollisionDispatcher* dispatcher);
  /// For all dispatchers whose steps nobody counts, and for configurations.
  static Installation& of_others(SolverCore& core);

  explicit Installation(SolverCore& core);

  CreateFuncOf<ContactAlgorithm> contacts;  ///< for the table of contacts
  CreateFuncOf<ContactAlgorithm> closest;   ///< for that of closest points
  // For the table of contacts; [1]: the bodies the other way round.
  CreateFuncOf<UnionAlgorithm> mesh[2];               ///< a convex body or compound against a mesh
  CreateFuncOf<UnionAlgorithm> compound_on_plane[2];  ///< a compound against a plane
  CreateFuncOf<PlaneAlgorithm> plane[2];              ///< a convex body against a plane
  CreateFuncOf<UnionAlgorithm> compound;              ///< pairs with a compound, of compounds and convex bodies
  CreateFuncOf<CompoundQuery> compound_query;         ///< the same for the table of closest points
  btConvexConvexAlgorithm::CreateFunc persistent;     ///< Bullet's, which asks this depth solver

  /// Asks the core. Bullet does not tell here if the world is in a step, so that all points are compared.
  bool calcPenDepth(btSimplexSolverInterface& simplex, const btConvexShape* a, const btConvexShape* b,
                    const btTransform& pose_a, const btTransform& pose_b, btVector3& v, btVector3& witness_a,
                    btVector3& witness_b, btIDebugDraw* draw) override;
  /// A step has ended.
  void updateAction(btCollisionWorld* world, btScalar step) override;
  void debugDraw(btIDebugDraw*) override {}

 private:
  static Installation& at(SolverCore& core, std::size_t place);
};

}  // namespace pd::detail

/// @file
/// Bullet's constraint solver for stacks that have to stand still: begun at the solution of the step.
#pragma once

#include <BulletDynamics/ConstraintSolver/btSequentialImpulseConstraintSolver.h>

#include <limits>

namespace pd {

struct StackSolverSettings {
  /// Groups of more bodies than this are left to Bullet's sweeps; as it stands, no group is.
  int max_bodies = std::numeric_limits<int>::max();
};

/// Since construction or `reset_statistics`.
struct StackSolverStatistics {
  long long groups = 0;          ///< islands, or several small ones together, that were solved
  long long factorisations = 0;  ///< a group of up to 40 bodies at rest takes one
  long long unsettled = 0;  ///< of `groups`: not solved in 32, or no numbers, so that Bullet's sweeps began as without
  long long left = 0;       ///< groups of more than `max_bodies`, left to Bullet's sweeps
};

/// In place of `btSequentialImpulseConstraintSolver`, with contacts of any origin and constraints of any kind:
///
///     pd::StackSolver impulses;
///     btDiscreteDynamicsWorld world(&dispatcher, &broadphase, &impulses, &configuration);
///
/// Bullet's own solver starts from last step's impulses and makes `m_numIterations` sweeps, too few for a load to come
/// through a stack: towers of small bodies fall before they have felt their weight. Here the rows that Bullet has set
/// up (contacts, friction, joints) are solved at once first (`src/stack/impulse_newton.hpp`), and its sweeps begin
/// there; they alone decide rolling friction and split impulses, as ever. Ten sweeps are enough, with two friction
/// directions
/// (`apply_recommended`) and contacts that do not come and go (`install`).
///
/// Time: one sparse factorisation a step and group while the same points carry, and a few more where points come, go or
/// slip. A factorisation takes O(n) for a tower of n bodies, and longer for a heap as its blocks fill in:
/// `stack_growth` measured n^1.13 and n^1.21 for 5 to 435 bodies. Where pairs of bodies come or go, the order of
/// elimination is found anew, which takes about as long as a factorisation.
///
/// Bodies with angular factors other than 0 and 1 are solved with the square root of the factor on both sides of the
/// inertia. This differs from Bullet's one-sided product unless the product is diagonal; the sweeps decide.
///
/// Not for `btMultiBodyDynamicsWorld`, which takes a `btMultiBodyConstraintSolver`. Threads: as Bullet's, one solver a
/// world.
class StackSolver : public btSequentialImpulseConstraintSolver {
 public:
  BT_DECLARE_ALIGNED_ALLOCATOR();

  explicit StackSolver(const StackSolverSettings& settings = {});
  ~StackSolver() override;
  StackSolver(const StackSolver&) = delete;
  StackSolver& operator=(const StackSolver&) = delete;

  [[nodiscard]] const StackSolverStatistics& statistics() const { return statistics_; }
  void reset_statistics() { statistics_ = {}; }

 protected:
  btScalar solveGroupCacheFriendlyIterations(btCollisionObject** bodies, int num_bodies,
                                             btPersistentManifold** manifolds, int num_manifolds,
                                             btTypedConstraint** constraints, int num_constraints,
                                             const btContactSolverInfo& info, btIDebugDraw* drawer) override;

 private:
  struct State;
  void begin_at_solution(const btContactSolverInfo& info);
  void read_bodies();
  void read_rows(btConstraintArray& pool, int first_contact);
  void hand_back(btConstraintArray& pool, std::size_t first);

  StackSolverSettings settings_;
  StackSolverStatistics statistics_;
  State* state_;  ///< owned
};

}  // namespace pd

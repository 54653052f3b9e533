/// @file
/// Bullet's constraint solver for stacks that have to stand still: begun at the solution of the step.
#pragma once

#include <BulletDynamics/ConstraintSolver/btSequentialImpulseConstraintSolver.h>

#include <limits>

namespace pd {

struct StackSolverSettings {
  /// Groups of more bodies than this are left to Bullet's sweeps. By default no group is too large.
  int max_bodies = std::numeric_limits<int>::max();
};

/// Counts since construction or `reset_statistics`. A group is a set of bodies that contacts and joints connect.
struct StackSolverStatistics {
  long long groups = 0;          ///< groups that were solved
  long long factorisations = 0;  ///< a group of up to 40 bodies at rest takes one
  long long unsettled = 0;       ///< of `groups`: did not converge or contained NaN; Bullet's sweeps began as usual
  long long left = 0;            ///< groups that were left to Bullet's sweeps
};

/// In place of `btSequentialImpulseConstraintSolver`, with contacts of any origin and constraints of any kind:
///
///     pd::StackSolver impulses;
///     btDiscreteDynamicsWorld world(&dispatcher, &broadphase, &impulses, &configuration);
///
/// Bullet's own solver starts from last step's impulses and makes `m_numIterations` sweeps, too few for a load to come
/// through a stack: towers of small bodies fall before they have felt their weight. Here the rows that Bullet has set
/// up (contacts, friction, joints) are solved at once first (`src/stack/impulse_newton.hpp`), and its sweeps begin
/// there. The sweeps alone decide rolling friction and split impulses. Ten sweeps are enough, with two friction
/// directions (`apply_recommended`) and contacts that do not come and go (`install`).
///
/// A group is solved where that pays, and left to the sweeps otherwise:
/// - where nothing holds it, or so few bodies stand on each other that the sweeps carry the load themselves;
/// - where more than a fifth of its rows move, by more than twice the speed that its weight gives it in a step;
/// - where it is a block whose factorisation fills in (more than 4 products of blocks a row);
/// - where the first factorisation shows that contacts come and go, unless its bodies stand in a high column that has
///   taken fewer than 96 factorisations in such steps. Each other step that is tried pays four of them back.
///
/// A group of the last kind is left alone for the next 2 steps, then 4, up to 64. The first two leave a group with a
/// joint to the sweeps only where something holds it, they carry its load, and no contact moves. At an impact they
/// would let the ends of a joint part. All this is decided by counts, so that the same world gives the same bits.
///
/// Time: one sparse factorisation a step and group that is solved while the same points carry, and a few more where
/// points come, go or slip. A factorisation takes O(n) for a tower of n bodies (`stack_growth` measured n^1.13, and
/// n^1.21 for pyramids of up to 435 bodies). Where all groups of a call are solved, the sweeps end as soon as they mend
/// nothing. A standing tower takes 1.1 of the step that ten sweeps take, a pyramid 1.6 to 1.9, a wall 1.7 to 3.4. Heaps
/// and blocks, which are left to the sweeps, take at most 1.1. Columns that fall over take 2 until they are left alone.
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

  /// For each body, by its place in the world, for how many steps its group is left alone, and what it owes (in one
  /// number). `BulletSnapshot` saves it, and `set_memory` puts it back. Time O(1), and O(bodies) to put it back.
  [[nodiscard]] const btAlignedObjectArray<unsigned>& memory() const;
  void set_memory(const btAlignedObjectArray<unsigned>& memory);

 protected:
  btScalar solveGroupCacheFriendlyIterations(btCollisionObject** bodies, int num_bodies,
                                             btPersistentManifold** manifolds, int num_manifolds,
                                             btTypedConstraint** constraints, int num_constraints,
                                             const btContactSolverInfo& info, btIDebugDraw* drawer) override;

 private:
  struct State;
  /// @return the speed up to which all groups are solved; 0 if a group is left to the sweeps
  btScalar begin_at_solution(const btContactSolverInfo& info);

  StackSolverSettings settings_;
  StackSolverStatistics statistics_;
  State* state_;  ///< owned
};

}  // namespace pd

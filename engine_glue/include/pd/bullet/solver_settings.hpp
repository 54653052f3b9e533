/// @file
/// Settings of Bullet's constraint solver that whole manifolds deserve.
#pragma once

struct btContactSolverInfo;

namespace pd {

/// Sets, and says why (Bullet's default in brackets):
/// - `m_numIterations` = 30 [10]: a tower of 20 passes an impulse from bottom to top in about as many sweeps as it has
///   bodies; at 10 every contact solver lets it sink and lean.
/// - `m_solverMode |= SOLVER_USE_2_FRICTION_DIRECTIONS` [one direction]: with one, friction below 3.4e-4 m/s acts along
///   a fixed axis only, and nothing resists drift across it or a turn.
/// - `m_solverMode |= SOLVER_INTERLEAVE_CONTACT_AND_FRICTION_CONSTRAINTS` [all contacts, then all friction]: each
///   point's friction follows its normal impulse at once. Stacks sway less with it.
/// - `m_leastSquaresResidualThreshold` = 1e-14 [0], unless it is larger: the sweeps end after one that changes no
///   contact's speed by more than 1e-7 (in the world's unit of length, a second). Ten metres above the origin, a place
///   in single precision is known to 1e-6. A body that stands or slides by itself takes half of the sweeps, and a tall
///   stack takes all of them. Set the threshold to 0 if gravity is below 0.01.
///
/// Where a stack has to stand still whatever its size, `StackSolver` (pd/bullet/stack_solver.hpp) solves it at once,
/// and ten iterations are enough.
///
/// All other fields stay: the host's gravity of penetration (`m_erp2`), split impulses, warm starting, restitution
/// threshold. `pdepth-bench contact` measures its scenes at the defaults and at these.
void apply_recommended(btContactSolverInfo& info);

}  // namespace pd

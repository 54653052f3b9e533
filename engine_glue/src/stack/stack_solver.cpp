#include "pd/bullet/stack_solver.hpp"

#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "stack/body_inertia.hpp"
#include "stack/impulse_newton.hpp"
#include "stack/row_groups.hpp"
#include "stack/waiting_bodies.hpp"

namespace pd {
namespace {

using detail::ImpulseNewton;
using detail::RowGroups;
using detail::six;
using detail::SolverBodies;
using detail::SolverRows;

/// Softness of friction beyond its own, like `ImpulseNewton::kSoftness`.
constexpr double kFrictionSoftness = 1e-2;

detail::BodyInertia inertia_of(const btSolverBody& body) {
  return detail::body_inertia(body.internalGetInvMass(), body.m_originalBody->getInvInertiaTensorWorld(),
                              body.m_angularFactor);
}

// A group is left to the sweeps where any of these says so.

/// In this many e-folds all but 3e-4 of an error is gone. Sweeps that come as far carry the load themselves.
constexpr double kFoldsOfSweeps = 8;
/// A group with joints is left to the sweeps from this many e-folds on. Joints begin each step from nothing, and take
/// back a fifth of their error in each. With a fiftieth of the load left, their ends are apart by a tenth of the way
/// that a body falls in a step.
constexpr double kFoldsOfJoints = 4;
/// Share of a group's rows that move. It is 0 in stacks that stand, and at most 0.1 where a column of ten lands.
constexpr double kMovingShare = 0.2;
/// Products of a factorisation for each row. Walls and pyramids take 1.6; a block of 5 x 5 x 5 boxes takes 8.
constexpr long long kProductsOfRow = 4;
/// `ImpulseNewton::Limits::amiss_at_first`.
constexpr double kAmissAtFirst = 0.1;
/// `ImpulseNewton::Limits::amiss_at_end`. With 1e-5 a wall drifts at least four times as far: what is left of a step
/// moves its bricks. With 1e-8 it takes as many factorisations and more.
constexpr double kAmissAtEnd = 1e-7;
/// Columns whose load takes this many times the sweeps that are made are solved also while contacts come and go: ten
/// boxes that land as a column fall otherwise. Ten sweeps spare columns of six and more.
constexpr double kHighColumn = 1.2;

/// Share of the speed that a step of their weight gives to the bodies of a group. Sweeps that change less in each row
/// of a group that is solved mend nothing.
constexpr btScalar kNegligibleShare = btScalar(1e-4);

btScalar negligible_speed(const SolverBodies& bodies, std::span<const int> group) {
  btScalar weight = 0;
  for (const int body : group) weight = std::max(weight, bodies[body].m_externalForceImpulse.length2());
  return kNegligibleShare * std::sqrt(weight);
}

/// An impact on a joint is no load that sweeps carry: they leave its ends at a speed against each other.
bool suits_sweeps(const RowGroups::Group& group, double sweeps, int num_sweeps) {
  if (group.joint_rows > 0) return group.moving_rows == 0 && sweeps > 0 && kFoldsOfJoints * sweeps < num_sweeps;
  return kFoldsOfSweeps * sweeps < num_sweeps || group.moving_rows > kMovingShare * group.num_rows;
}

}  // namespace

struct StackSolver::State {
  RowGroups groups;
  /// Solves all groups in turn. Its order of elimination holds while groups have the same pattern.
  ImpulseNewton newton;
  std::vector<int> place;      ///< of each solver body in `ImpulseNewton::masses`, -1: fixed
  std::vector<int> row_place;  ///< of each row in `ImpulseNewton::rows`
  std::vector<ImpulseNewton::Vector6> moves;
  detail::WaitingBodies waiting;

  void read_bodies(const SolverBodies& bodies, const RowGroups::Group& group);
  void read_rows(const SolverRows& rows, const RowGroups::Group& group, double warm_share);
  void hand_back(const SolverRows& rows, const RowGroups::Group& group, SolverBodies& bodies) const;
};

StackSolver::StackSolver(const StackSolverSettings& settings) : settings_(settings), state_(new State) {}
StackSolver::~StackSolver() { delete state_; }

const btAlignedObjectArray<unsigned>& StackSolver::memory() const { return state_->waiting.entries; }
void StackSolver::set_memory(const btAlignedObjectArray<unsigned>& memory) { state_->waiting.entries = memory; }

btScalar StackSolver::solveGroupCacheFriendlyIterations(btCollisionObject** bodies, int num_bodies,
                                                        btPersistentManifold** manifolds, int num_manifolds,
                                                        btTypedConstraint** constraints, int num_constraints,
                                                        const btContactSolverInfo& info, btIDebugDraw* drawer) {
  const btScalar tolerance = begin_at_solution(info);
  // Bullet ends its sweeps after one that changes no row's speed by more than the square root of this.
  btContactSolverInfo sweeps = info;
  sweeps.m_leastSquaresResidualThreshold = std::max(info.m_leastSquaresResidualThreshold, tolerance * tolerance);
  return btSequentialImpulseConstraintSolver::solveGroupCacheFriendlyIterations(
      bodies, num_bodies, manifolds, num_manifolds, constraints, num_constraints, sweeps, drawer);
}

btScalar StackSolver::begin_at_solution(const btContactSolverInfo& info) {
  const SolverRows rows{m_tmpSolverNonContactConstraintPool, m_tmpSolverContactConstraintPool,
                        m_tmpSolverContactFrictionConstraintPool};
  // Contacts begin with a share of what they carried.
  const double warm_share = info.m_warmstartingFactor > 0 ? static_cast<double>(info.m_warmstartingFactor) : 1;
  state_->groups.find(m_tmpSolverBodyPool, rows);
  state_->place.assign(static_cast<std::size_t>(m_tmpSolverBodyPool.size()), -1);
  state_->row_place.resize(static_cast<std::size_t>(rows.size()));
  btScalar tolerance = BT_LARGE_FLOAT;
  for (const RowGroups::Group& group : state_->groups.groups()) {
    if (group.num_rows == 0) continue;
    const double sweeps = state_->groups.sweeps_of_load(m_tmpSolverBodyPool, rows, group);
    const std::span<const int> members = state_->groups.bodies(group);
    if (group.num_bodies > settings_.max_bodies || suits_sweeps(group, sweeps, info.m_numIterations) ||
        state_->waiting.wait_a_step(m_tmpSolverBodyPool, members)) {
      ++statistics_.left;
      tolerance = 0;
      continue;
    }
    state_->read_bodies(m_tmpSolverBodyPool, group);
    state_->read_rows(rows, group, warm_share);
    const bool is_spared =
        sweeps > kHighColumn * info.m_numIterations && state_->waiting.may_owe(m_tmpSolverBodyPool, members);
    const ImpulseNewton::Outcome outcome = state_->newton.solve({.products = kProductsOfRow * group.num_rows,
                                                                 .amiss_at_first = kAmissAtFirst,
                                                                 .spares_trees = is_spared,
                                                                 .amiss_at_end = kAmissAtEnd});
    state_->waiting.note(m_tmpSolverBodyPool, members, outcome.settled, outcome.spared ? outcome.factorisations : 0);
    statistics_.factorisations += outcome.factorisations;
    tolerance = outcome.settled ? std::min(tolerance, negligible_speed(m_tmpSolverBodyPool, members)) : 0;
    if (outcome.given_up) {
      ++statistics_.left;
      continue;
    }
    ++statistics_.groups;
    if (outcome.settled) {
      state_->hand_back(rows, group, m_tmpSolverBodyPool);
    } else {
      ++statistics_.unsettled;
    }
  }
  return tolerance < BT_LARGE_FLOAT ? tolerance : 0;
}

void StackSolver::State::read_bodies(const SolverBodies& bodies, const RowGroups::Group& group) {
  newton.masses.clear();
  moves.clear();
  for (const int i : groups.bodies(group)) {
    const detail::BodyInertia inertia = inertia_of(bodies[i]);
    place[static_cast<std::size_t>(i)] = static_cast<int>(newton.masses.size());
    newton.masses.push_back(inertia.mass);
    moves.push_back(inertia.moves);
  }
}

void StackSolver::State::read_rows(const SolverRows& rows, const RowGroups::Group& group, double warm_share) {
  newton.rows.clear();
  for (const int i : groups.rows(group)) {
    const btSolverConstraint& constraint = rows[i];
    const bool is_friction = i >= rows.first_friction();
    const bool is_contact = !is_friction && i >= rows.first_contact();
    row_place[static_cast<std::size_t>(i)] = static_cast<int>(newton.rows.size());
    ImpulseNewton::Row row;
    const btVector3* linear[2] = {&constraint.m_contactNormal1, &constraint.m_contactNormal2};
    const btVector3* angular[2] = {&constraint.m_relpos1CrossNormal, &constraint.m_relpos2CrossNormal};
    const int bodies[2] = {constraint.m_solverBodyIdA, constraint.m_solverBodyIdB};
    for (int side = 0; side < 2; ++side) {
      const int body = place[static_cast<std::size_t>(bodies[side])];
      row.body[side] = body;
      if (body < 0) continue;
      row.jacobian[side] = six(*linear[side], *angular[side]).cwiseProduct(moves[static_cast<std::size_t>(body)]);
    }
    // Bullet keeps targets and softness multiplied by the inverse of what bodies weigh against the row; a row that
    // nothing moves has none.
    const double inverse = static_cast<double>(constraint.m_jacDiagABInv);
    row.impulse = static_cast<double>(static_cast<btScalar>(constraint.m_appliedImpulse));
    if (is_contact) row.impulse /= warm_share;
    row.lower = static_cast<double>(constraint.m_lowerLimit);
    row.upper = static_cast<double>(constraint.m_upperLimit);
    if (inverse > 0) {
      const double share = is_friction ? kFrictionSoftness : ImpulseNewton::kSoftness;
      row.target = static_cast<double>(constraint.m_rhs) / inverse;
      row.softness = (static_cast<double>(constraint.m_cfm) + share) / inverse;
      if (!is_friction) row.of_changes = share / inverse;
    } else {
      row.body[0] = row.body[1] = -1;
      row.softness = 1;
      row.lower = row.upper = row.impulse;
    }
    if (is_friction) {
      row.normal = row_place[static_cast<std::size_t>(rows.first_contact() + constraint.m_frictionIndex)];
      row.friction = static_cast<double>(constraint.m_friction);
    }
    newton.rows.push_back(row);
  }
}

/// Impulses and what they change of velocities, as a sweep does it.
void StackSolver::State::hand_back(const SolverRows& rows, const RowGroups::Group& group, SolverBodies& bodies) const {
  std::size_t place_of_row = 0;
  for (const int i : groups.rows(group)) {
    btSolverConstraint& constraint = rows[i];
    const btScalar impulse = static_cast<btScalar>(newton.rows[place_of_row++].impulse);
    const btScalar change = impulse - static_cast<btScalar>(constraint.m_appliedImpulse);
    constraint.m_appliedImpulse = impulse;
    btSolverBody& a = bodies[constraint.m_solverBodyIdA];
    btSolverBody& b = bodies[constraint.m_solverBodyIdB];
    a.internalApplyImpulse(constraint.m_contactNormal1 * a.internalGetInvMass(), constraint.m_angularComponentA,
                           change);
    b.internalApplyImpulse(constraint.m_contactNormal2 * b.internalGetInvMass(), constraint.m_angularComponentB,
                           change);
  }
}

}  // namespace pd

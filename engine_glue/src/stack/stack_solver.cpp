#include "pd/bullet/stack_solver.hpp"

#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <Eigen/LU>
#include <cmath>

#include "stack/impulse_newton.hpp"

namespace pd {
namespace {

using detail::ImpulseNewton;

/// Softness of rows beyond their own, as a share of what their bodies weigh against them. Four points under a face say
/// three things, and their eight rows of friction three others; poses in single precision let them contradict each
/// other by some 1e-7 m a step, which stiff rows answer with impulses against each other: with 1e-6 for both, points
/// slip for that alone, and towers at 240 Hz and more fly apart. With 1e-2 for normals a pyramid takes more rounds than
/// it gets. Of the normals' only changes feel it, so that nothing sinks.
constexpr double kSoftness = 1e-4;
constexpr double kFrictionSoftness = 1e-2;

ImpulseNewton::Vector6 six(const btVector3& linear, const btVector3& angular) {
  ImpulseNewton::Vector6 result;
  for (int i = 0; i < 3; ++i) {
    result[i] = static_cast<double>(linear[i]);
    result[3 + i] = static_cast<double>(angular[i]);
  }
  return result;
}

/// A body's mass matrix, and its directions that can move (1) or cannot (0), whose mass is 1 and of no account.
struct Inertia {
  ImpulseNewton::Matrix6 mass = ImpulseNewton::Matrix6::Identity();
  ImpulseNewton::Vector6 moves = ImpulseNewton::Vector6::Zero();
};

Inertia inertia_of(const btSolverBody& body) {
  Inertia result;
  const btMatrix3x3& inverse = body.m_originalBody->getInvInertiaTensorWorld();
  Eigen::Matrix3d turning;
  for (int i = 0; i < 3; ++i) {
    const double inverse_mass = static_cast<double>(body.internalGetInvMass()[i]);
    if (inverse_mass > 0) {
      result.mass(i, i) = 1 / inverse_mass;
      result.moves[i] = 1;
    }
    for (int j = 0; j < 3; ++j) {
      turning(i, j) = static_cast<double>(inverse[i][j]) *
                      std::sqrt(static_cast<double>(body.m_angularFactor[i] * body.m_angularFactor[j]));
    }
  }
  for (int i = 0; i < 3; ++i) {
    if (turning(i, i) > 0) {
      result.moves[3 + i] = 1;
      continue;
    }
    turning.row(i).setZero();
    turning.col(i).setZero();
    turning(i, i) = 1;
  }
  result.mass.bottomRightCorner<3, 3>() = turning.inverse();
  return result;
}

}  // namespace

struct StackSolver::State {
  ImpulseNewton newton;
  std::vector<int> place;  ///< of each solver body in `newton.masses`, -1: fixed
  std::vector<ImpulseNewton::Vector6> moves;
};

StackSolver::StackSolver(const StackSolverSettings& settings) : settings_(settings), state_(new State) {}
StackSolver::~StackSolver() { delete state_; }

btScalar StackSolver::solveGroupCacheFriendlyIterations(btCollisionObject** bodies, int num_bodies,
                                                        btPersistentManifold** manifolds, int num_manifolds,
                                                        btTypedConstraint** constraints, int num_constraints,
                                                        const btContactSolverInfo& info, btIDebugDraw* drawer) {
  begin_at_solution(info);
  return btSequentialImpulseConstraintSolver::solveGroupCacheFriendlyIterations(
      bodies, num_bodies, manifolds, num_manifolds, constraints, num_constraints, info, drawer);
}

void StackSolver::begin_at_solution(const btContactSolverInfo& info) {
  ImpulseNewton& newton = state_->newton;
  read_bodies();
  if (static_cast<int>(newton.masses.size()) > settings_.max_bodies) {
    ++statistics_.left;
    return;
  }
  newton.rows.clear();
  const int first_contact = m_tmpSolverNonContactConstraintPool.size();
  const int first_friction = first_contact + m_tmpSolverContactConstraintPool.size();
  read_rows(m_tmpSolverNonContactConstraintPool, -1);
  read_rows(m_tmpSolverContactConstraintPool, -1);
  read_rows(m_tmpSolverContactFrictionConstraintPool, first_contact);
  // Contacts begin with a share of what they carried.
  if (info.m_warmstartingFactor > 0) {
    for (int i = first_contact; i < first_friction; ++i) {
      newton.rows[static_cast<std::size_t>(i)].impulse /= static_cast<double>(info.m_warmstartingFactor);
    }
  }
  if (newton.rows.empty() || newton.masses.empty()) return;

  const ImpulseNewton::Outcome outcome = newton.solve();
  ++statistics_.groups;
  statistics_.factorisations += outcome.factorisations;
  if (!outcome.settled) {
    ++statistics_.unsettled;
    return;
  }
  hand_back(m_tmpSolverNonContactConstraintPool, 0);
  hand_back(m_tmpSolverContactConstraintPool, static_cast<std::size_t>(first_contact));
  hand_back(m_tmpSolverContactFrictionConstraintPool, static_cast<std::size_t>(first_friction));
}

void StackSolver::read_bodies() {
  state_->newton.masses.clear();
  state_->place.clear();
  state_->moves.clear();
  for (int i = 0; i < m_tmpSolverBodyPool.size(); ++i) {
    const btSolverBody& body = m_tmpSolverBodyPool[i];
    if (body.m_originalBody == nullptr || body.m_originalBody->isStaticOrKinematicObject()) {
      state_->place.push_back(-1);
      continue;
    }
    const Inertia inertia = inertia_of(body);
    state_->place.push_back(static_cast<int>(state_->newton.masses.size()));
    state_->newton.masses.push_back(inertia.mass);
    state_->moves.push_back(inertia.moves);
  }
}

/// @param first_contact  of friction: the row of the first contact; else -1
void StackSolver::read_rows(btConstraintArray& pool, int first_contact) {
  const double share = first_contact < 0 ? kSoftness : kFrictionSoftness;
  for (int i = 0; i < pool.size(); ++i) {
    const btSolverConstraint& constraint = pool[i];
    ImpulseNewton::Row row;
    const btVector3* linear[2] = {&constraint.m_contactNormal1, &constraint.m_contactNormal2};
    const btVector3* angular[2] = {&constraint.m_relpos1CrossNormal, &constraint.m_relpos2CrossNormal};
    const int bodies[2] = {constraint.m_solverBodyIdA, constraint.m_solverBodyIdB};
    for (int side = 0; side < 2; ++side) {
      const int place = state_->place[static_cast<std::size_t>(bodies[side])];
      row.body[side] = place;
      if (place < 0) continue;
      row.jacobian[side] =
          six(*linear[side], *angular[side]).cwiseProduct(state_->moves[static_cast<std::size_t>(place)]);
    }
    // Bullet keeps targets and softness multiplied by the inverse of what bodies weigh against the row; a row that
    // nothing moves has none.
    const double inverse = static_cast<double>(constraint.m_jacDiagABInv);
    row.impulse = static_cast<double>(static_cast<btScalar>(constraint.m_appliedImpulse));
    row.lower = static_cast<double>(constraint.m_lowerLimit);
    row.upper = static_cast<double>(constraint.m_upperLimit);
    if (inverse > 0) {
      row.target = static_cast<double>(constraint.m_rhs) / inverse;
      row.softness = (static_cast<double>(constraint.m_cfm) + share) / inverse;
      if (first_contact < 0) row.of_changes = share / inverse;
    } else {
      row.body[0] = row.body[1] = -1;
      row.softness = 1;
      row.lower = row.upper = row.impulse;
    }
    if (first_contact >= 0) {
      row.normal = first_contact + constraint.m_frictionIndex;
      row.friction = static_cast<double>(constraint.m_friction);
    }
    state_->newton.rows.push_back(row);
  }
}

/// Impulses and what they change of velocities, as a sweep does it.
void StackSolver::hand_back(btConstraintArray& pool, std::size_t first) {
  for (int i = 0; i < pool.size(); ++i) {
    btSolverConstraint& constraint = pool[i];
    const btScalar impulse = static_cast<btScalar>(state_->newton.rows[first + static_cast<std::size_t>(i)].impulse);
    const btScalar change = impulse - static_cast<btScalar>(constraint.m_appliedImpulse);
    constraint.m_appliedImpulse = impulse;
    btSolverBody& a = m_tmpSolverBodyPool[constraint.m_solverBodyIdA];
    btSolverBody& b = m_tmpSolverBodyPool[constraint.m_solverBodyIdB];
    a.internalApplyImpulse(constraint.m_contactNormal1 * a.internalGetInvMass(), constraint.m_angularComponentA,
                           change);
    b.internalApplyImpulse(constraint.m_contactNormal2 * b.internalGetInvMass(), constraint.m_angularComponentB,
                           change);
  }
}

}  // namespace pd

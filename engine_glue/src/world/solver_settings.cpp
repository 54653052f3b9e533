#include "pd/bullet/solver_settings.hpp"

#include <BulletDynamics/ConstraintSolver/btContactSolverInfo.h>

#include <algorithm>

namespace pd {

void apply_recommended(btContactSolverInfo& info) {
  info.m_numIterations = 30;
  info.m_solverMode |= SOLVER_USE_2_FRICTION_DIRECTIONS | SOLVER_INTERLEAVE_CONTACT_AND_FRICTION_CONSTRAINTS;
  constexpr btScalar kNegligibleSpeed = btScalar(1e-7);
  info.m_leastSquaresResidualThreshold =
      std::max(info.m_leastSquaresResidualThreshold, kNegligibleSpeed * kNegligibleSpeed);
}

}  // namespace pd

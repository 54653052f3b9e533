#include "pd/bullet/solver_settings.hpp"

#include <BulletDynamics/ConstraintSolver/btContactSolverInfo.h>

namespace pd {

void apply_recommended(btContactSolverInfo& info) {
  info.m_numIterations = 30;
  info.m_solverMode |= SOLVER_USE_2_FRICTION_DIRECTIONS | SOLVER_INTERLEAVE_CONTACT_AND_FRICTION_CONSTRAINTS;
}

}  // namespace pd

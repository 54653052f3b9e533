#include "world/installation.hpp"

#include <memory>
#include <utility>

#include "union/compound_contacts.hpp"
#include "union/mesh_contacts.hpp"
#include "union/plane_contacts.hpp"

namespace pd::detail {

Installation::Installation(SolverCore& core, btCollisionDispatcher* dispatcher)
    : SolverInWorld(core, dispatcher),
      depth_solver_(*this),
      step_action_(*this),
      contacts_(*this, {ContactTable::contacts}),
      closest_(*this, {ContactTable::closest_points}),
      mesh_(*this, {mesh_contacts, false}),
      swapped_mesh_(*this, {mesh_contacts, true}),
      compound_(*this, {compound_contacts, false}),
      compound_on_plane_(*this, {plane_contacts, false}),
      swapped_compound_on_plane_(*this, {plane_contacts, true}),
      plane_(*this, {false}),
      swapped_plane_(*this, {true}),
      persistent_(&depth_solver_) {}

Installation* Installation::find(SolverCore& core, const btCollisionDispatcher* dispatcher) {
  return static_cast<Installation*>(core.find_world(dispatcher));  // no other kind is added
}

Installation& Installation::of(SolverCore& core, btCollisionDispatcher* dispatcher) {
  if (Installation* const known = find(core, dispatcher)) return *known;
  auto made = std::make_unique<Installation>(core, dispatcher);
  Installation& result = *made;
  core.add_world(std::move(made));
  return result;
}

bool Installation::DepthSolver::calcPenDepth(btSimplexSolverInterface& simplex, const btConvexShape* a,
                                             const btConvexShape* b, const btTransform& pose_a,
                                             const btTransform& pose_b, btVector3& v, btVector3& witness_a,
                                             btVector3& witness_b, btIDebugDraw* draw) {
  return installation_.core().calc_pen_depth(installation_.stamp(), simplex, a, b, pose_a, pose_b, v, witness_a,
                                             witness_b, draw);
}

void Installation::StepAction::updateAction(btCollisionWorld*, btScalar) { installation_.begin_step(); }

}  // namespace pd::detail

#include "world/installation.hpp"

#include <BulletCollision/CollisionDispatch/btCollisionConfiguration.h>
#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>
#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>

#include "pair/solver_core.hpp"
#include "union/compound_contacts.hpp"
#include "union/mesh_contacts.hpp"
#include "union/plane_contacts.hpp"

namespace pd::detail {

Installation::Installation(SolverCore& core, btCollisionDispatcher* dispatcher)
    : core_(core),
      dispatcher_(dispatcher),
      depth_solver_(*this),
      step_action_(*this),
      contacts_(*this, false),
      closest_(*this, true),
      mesh_(*this, mesh_contacts, false),
      swapped_mesh_(*this, mesh_contacts, true),
      compound_(*this, compound_contacts, false),
      compound_on_plane_(*this, plane_contacts, false),
      swapped_compound_on_plane_(*this, plane_contacts, true),
      plane_(*this, false),
      swapped_plane_(*this, true),
      persistent_(&depth_solver_) {}

bool Installation::takes(const btCollisionObjectWrapper& a, const btCollisionObjectWrapper& b) const {
  const BulletSolverSettings& settings = core_.settings;
  return !settings.takes_pair || settings.takes_pair(*a.getCollisionObject(), *b.getCollisionObject(), settings.user);
}

btCollisionAlgorithm* Installation::bullets_algorithm(btCollisionAlgorithmConstructionInfo& info,
                                                      const btCollisionObjectWrapper* a,
                                                      const btCollisionObjectWrapper* b) const {
  return dispatcher_->getCollisionConfiguration()
      ->getCollisionAlgorithmCreateFunc(a->getCollisionShape()->getShapeType(), b->getCollisionShape()->getShapeType())
      ->CreateCollisionAlgorithm(info, a, b);
}

bool Installation::DepthSolver::calcPenDepth(btSimplexSolverInterface& simplex, const btConvexShape* a,
                                             const btConvexShape* b, const btTransform& pose_a,
                                             const btTransform& pose_b, btVector3& v, btVector3& witness_a,
                                             btVector3& witness_b, btIDebugDraw* draw) {
  return installation_.core().calc_pen_depth(installation_.stamp(), simplex, a, b, pose_a, pose_b, v, witness_a,
                                             witness_b, draw);
}

void Installation::StepAction::updateAction(btCollisionWorld*, btScalar) {
  installation_.stamp_.store(installation_.core().next_stamp(), std::memory_order_relaxed);
}

}  // namespace pd::detail

#include "pair/solver_in_world.hpp"

#include <BulletCollision/CollisionDispatch/btCollisionConfiguration.h>
#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>

namespace pd::detail {

bool SolverInWorld::takes(const btCollisionObjectWrapper& a, const btCollisionObjectWrapper& b) const {
  const BulletSolverSettings& settings = core_.settings;
  return !settings.takes_pair || settings.takes_pair(*a.getCollisionObject(), *b.getCollisionObject(), settings.user);
}

btCollisionAlgorithm* SolverInWorld::bullets_algorithm(btCollisionAlgorithmConstructionInfo& info,
                                                       const btCollisionObjectWrapper* a,
                                                       const btCollisionObjectWrapper* b, ContactTable table) const {
  btCollisionConfiguration& own = *static_cast<btCollisionDispatcher*>(info.m_dispatcher1)->getCollisionConfiguration();
  const int type_a = a->getCollisionShape()->getShapeType(), type_b = b->getCollisionShape()->getShapeType();
  btCollisionAlgorithmCreateFunc* const create = table == ContactTable::contacts
                                                     ? own.getCollisionAlgorithmCreateFunc(type_a, type_b)
                                                     : own.getClosestPointsAlgorithmCreateFunc(type_a, type_b);
  return create->CreateCollisionAlgorithm(info, a, b);
}

}  // namespace pd::detail

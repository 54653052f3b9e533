#include "pd/bullet/install.hpp"

#include <BulletCollision/BroadphaseCollision/btBroadphaseProxy.h>
#include <BulletCollision/BroadphaseCollision/btOverlappingPairCache.h>
#include <BulletCollision/CollisionDispatch/btConvexConvexAlgorithm.h>

namespace pd {

void install(btCollisionDispatcher& dispatcher, BulletPenetrationDepthSolver& solver, BulletContacts contacts) {
  btCollisionAlgorithmCreateFunc* create =
      contacts == BulletContacts::one_shot ? solver.one_shot_create_func() : solver.persistent_create_func();
  for (int i = 0; i < MAX_BROADPHASE_COLLISION_TYPES; ++i) {
    for (int j = 0; j < MAX_BROADPHASE_COLLISION_TYPES; ++j) {
      if (btBroadphaseProxy::isConvex(i) && btBroadphaseProxy::isConvex(j)) {
        dispatcher.registerCollisionCreateFunc(i, j, create);
        dispatcher.registerClosestPointsCreateFunc(i, j, create);
      }
    }
  }
}

bool install(btCollisionWorld& world, BulletPenetrationDepthSolver& solver, BulletContacts contacts) {
  auto* dispatcher = dynamic_cast<btCollisionDispatcher*>(world.getDispatcher());
  if (dispatcher == nullptr) {
    return false;
  }
  install(*dispatcher, solver, contacts);
  btOverlappingPairCache* cache = world.getPairCache();
  btBroadphasePairArray& pairs = cache->getOverlappingPairArray();
  for (int i = 0; i < pairs.size(); ++i) {
    cache->cleanOverlappingPair(pairs[i], dispatcher);
  }
  return true;
}

void install(btDefaultCollisionConfiguration& configuration, BulletPenetrationDepthSolver& solver) {
  static_cast<btConvexConvexAlgorithm::CreateFunc*>(
      configuration.getCollisionAlgorithmCreateFunc(CONVEX_HULL_SHAPE_PROXYTYPE, CONVEX_HULL_SHAPE_PROXYTYPE))
      ->m_pdSolver = &solver;
}

}  // namespace pd

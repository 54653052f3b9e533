#include "pd/bullet/install.hpp"

#include <BulletCollision/BroadphaseCollision/btBroadphaseProxy.h>
#include <BulletCollision/BroadphaseCollision/btOverlappingPairCache.h>
#include <BulletCollision/CollisionDispatch/btConvexConvexAlgorithm.h>
#include <BulletDynamics/Dynamics/btDiscreteDynamicsWorld.h>

#include "union/mesh_contacts.hpp"
#include "world/installation.hpp"

namespace pd {

namespace {

template <class Visit>
void for_each_convex_pair(Visit&& visit) {
  for (int i = 0; i < MAX_BROADPHASE_COLLISION_TYPES; ++i) {
    for (int j = 0; j < MAX_BROADPHASE_COLLISION_TYPES; ++j) {
      if (btBroadphaseProxy::isConvex(i) && btBroadphaseProxy::isConvex(j)) {
        visit(i, j);
      }
    }
  }
}

/// Convex bodies and compounds against meshes and planes, in both orders.
template <class Visit>
void for_each_ground_pair(Visit&& visit) {
  for (int i = 0; i < MAX_BROADPHASE_COLLISION_TYPES; ++i) {
    for (int j = 0; j < MAX_BROADPHASE_COLLISION_TYPES; ++j) {
      const bool body = btBroadphaseProxy::isConvex(i) || btBroadphaseProxy::isCompound(i);
      if (body && (detail::takes_mesh(j) || j == STATIC_PLANE_PROXYTYPE)) {
        visit(i, j, 0);
        visit(j, i, 1);
      }
    }
  }
}

/// Compounds against convex bodies, in both orders, and against compounds.
template <class Visit>
void for_each_compound_pair(Visit&& visit) {
  for (int i = 0; i < MAX_BROADPHASE_COLLISION_TYPES; ++i) {
    if (btBroadphaseProxy::isConvex(i)) {
      visit(i, COMPOUND_SHAPE_PROXYTYPE);
      visit(COMPOUND_SHAPE_PROXYTYPE, i);
    }
  }
  visit(COMPOUND_SHAPE_PROXYTYPE, COMPOUND_SHAPE_PROXYTYPE);
}

/// Pairs lose their algorithms and get new ones, from the dispatcher's present tables, at the next step.
void renew_pairs(btCollisionWorld& world) {
  btOverlappingPairCache* cache = world.getPairCache();
  btBroadphasePairArray& pairs = cache->getOverlappingPairArray();
  for (int i = 0; i < pairs.size(); ++i) {
    cache->cleanOverlappingPair(pairs[i], world.getDispatcher());
  }
}

/// Has a dispatcher ask the solver.
/// @param installation  null: Bullet's own algorithms
void take_tables(btCollisionDispatcher& dispatcher, detail::Installation* installation, BulletContacts contacts) {
  btCollisionConfiguration& bullets = *dispatcher.getCollisionConfiguration();
  const bool ours = installation != nullptr, whole = ours && contacts == BulletContacts::one_shot;
  const auto take_contacts = [&](int i, int j, btCollisionAlgorithmCreateFunc* create) {
    dispatcher.registerCollisionCreateFunc(i, j, create ? create : bullets.getCollisionAlgorithmCreateFunc(i, j));
  };
  const auto take_closest = [&](int i, int j, btCollisionAlgorithmCreateFunc* create) {
    dispatcher.registerClosestPointsCreateFunc(i, j,
                                               create ? create : bullets.getClosestPointsAlgorithmCreateFunc(i, j));
  };
  for_each_convex_pair([&](int i, int j) {
    btCollisionAlgorithmCreateFunc* const persistent = ours ? &installation->persistent : nullptr;
    take_contacts(i, j, whole ? &installation->contacts : persistent);
    take_closest(i, j, whole ? &installation->closest : persistent);
  });
  for_each_ground_pair([&](int i, int j, int swapped) {
    const auto choose = [&]() -> btCollisionAlgorithmCreateFunc* {
      if (!whole) return nullptr;
      if ((swapped != 0 ? i : j) != STATIC_PLANE_PROXYTYPE) return &installation->mesh[swapped];
      if (btBroadphaseProxy::isCompound(swapped != 0 ? j : i)) return &installation->compound_on_plane[swapped];
      return &installation->plane[swapped];
    };
    take_contacts(i, j, choose());
  });
  for_each_compound_pair([&](int i, int j) {
    take_contacts(i, j, whole ? &installation->compound : nullptr);
    take_closest(i, j, whole ? &installation->compound_query : nullptr);
  });
}

/// Bullet offers a world's actions to derived classes only.
class ActionsOfWorld : private btDiscreteDynamicsWorld {
 public:
  ActionsOfWorld() = delete;

  /// Takes out those of all solvers.
  static void remove_ours(btDiscreteDynamicsWorld& world) {
    btAlignedObjectArray<btActionInterface*>& actions = world.*(&ActionsOfWorld::m_actions);
    for (int i = actions.size() - 1; i >= 0; --i) {
      if (auto* const ours = dynamic_cast<detail::Installation*>(actions[i])) world.removeAction(ours);
    }
  }
};

/// Reads the tables of a dispatcher, which Bullet keeps protected.
class TablesOfDispatcher : private btCollisionDispatcher {
 public:
  TablesOfDispatcher() = delete;

  /// True if a pair of convex shapes still gets its algorithm from the installation.
  static bool point_to(const btCollisionDispatcher& dispatcher, const detail::Installation& installation) {
    const auto& table = dispatcher.*(&TablesOfDispatcher::m_doubleDispatchContactPoints);
    bool found = false;
    for_each_convex_pair([&](int i, int j) {
      found = found || table[i][j] == &installation.contacts || table[i][j] == &installation.persistent;
    });
    return found;
  }
};

}  // namespace

void install(btCollisionDispatcher& dispatcher, BulletPenetrationDepthSolver& solver, BulletContacts contacts) {
  take_tables(dispatcher, &detail::Installation::of_others(solver.core()), contacts);
}

bool install(btCollisionWorld& world, BulletPenetrationDepthSolver& solver, BulletContacts contacts) {
  auto* dispatcher = dynamic_cast<btCollisionDispatcher*>(world.getDispatcher());
  if (dispatcher == nullptr) return false;
  if (auto* dynamics = dynamic_cast<btDiscreteDynamicsWorld*>(&world)) {
    detail::Installation& installation = detail::Installation::of_world(solver.core(), dispatcher);
    take_tables(*dispatcher, &installation, contacts);
    ActionsOfWorld::remove_ours(*dynamics);  // of an earlier installation, if there was one
    dynamics->addAction(&installation);
    detail::SolverInWorld::mark_between_steps(world);
  } else {
    install(*dispatcher, solver, contacts);
  }
  renew_pairs(world);
  return true;
}

bool uninstall(btCollisionWorld& world, BulletPenetrationDepthSolver& solver) {
  auto* dispatcher = dynamic_cast<btCollisionDispatcher*>(world.getDispatcher());
  if (dispatcher == nullptr) return false;
  detail::SolverCore& core = solver.core();
  if (!core.installed()) return false;
  if (!TablesOfDispatcher::point_to(*dispatcher, detail::Installation::of_world(core, dispatcher)) &&
      !TablesOfDispatcher::point_to(*dispatcher, detail::Installation::of_others(core))) {
    return false;
  }
  if (auto* dynamics = dynamic_cast<btDiscreteDynamicsWorld*>(&world)) ActionsOfWorld::remove_ours(*dynamics);
  take_tables(*dispatcher, nullptr, BulletContacts::one_shot);
  renew_pairs(world);
  return true;
}

bool install(btCollisionConfiguration& configuration, BulletPenetrationDepthSolver& solver) {
  auto* general = dynamic_cast<btConvexConvexAlgorithm::CreateFunc*>(
      configuration.getCollisionAlgorithmCreateFunc(CONVEX_HULL_SHAPE_PROXYTYPE, CONVEX_HULL_SHAPE_PROXYTYPE));
  if (general == nullptr) {
    return false;
  }
  general->m_pdSolver = &detail::Installation::of_others(solver.core());
  return true;
}

}  // namespace pd

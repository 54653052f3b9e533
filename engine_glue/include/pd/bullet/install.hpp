/// @file
/// The one line that hands a Bullet world's contacts to pdepth.
#pragma once

#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>
#include <BulletCollision/CollisionDispatch/btCollisionWorld.h>
#include <BulletCollision/CollisionDispatch/btDefaultCollisionConfiguration.h>

#include "pd/bullet/penetration_depth_solver.hpp"

namespace pd {

enum class BulletContacts {
  one_shot,    ///< our contact algorithm: exact signed distance always, up to four points from the first step
  persistent,  ///< Bullet's convex-convex algorithm (GJK, one point a step) with our solver for what penetrates
};

/// Every pair of convex shapes of the world, in both of the dispatcher's tables: box/box, sphere and capsule pairs, the
/// convex children of compounds, and the triangles of meshes and heightfields included. Works at any time, also between
/// steps: pairs that have an algorithm already lose it and get a new one (with their contact points) at the next step.
///
/// Not covered, because Bullet decides without asking the tables: convex against `btStaticPlaneShape` (Bullet's support
/// in the plane's direction, which is exact up to rounding), soft bodies, ray and sweep queries (`convexSweepTest`; use
/// `pd::time_of_impact`), and `btGImpactMeshShape` against itself. Create functions that the host registers later win.
///
/// @return false, and nothing changed, where the world's dispatcher is not a btCollisionDispatcher.
/// Requires: the solver outlives the world.
bool install(btCollisionWorld& world, BulletPenetrationDepthSolver& solver,
             BulletContacts contacts = BulletContacts::one_shot);

/// The same for a dispatcher that has no world yet.
void install(btCollisionDispatcher& dispatcher, BulletPenetrationDepthSolver& solver,
             BulletContacts contacts = BulletContacts::one_shot);

/// Only exchanges the penetration solver of Bullet's convex-convex algorithm, before a dispatcher is made from the
/// configuration: for hosts that build their world elsewhere. Pairs with an algorithm of their own (box/box,
/// sphere/sphere, sphere/triangle) do not ask it.
void install(btDefaultCollisionConfiguration& configuration, BulletPenetrationDepthSolver& solver);

}  // namespace pd

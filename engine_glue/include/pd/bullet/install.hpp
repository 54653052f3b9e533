/// @file
/// The one line that hands a Bullet world's contacts to pdepth.
#pragma once

#include <BulletCollision/CollisionDispatch/btCollisionConfiguration.h>
#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>
#include <BulletCollision/CollisionDispatch/btCollisionWorld.h>

#include "pd/bullet/penetration_depth_solver.hpp"

namespace pd {

enum class BulletContacts {
  one_shot,    ///< our contact algorithm: exact signed distance always, up to four points from the first step
  persistent,  ///< Bullet's convex-convex algorithm (GJK, one point a step) with our solver for what penetrates
};

/// Takes every pair of convex shapes of the world, in both of the dispatcher's tables: box/box, sphere and capsule
/// pairs included. With `one_shot` it also takes, in the table of contacts, every convex shape and compound against a
/// mesh, heightfield or `btStaticPlaneShape`. All contact points on a plane are there from the first step. Works at any
/// time, also between steps: pairs that have an algorithm already lose it and get a new one (with their contact points)
/// at the next step.
///
/// Not covered, because Bullet decides without asking the tables: soft bodies, ray and sweep queries
/// (`convexSweepTest`; use `pd::sweep_test`), and `btGImpactMeshShape` against itself. Create functions that the
/// host registers later win.
///
/// How shapes and their margins are taken ("inside" as in shape_conversion.hpp):
///
/// | pair | one_shot | persistent |
/// |---|---|---|
/// | two btBoxShapes | sharp, full half extents, as Bullet's own box/box | rounded: the margin lies inside |
/// | btBoxShape and a plane, which has no margin | sharp | sharp (Bullet's own algorithm) |
/// | btBoxShape and anything else; cylinders | rounded by the margin, which lies inside | the same |
/// | hulls, point clouds, triangles, cones | rounded by the margin, which lies outside | the same |
/// | spheres, capsules, multispheres | exact; the margin is the (least) radius | the same |
///
/// Meshes, heightfields and compounds are one body each (one_shot; `BulletSolverSettings::unions_as_one`). A contact
/// with an edge or face may be covered by other triangles or children, as far as the bodies move in a step. Such a
/// contact is dropped, or turned to the nearest facet of its piece that is not covered. Compounds that are deep in each
/// other leave by the shortest way of the whole, within a budget. Flush children, seams that meet up to 1e-7 and
/// T-junctions are flat; steps, valleys and corners keep every wall. Children of compounds are btBoxShapes without
/// margin there: rounded, flush boxes would have grooves between them. Separate bodies that lie flush, and children
/// without flat faces, are not looked at. Contacts of a mesh, heightfield (of triangles; not GImpact or SDF) or
/// compound (of convex children with exact form) are chosen from all its pieces together. There are up to four for each
/// of up to eight directions, each direction in a manifold of its own. They begin at the breaking threshold from the
/// surface, margins included. Triangles without area or with corners that are no numbers are left out and counted;
/// `pd::check_mesh` (mesh_check.hpp) finds them, and what Bullet would read past, beforehand.
///
/// A world that steps (btDynamicsWorld) gets an action (`addAction`) that tells the solver when a step has ended;
/// shapes are compared with what they were converted from once a step (shape_cache.hpp). The action takes
/// `btDispatcherInfo::m_stepCount`, which Bullet sets to 0 in each step and never reads, to mark the time between
/// steps. A solver that was installed before gives way to this one.
///
/// Requires that the world is not stepping. Time O(pairs) in the world's pairs that overlap.
/// @return false, and nothing changed, if the world's dispatcher is not a btCollisionDispatcher.
bool install(btCollisionWorld& world, BulletPenetrationDepthSolver& solver,
             BulletContacts contacts = BulletContacts::one_shot);

/// Installs the solver in a dispatcher that has no world yet. Shapes are then compared at every pair.
void install(btCollisionDispatcher& dispatcher, BulletPenetrationDepthSolver& solver,
             BulletContacts contacts = BulletContacts::one_shot);

/// Gives every pair that `install` took (convex shapes, planes, meshes, compounds) back to the algorithms of the
/// dispatcher's own configuration (not to create functions that the host had registered before). Contacts are found
/// again at the next step.
/// @return false, and nothing changed, where the solver is not installed in this world's dispatcher.
bool uninstall(btCollisionWorld& world, BulletPenetrationDepthSolver& solver);

/// The counts of `prepare`.
struct PreparedShapes {
  int shapes = 0;        ///< convex shapes of the world's bodies, children of compounds included, each counted once
  int without_form = 0;  ///< of those: shapes that `to_convex_shape` refuses, which Bullet's own solver answers
};

/// Converts the shapes of a world ahead of its first step, in which hulls of many points would take most of the time.
/// In a world of multibodies it also has Bullet's constraint solver reserve its memory, which otherwise grows row by
/// row. The solver need not be installed yet. Shapes that are added or changed later are converted when they first meet
/// another body, as ever.
PreparedShapes prepare(btCollisionWorld& world, BulletPenetrationDepthSolver& solver);

/// Only exchanges the penetration solver of Bullet's convex-convex algorithm, before a dispatcher is made from the
/// configuration: for hosts that build their world elsewhere. Pairs with an algorithm of their own (box/box,
/// sphere/sphere, sphere/triangle) do not ask it.
/// @return false, and nothing changed, where the configuration answers pairs of hulls by an algorithm that is not
/// Bullet's.
bool install(btCollisionConfiguration& configuration, BulletPenetrationDepthSolver& solver);

}  // namespace pd

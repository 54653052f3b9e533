/// @file
/// A world of plain data (scenes/worlds.hpp) in Bullet, under one of several ways to find contacts.
#pragma once

#include <BulletCollision/CollisionShapes/btTriangleInfoMap.h>
#include <btBulletDynamicsCommon.h>

#include <memory>
#include <string_view>
#include <vector>

#include "pd/bullet/penetration_depth_solver.hpp"
#include "pd/bullet/stack_solver.hpp"
#include "scenes/worlds.hpp"

namespace pd::scenes {

/// How contacts are found.
enum class ContactRun {
  bullet_best,   ///< Bullet as shipped, boxes as btBoxShape, default margins inside the bodies
  bullet_sharp,  ///< the same with margin 0
  bullet_hulls,  ///< boxes as hulls, with default margins
  bullet_edges,  ///< Bullet as shipped, and its internal edge utility on meshes and heightfields
  persistent,    ///< Bullet's persistent manifolds, our depth; margin 0
  pdepth,        ///< our contact algorithm; boxes with default margins, hulls with margin 0
  pdepth_hulls,  ///< the same, boxes as hulls with margin 0
  pdepth_sharp,  ///< the same, boxes with margin 0; as bodies are drawn, so for the demos (not among `kContactRuns`)
};
inline constexpr ContactRun kContactRuns[] = {
    ContactRun::bullet_best, ContactRun::bullet_sharp, ContactRun::bullet_hulls, ContactRun::bullet_edges,
    ContactRun::persistent,  ContactRun::pdepth,       ContactRun::pdepth_hulls};
[[nodiscard]] std::string_view to_string(ContactRun run);
[[nodiscard]] constexpr bool is_ours(ContactRun run) {
  return run == ContactRun::persistent || run == ContactRun::pdepth || run == ContactRun::pdepth_hulls ||
         run == ContactRun::pdepth_sharp;
}

/// A convex body without children as a Bullet shape. A margin lies inside the body: hulls are shrunk by it first.
[[nodiscard]] std::unique_ptr<btConvexShape> convex_bullet_shape(const WorldBody& body, bool boxes_as_hulls,
                                                                 double margin);

/// Owns everything of one Bullet world. Sleeping is off; solver settings are Bullet's defaults.
class BulletScene {
 public:
  BulletScene(const World& world, ContactRun run, const BulletSolverSettings& settings = {});
  ~BulletScene();
  BulletScene(const BulletScene&) = delete;
  BulletScene& operator=(const BulletScene&) = delete;

  void step(double steps_per_second);

  [[nodiscard]] btDiscreteDynamicsWorld& world() { return *world_; }
  [[nodiscard]] btCollisionDispatcher& dispatcher() { return dispatcher_; }
  [[nodiscard]] btDefaultCollisionConfiguration& configuration() { return configuration_; }
  [[nodiscard]] BulletPenetrationDepthSolver& solver() { return solver_; }
  [[nodiscard]] int num_bodies() const { return static_cast<int>(bodies_.size()); }
  [[nodiscard]] btRigidBody& body(int i) { return *bodies_[i]; }
  [[nodiscard]] const WorldBody& plan(int i) const { return plan_.bodies[i]; }
  [[nodiscard]] const World& plan() const { return plan_; }
  /// The first body that can move.
  [[nodiscard]] int first_moving() const;

 private:
  btCollisionShape* make_shape(const WorldBody& body, ContactRun run);
  void add_body(const WorldBody& body, ContactRun run);

  World plan_;
  BulletPenetrationDepthSolver solver_;
  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_;
  btDbvtBroadphase broadphase_;
  std::unique_ptr<btSequentialImpulseConstraintSolver> constraint_solver_;
  std::unique_ptr<btDiscreteDynamicsWorld> world_;
  std::vector<std::unique_ptr<btCollisionShape>> shapes_;
  std::vector<std::unique_ptr<btTriangleMesh>> meshes_;
  std::vector<std::unique_ptr<btTriangleInfoMap>> edge_maps_;  ///< of bullet_edges
  std::vector<std::unique_ptr<std::vector<btScalar>>> heights_;
  std::vector<std::unique_ptr<btRigidBody>> bodies_;
  std::vector<std::unique_ptr<btTypedConstraint>> joints_;
};

/// Energy of all bodies that move, in J.
struct MechanicalEnergy {
  double kinetic = 0;    ///< of moving and turning
  double potential = 0;  ///< in the field of gravity, from the origin
  [[nodiscard]] double total() const { return kinetic + potential; }
};
[[nodiscard]] MechanicalEnergy mechanical_energy(BulletScene& scene);

}  // namespace pd::scenes

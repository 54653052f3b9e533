/// @file
/// A world of scenes/worlds.hpp in Bullet, under one of four solvers, with measurements that no solver makes for
/// itself: penetration is measured by pd_core on the true poses of the bodies' convex pieces, whoever moved them.
#pragma once

#include <memory>
#include <string_view>
#include <vector>

#include "pd/bullet/penetration_depth_solver.hpp"
#include "pd/depth/depth_answer.hpp"
#include "pd/numeric/expected.hpp"
#include "pd/render/scene.hpp"
#include "scenes/worlds.hpp"

class btDiscreteDynamicsWorld;
class btRigidBody;

namespace pd::demo {

enum class SolverKind {
  exact,             ///< pdepth, exact, whole manifolds
  approximate,       ///< pdepth, within 1 %, whole manifolds
  bullet_epa,        ///< Bullet as shipped: GJK and EPA
  bullet_minkowski,  ///< Bullet with its sampling solver
};

/// The words of `--solver`. @return ErrorCode::bad_value with the words that there are.
[[nodiscard]] Expected<SolverKind> solver_kind(std::string_view word);
[[nodiscard]] std::string_view to_string(SolverKind kind);
/// For headings: "pdepth, exact".
[[nodiscard]] std::string_view describe(SolverKind kind);

/// What one step left behind. SI units.
struct Measurement {
  double deepest = 0;      ///< largest exact penetration depth over all pairs
  double total_depth = 0;  ///< sum over all pairs
  double drift = 0;        ///< largest way of a body from its start
  double kinetic_energy = 0;
  double potential_energy = 0;
  double forward_speed = 0;  ///< of the first moving body, along x
  int contacts = 0;          ///< Bullet's contact points
  int overlapping_pairs = 0;
  std::int64_t solver_calls = 0;   ///< in this step
  double solver_microseconds = 0;  ///< in this step
  double step_microseconds = 0;    ///< wall clock of Bullet's step
  int deepest_a = -1;              ///< bodies of the deepest pair, -1 without overlap
  int deepest_b = -1;
  std::shared_ptr<const ConvexShape> deepest_piece_a;  ///< of their bodies, posed
  std::shared_ptr<const ConvexShape> deepest_piece_b;
  Pose deepest_pose_a;
  Pose deepest_pose_b;
  PenetrationDepth deepest_answer;
};

/// A contact that leans against the way of the body that it holds.
struct Ghost {
  Vec3 point;
  Vec3 normal;  ///< out of the ground, unit
};

class DemoWorld {
 public:
  DemoWorld(const scenes::World& world, SolverKind kind);
  ~DemoWorld();
  DemoWorld(const DemoWorld&) = delete;
  DemoWorld& operator=(const DemoWorld&) = delete;

  /// One step of the world's own length, measured.
  Measurement step();
  /// The present state, without stepping (solver and step figures 0).
  [[nodiscard]] Measurement measure();

  /// The bodies where they are, for a picture; the deepest pair of `measurement` is highlighted when it is deeper than
  /// `shown_depth`.
  [[nodiscard]] render::Scene picture(const Measurement& measurement, double shown_depth) const;

  /// Contacts of the first moving body that lean against its way by more than a degree and push.
  [[nodiscard]] std::vector<Ghost> ghosts();

  [[nodiscard]] btDiscreteDynamicsWorld& bullet();
  /// The solver that is installed; for the Bullet kinds one that is not, with its cache of shapes.
  [[nodiscard]] BulletPenetrationDepthSolver& solver();
  [[nodiscard]] int num_bodies() const;
  [[nodiscard]] btRigidBody& body(int i);
  /// Requires: the body is convex.
  [[nodiscard]] const ConvexShape& shape(int i) const;
  [[nodiscard]] const scenes::WorldBody& description(int i) const;
  /// Index of a body, -1 when it is none of them.
  [[nodiscard]] int index_of(const void* collision_object) const;

 private:
  struct State;
  void measure_depths(Measurement& result);
  std::unique_ptr<State> state_;
};

}  // namespace pd::demo

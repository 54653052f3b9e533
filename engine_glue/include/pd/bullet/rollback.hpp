/// @file
/// Steps that end at the first contact instead of inside it.
///
/// Bullet looks for contacts at the start of a step and then moves; fast bodies end the step deep inside each other, or
/// past each other, and no contact tells. Here a step is tried, the motion that it made is searched for first contacts
/// (`time_of_impact`), and where there is one the state is restored and advanced to just before it; Bullet then meets
/// the pair at distance about 0 and answers with its own impulse. The rest of the step follows the same way.
#pragma once

#include <vector>

#include "pd/bullet/penetration_depth_solver.hpp"
#include "pd/bullet/snapshot.hpp"
#include "pd/depth/depth_answer.hpp"
#include "pd/depth/scratch.hpp"

namespace pd {

struct RollbackSettings {
  /// The gap left at a first contact, > 0, in the world's unit. Floats cannot place a body finer than about 1e-7 of its
  /// coordinates.
  double gap = 1e-5;
  /// Pairs in contact already may sink by this share of the smaller body's radius before the step is cut there too:
  /// after a corner hits, a fast body still turns its other corners through the wall.
  double contact_depth_share = 0.02;
  /// Trials of a shorter step for one contact.
  int max_trials = 24;
  /// Cuts of one step; what is left of the step is then made in one piece (a ball that comes
  /// to rest bounces without end in finite time).
  int max_contacts_per_step = 64;
};

/// One first contact.
struct FirstContact {
  const btCollisionObject* body_a = nullptr;
  const btCollisionObject* body_b = nullptr;
  double time = 0;  ///< since the step began
  double gap = 0;   ///< signed distance left, as measured at the pose that Bullet reached
  double undone_depth =
      0;           ///< how deep the pair was at the end of the step that was taken back (0: it had passed through)
  int trials = 0;  ///< shorter steps tried
  PenetrationDepth contact;  ///< at that pose
};

struct RollbackReport {
  std::vector<FirstContact> contacts;  ///< in order of time
  int deepened = 0;                    ///< cuts of the step at pairs in contact that went deeper than they may
  int simulation_steps = 0;            ///< calls of stepSimulation, trials included
  bool bounded = false;                ///< max_contacts_per_step was reached
};

class RollbackStepper {
 public:
  /// @param solver  installed in the world. World and solver must outlive the stepper.
  RollbackStepper(btDiscreteDynamicsWorld& world, BulletPenetrationDepthSolver& solver,
                  const RollbackSettings& settings = {});

  /// Advances the world by `step` > 0 seconds, stopping at first contacts on the way.
  ///
  /// Pairs whose bodies are convex or compounds of convex children are watched, unless they are in contact (nearer than
  /// twice the gap) when the search begins: those are Bullet's resting contacts. Planes, meshes and heightfields are
  /// left to Bullet. Time: one collision query or more for each pair whose swept spheres meet; O(parts^2) sphere tests.
  RollbackReport step(btScalar step);

 private:
  struct Part;
  struct Impact;

  void collect_parts();
  void remember_start_poses();
  /// The earliest first contact of the motion since `remember_start_poses`, within `duration`.
  bool earliest_impact(double duration, Impact& impact);
  FirstContact advance_to(const Impact& impact, const BulletSnapshot& start, double duration, RollbackReport& report);

  btDiscreteDynamicsWorld& world_;
  BulletPenetrationDepthSolver& solver_;
  RollbackSettings settings_;
  std::vector<Part> parts_;
  Scratch scratch_;

 public:
  ~RollbackStepper();
};

}  // namespace pd

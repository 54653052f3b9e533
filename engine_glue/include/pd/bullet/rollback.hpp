/// @file
/// Steps that end at the first contact instead of inside it.
///
/// Bullet looks for contacts at the start of a step and then moves; fast bodies end the step deep inside each other, or
/// past each other, and no contact tells. Here a step is tried, and the motion that it made is searched for first
/// contacts (`time_of_impact`). If there is one, the state is restored and advanced to just before it. Bullet then
/// meets the pair at distance about 0 and answers with its own impulse. The rest of the step follows in the same way.
///
/// Watched are convex shapes, compounds, meshes, heightfields and planes (their triangles that a swept box meets),
/// kinematic bodies (moved by their share) and links of multibodies. Soft bodies, and shapes that `to_convex_shape`
/// refuses, are not watched.
///
/// What others see: motion states, tick callbacks and actions (vehicles, character controllers) see accepted states
/// only. The pre-tick callback is called once for each accepted part of a step, before it, with the time that is left;
/// actions, and then the tick callback, after it, with its length. What an action moves itself is not searched: the
/// next part begins there. Trials are full steps of Bullet otherwise: contact callbacks run in them, and what they keep
/// outside of the world's state is theirs to undo. Forces and torques applied before a step act through all its parts.
#pragma once

#include <LinearMath/btAlignedObjectArray.h>

#include "pd/bullet/penetration_depth_solver.hpp"
#include "pd/bullet/snapshot.hpp"

namespace pd {

/// A number that is outside of its range, or NaN, is taken as the default.
struct RollbackSettings {
  /// The gap left at a first contact, > 0 and finite, in the world's unit; pairs that Bullet brakes may have 2.25 gaps
  /// left. Floats cannot place a body finer than about 1e-7 of its coordinates.
  double gap = 1e-5;
  /// Pairs in contact already may sink by this length, >= 0 and finite, before the step is cut there too: after a
  /// corner hits, a fast body still turns its other corners through the wall. After it, a quarter of it a part. Pairs
  /// that move by less in a step that nothing cuts are not searched.
  double contact_slop = 5e-4;
  /// Trials of a shorter step for one contact.
  int max_trials = 24;
  /// Cuts of one step; what is left of the step is then made in one piece (a ball that comes
  /// to rest bounces without end in finite time).
  int max_contacts_per_step = 64;
  /// The least part of a step, as a share of it in [0, 1]: a contact nearer than that is run into, by at most the
  /// relative speed times that part.
  double least_part = 1.0 / 4096;
  /// True: bodies that no contact and no joint touches in a step, or in a part of it, move by the law of free flight.
  /// They follow the parabola of the forces on them, and turn as a body without torque does. Bullet's own steps are
  /// the first order of this motion (`src/rollback/free_flight.hpp`). A ball that is dropped is g h^2 / 2 a step above
  /// Bullet's ball, for steps of h, and comes back to its height. False: Bullet's own motion throughout.
  bool exact_flight = true;
};

/// One first contact.
struct FirstContact {
  const btCollisionObject* body_a = nullptr;
  const btCollisionObject* body_b = nullptr;
  double time = 0;  ///< since the step began
  double gap = 0;   ///< signed distance left, as measured at the pose that Bullet reached
  /// How deep the pair was at the end of the step that was taken back; 0 where it had passed through.
  double undone_depth = 0;
  int trials = 0;  ///< shorter steps tried
  /// At that pose, in the world: the unit direction in which A leaves B, and the point of each body nearest to the
  /// other.
  btVector3 normal = {0, 0, 0}, point_a = {0, 0, 0}, point_b = {0, 0, 0};
};

/// Bullet's array, which its headers bring along (`<vector>`, `<memory>` would double what a host parses), as a range.
struct FirstContacts : btAlignedObjectArray<FirstContact> {
  [[nodiscard]] const FirstContact* begin() const { return size() > 0 ? &(*this)[0] : nullptr; }
  [[nodiscard]] const FirstContact* end() const { return begin() + size(); }
};

struct RollbackReport {
  FirstContacts contacts;     ///< in order of time
  int deepened = 0;           ///< cuts of the step at pairs in contact that went deeper than they may
  int least_parts = 0;        ///< parts of the least length, within which a contact may have been run into
  double deepest_run_in = 0;  ///< how deep the pairs were that those parts were about
  int parts = 0;              ///< accepted parts of the step
  int simulation_steps = 0;   ///< Bullet's steps, trials included
  bool bounded = false;       ///< max_contacts_per_step was reached
};

class RollbackStepper {
 public:
  /// @param solver  installed in the world. World and solver must outlive the stepper.
  RollbackStepper(btDiscreteDynamicsWorld& world, BulletPenetrationDepthSolver& solver,
                  const RollbackSettings& settings = {});
  ~RollbackStepper();
  RollbackStepper(const RollbackStepper&) = delete;
  RollbackStepper& operator=(const RollbackStepper&) = delete;

  /// Advances the world by `step` > 0 seconds, stopping at first contacts on the way. It stands in place of
  /// `stepSimulation(step, 0)`, which it equals bit for bit where nothing meets and nothing is in flight, or
  /// `exact_flight` is off.
  ///
  /// After it no pair is deeper than max(1e-6 of the smaller body's diameter, 4 units in the last place of its
  /// coordinates) that was apart whenever a part of the step began. Pairs in contact then (nearer than 2.25 gaps) are
  /// Bullet's, and at most 2 `contact_slop` deeper than when the step began, or than 0. Excepted are steps that report
  /// `least_parts` (up to the relative speed times such a part) or `bounded` (their rest is made in one piece). In
  /// 180,000 steps of random rooms one of 8.4 million pairs was deeper for another reason, by 0.00002 m
  /// (`rollback_law`).
  ///
  /// Parts of a step add no energy of their own: Bullet's corrections, warm starts and gaps are taken per unit of
  /// time (`src/rollback/substep.hpp`). Where friction with restitution would add energy, as Bullet's law of
  /// impact allows, the impact has so much less restitution that it does not (`src/rollback/impact_energy.hpp`). Time:
  /// Bullet's own for each simulation step; pairs with a mesh or compound are asked once a part. A snapshot a part. A
  /// collision query or more for each pair whose swept boxes meet and that moves by more than the slop (in steps that
  /// are cut: 2.25 gaps).
  RollbackReport step(btScalar step);

  /// Advances like `stepSimulation(time, max_steps, fixed)`: as many steps of `fixed` seconds as are due, at most
  /// `max_steps`, and motion states moved on by the remainder, which is kept for the next call. With 0 for `max_steps`
  /// it is `step(time)`. The report sums up all steps; times of contacts count from the first.
  RollbackReport step(btScalar time, int max_steps, btScalar fixed);

 private:
  struct State;
  State* state_;  ///< owned
};

}  // namespace pd

#include "pd/bullet/rollback.hpp"

#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <memory>
#include <utility>

#include "pair/solver_core.hpp"
#include "pd/bullet/scalar.hpp"
#include "rollback/impact_search.hpp"
#include "rollback/substep.hpp"
#include "rollback/world_objects.hpp"
#include "rollback/world_step.hpp"

namespace pd {

namespace {

/// The settings, each number that is outside of its range as by default.
RollbackSettings in_their_ranges(RollbackSettings chosen) {
  const RollbackSettings usual;
  if (!(chosen.gap > 0 && std::isfinite(chosen.gap))) chosen.gap = usual.gap;
  if (!(chosen.contact_slop >= 0 && std::isfinite(chosen.contact_slop))) chosen.contact_slop = usual.contact_slop;
  if (!(chosen.least_part >= 0 && chosen.least_part <= 1)) chosen.least_part = usual.least_part;
  return chosen;
}

/// Of a point of a body that moves as it does at present, at the pose given.
Vec3 velocity_at(const btCollisionObject& object, const btTransform& pose, const Vec3& point) {
  const btRigidBody* body = btRigidBody::upcast(&object);
  if (body == nullptr || body->isStaticObject()) {
    return Vec3::Zero();
  }
  const Vec3 arm = point - to_pd(pose.getOrigin());
  return to_pd(body->getLinearVelocity()) + to_pd(body->getAngularVelocity()).cross(arm);
}

/// Of the point of B nearest to A against that of A: along the contact's normal it is positive where they approach.
Vec3 approach(const detail::FoundImpact& impact, const btTransform& a, const btTransform& b,
              const PenetrationDepth& contact) {
  return velocity_at(*impact.b.body, b, contact.witness_b) - velocity_at(*impact.a.body, a, contact.witness_a);
}

Vec3 approach(const detail::FoundImpact& impact, const PenetrationDepth& contact) {
  return approach(impact, impact.a.body->getWorldTransform(), impact.b.body->getWorldTransform(), contact);
}

/// What is left of a step below this share of it is rounding, no part.
constexpr double kNothingLeft = 1e-6;
/// Steps of Newton's method before a trial; its speeds are those at the trial's end, so that it converges by a factor.
constexpr int kMostForeseen = 8;
/// A pair in contact that deepens ends a part when it has this share of the slop left, or less.
constexpr double kDeepEnough = 0.4;
/// The shortest trial that `TrialEnd::before` proposes, as a share of the trial before it.
constexpr double kLeastShare = 1.0 / 16;
/// Trials for one contact after which one that meets nothing is taken for a part of its own: what stands in their way
/// (motions that jump between two lengths of a part, contacts that brake each other) looks different from nearer by.
constexpr int kPatience = 4;

/// The clearance that a trial left to a pair at its end.
struct TrialEnd {
  const btCollisionObject* a;
  const btCollisionObject* b;
  double time;
  double clearance;

  TrialEnd(const detail::FoundImpact& impact, double at, double left)
      : a(impact.a.body), b(impact.b.body), time(at), clearance(left) {}

  /// Estimates the length of a trial that leaves `wanted` from this trial and a shorter one of the pair that left more.
  /// A longer trial brings a pair that Bullet brakes deeper, and its motion says nothing about a shorter trial.
  /// @return HUGE_VAL if the two trials do not say
  [[nodiscard]] double before(const TrialEnd& shorter, double wanted) const {
    if (a != shorter.a || b != shorter.b || !(shorter.time < time && shorter.clearance > clearance)) return HUGE_VAL;
    const double rise = (shorter.clearance - clearance) / (time - shorter.time);
    return std::max(shorter.time - (wanted - shorter.clearance) / rise, kLeastShare * shorter.time);
  }
};

}  // namespace

struct RollbackStepper::State {
  btDiscreteDynamicsWorld& world;
  BulletPenetrationDepthSolver& solver;
  RollbackSettings settings;
  detail::ImpactSearch search;
  detail::SubStepper parts;
  detail::WorldObjects objects;
  std::unique_ptr<BulletSnapshot> start;
  bool is_cut = false;        ///< the present part is not the frame's first
  int unrecorded_trials = 0;  ///< of parts that ended before the contact that they were about
  btScalar owed = 0;          ///< time of fixed steps that is not due yet

  State(btDiscreteDynamicsWorld& w, BulletPenetrationDepthSolver& s, const RollbackSettings& chosen)
      : world(w), solver(s), settings(chosen), search(w, s), parts(w, chosen.exact_flight) {}

  void save() {
    if (start) {
      start->save_again();
    } else {
      start = std::make_unique<BulletSnapshot>(world, &solver);
    }
  }

  /// The state at which the present part began. Bullet lets nobody add or remove objects within a step, in which the
  /// objects were the saved ones.
  void take_back() const {
    [[maybe_unused]] const Restored back = start->restore();
    assert(back == Restored::yes);
  }

  /// Forgets what the host's callbacks and actions have taken out of the world since the frame began.
  void follow_objects() {
    if (objects.same(world, detail::WorldObjects::Shapes::compared)) return;
    parts.keep_only(objects.renew(world));
    search.begin_frame();
  }

  [[nodiscard]] detail::ImpactSearch::Settings search_settings() const {
    const double in_contact = detail::kInContactGaps * settings.gap;
    // In whole steps Bullet brakes what is slower than the slop, and most bodies of most worlds are.
    return {settings.gap, in_contact, is_cut ? in_contact : settings.contact_slop, settings.contact_slop};
  }

  void try_part(double from, double length, RollbackReport& report) {
    parts.move(from, length, settings.gap, settings.contact_slop);
    ++report.simulation_steps;
    while (parts.must_repeat(length)) {
      take_back();
      parts.move(from, length, settings.gap, settings.contact_slop);
      ++report.simulation_steps;
    }
    parts.finish_move(length);
  }

  void accept(double from, double length, RollbackReport& report) {
    solver.core().end_trials();
    parts.accept(from, length);
    ++report.parts;
    detail::WorldStep::post_tick(world, static_cast<btScalar>(length));
  }

  /// Whether the state at `time` of a part, which meets something at `impact.time`, is one just before that all the
  /// same: a gap left, and less than two gaps moved since.
  [[nodiscard]] bool is_just_before(const detail::FoundImpact& impact, double time, double clearance,
                                    const PenetrationDepth& contact) const;
  /// True if the part ends because a pair in contact sinks, at a depth that is no matter of digits.
  [[nodiscard]] static bool sinks(const detail::FoundImpact& impact) { return impact.allowed_depth > 0; }
  /// Returns the clearance that a part is to leave to the impact's pair: the middle of those with which it may end.
  [[nodiscard]] double aim(const detail::FoundImpact& impact) const {
    return sinks(impact) ? 0.5 * kDeepEnough * settings.contact_slop : 0.75 * settings.gap;
  }
  /// Computes when a part is to end so that about the clearance of `aim` is left, on the motion that a shorter part
  /// would make: that of a flight, or one whose velocities change at the rate of the last trial. @return less than
  /// `end`.
  [[nodiscard]] double foresee(const detail::FoundImpact& impact, double end);
  /// True if a part whose motion met nothing ended where the impact's pair meets.
  [[nodiscard]] bool is_at(const detail::FoundImpact& impact, double clearance) const;
  /// Reports the contact that ended a part, and expects its impact.
  void record(const detail::FoundImpact& impact, const PenetrationDepth& contact, FirstContact& result,
              RollbackReport& report);
  /// Ends a part just before the impact, or, where trials do not come to it, at a time before that from which the next
  /// part will. @return its length, `least` or more.
  double advance_to(detail::FoundImpact& impact, double from, double duration, double least, RollbackReport& report);
  /// One frame, without what follows it (motion states, forces).
  void frame(btScalar step, double elapsed, RollbackReport& report);
};

RollbackStepper::RollbackStepper(btDiscreteDynamicsWorld& world, BulletPenetrationDepthSolver& solver,
                                 const RollbackSettings& settings)
    : state_(new State(world, solver, in_their_ranges(settings))) {}

RollbackStepper::~RollbackStepper() { delete state_; }

bool RollbackStepper::State::is_just_before(const detail::FoundImpact& impact, double time, double clearance,
                                            const PenetrationDepth& contact) const {
  if (!(clearance > 0 && clearance <= settings.gap)) return false;
  return (time - impact.time) * approach(impact, contact).norm() <= 2 * settings.gap;
}

bool RollbackStepper::State::is_at(const detail::FoundImpact& impact, double clearance) const {
  // A pair that Bullet brakes comes to the end of every part at the distance that counts as touching; the next part has
  // it in contact.
  return clearance <= detail::kInContactGaps * settings.gap ||
         (sinks(impact) && clearance <= kDeepEnough * settings.contact_slop);
}

double RollbackStepper::State::foresee(const detail::FoundImpact& impact, double end) {
  const auto pose_at = [&](const btCollisionObject& body, double time) {
    btTransform pose;
    return parts.predict(body, time, pose) ? pose : search.pose_after(body, time);
  };
  double time = impact.time;
  const double wanted = aim(impact);
  for (int i = 0; i < kMostForeseen; ++i) {
    const btTransform a = pose_at(*impact.a.body, time);
    const btTransform b = pose_at(*impact.b.body, time);
    const PenetrationDepth contact = search.measure(impact, a, b);
    const double clearance = contact.signed_distance() + impact.allowed_depth;
    if (std::abs(clearance - wanted) <= wanted / 3) break;
    const double closing = approach(impact, a, b, contact).dot(contact.normal);
    const double next = time + (clearance - wanted) / closing;
    if (!(closing > 0 && next > 0 && next < end)) break;
    time = next;
  }
  return time;
}

double RollbackStepper::State::advance_to(detail::FoundImpact& impact, double from, double duration, double least,
                                          RollbackReport& report) {
  FirstContact result;
  PenetrationDepth contact;
  const double undone = search.measure(impact).signed_distance();
  result.undone_depth = std::max(0.0, -undone);
  TrialEnd longer(impact, duration, undone + impact.allowed_depth);
  // A shorter part moves a little differently (forces act for less time, Bullet clamps a fast turn less), so that each
  // trial's own motion is searched. `low` is the latest time whose motion meets nothing, `high` the earliest whose
  // motion does; between them Newton's method on the pair's gap.
  double low = 0;
  double high = duration;
  double time = std::max(least, foresee(impact, duration));
  bool at_contact = false;
  const auto make = [&] {
    take_back();
    try_part(from, time, report);
    ++unrecorded_trials;
  };
  for (int trials = 1;; ++trials) {
    make();
    detail::FoundImpact earlier;
    const bool meets = search.earliest(time, search_settings(), earlier);
    if (meets) impact = earlier;
    contact = search.measure(impact);
    const double clearance = contact.signed_distance() + impact.allowed_depth;
    at_contact = meets ? is_just_before(impact, time, clearance, contact) : is_at(impact, clearance);
    if (at_contact) break;
    (meets ? high : low) = time;
    const bool free_part = low >= least;
    if (free_part && (trials >= kPatience || (meets && impact.time <= low))) {
      time = low;
      if (meets) make();
      break;
    }
    double next = HUGE_VAL;
    const TrialEnd end(impact, time, clearance);
    if (meets) {
      next = std::min(foresee(impact, time), longer.before(end, aim(impact)));
      longer = end;
    } else {
      const double closing = approach(impact, contact).dot(contact.normal);
      if (closing > 0) next = time + (clearance - aim(impact)) / closing;
    }
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    const bool no_finer = static_cast<btScalar>(next) == static_cast<btScalar>(time);
    if (next >= least && trials < settings.max_trials && !no_finer) {
      time = next;
      continue;
    }
    if (!meets) break;
    // No trial was free.
    time = least;
    make();
    contact = search.measure(impact);
    ++report.least_parts;
    report.deepest_run_in = std::max(report.deepest_run_in, -contact.signed_distance());
    at_contact = true;
    break;
  }
  if (!at_contact) return time;
  result.time = from + time;
  record(impact, contact, result, report);
  return time;
}

void RollbackStepper::State::record(const detail::FoundImpact& impact, const PenetrationDepth& contact,
                                    FirstContact& result, RollbackReport& report) {
  parts.expect_impact(impact.a.body, impact.b.body);
  result.gap = contact.signed_distance();
  result.trials = std::exchange(unrecorded_trials, 0);
  result.body_a = impact.a.body;
  result.body_b = impact.b.body;
  result.normal = to_bullet(contact.normal);
  result.point_a = to_bullet(contact.witness_a);
  result.point_b = to_bullet(contact.witness_b);
  if (impact.allowed_depth > 0) {
    parts.expect_deep(impact.a.body, impact.b.body);
    ++report.deepened;
  } else {
    report.contacts.push_back(result);
  }
}

void RollbackStepper::State::frame(btScalar step, double elapsed, RollbackReport& report) {
  const auto whole = static_cast<double>(step);
  const double least = settings.least_part * whole;
  const int known = report.contacts.size();
  objects.note(world);
  search.begin_frame();
  parts.begin_frame(step);
  unrecorded_trials = 0;
  double done = 0;
  int cuts = 0;
  while (whole - done > kNothingLeft * whole) {
    const double remaining = whole - done;
    is_cut = cuts > 0;
    detail::WorldStep::pre_tick(world, static_cast<btScalar>(remaining));
    follow_objects();
    save();
    solver.core().begin_trials();
    parts.begin_part();
    search.mark_start();
    try_part(done, remaining, report);
    const bool bounded = cuts >= settings.max_contacts_per_step;
    report.bounded = report.bounded || bounded;
    detail::FoundImpact impact;
    if (bounded || remaining <= least || !search.earliest(remaining, search_settings(), impact)) {
      accept(done, remaining, report);
      break;
    }
    ++cuts;
    double part = least;
    if (impact.time < least) {
      take_back();
      try_part(done, least, report);
      parts.expect_impact(impact.a.body, impact.b.body);
      ++report.least_parts;
      report.deepest_run_in = std::max(report.deepest_run_in, -search.measure(impact).signed_distance());
    } else {
      part = advance_to(impact, done, remaining, least, report);
    }
    accept(done, part, report);
    done += part;
  }
  for (int i = known; i < report.contacts.size(); ++i) report.contacts[i].time += elapsed;
}

RollbackReport RollbackStepper::step(btScalar step) {
  RollbackReport report;
  state_->frame(step, 0, report);
  state_->parts.end_frame();
  const bool latency = state_->world.getLatencyMotionStateInterpolation();
  detail::WorldStep::synchronize(state_->world, latency ? btScalar(0) : step, 0);
  return report;
}

RollbackReport RollbackStepper::step(btScalar time, int max_steps, btScalar fixed) {
  if (max_steps == 0) return step(time);
  RollbackReport report;
  btScalar& owed = state_->owed;
  owed += time;
  const int due = static_cast<int>(owed / fixed);
  owed -= static_cast<btScalar>(due) * fixed;
  // As Bullet does: what is due beyond the most steps is lost.
  for (int i = 0; i < std::min(due, max_steps); ++i) {
    state_->frame(fixed, i * static_cast<double>(fixed), report);
  }
  if (due > 0) state_->parts.end_frame();
  detail::WorldStep::synchronize(state_->world, owed, fixed);
  return report;
}

}  // namespace pd

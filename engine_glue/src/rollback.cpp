#include "pd/bullet/rollback.hpp"

#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "impact_search.hpp"
#include "pd/bullet/scalar.hpp"
#include "substep.hpp"
#include "world_step.hpp"

namespace pd {

namespace {

Vec3 velocity_at(const btCollisionObject& object, const Vec3& point) {
  const btRigidBody* body = btRigidBody::upcast(&object);
  if (body == nullptr || body->isStaticObject()) {
    return Vec3::Zero();
  }
  const Vec3 arm = point - to_pd(body->getWorldTransform().getOrigin());
  return to_pd(body->getLinearVelocity()) + to_pd(body->getAngularVelocity()).cross(arm);
}

/// What is left of a step below this share of it is rounding, no part.
constexpr double kNothingLeft = 1e-6;

}  // namespace

struct RollbackStepper::State {
  btDiscreteDynamicsWorld& world;
  BulletPenetrationDepthSolver& solver;
  RollbackSettings settings;
  detail::ImpactSearch search;
  detail::SubStepper parts;
  std::unique_ptr<BulletSnapshot> start;
  btScalar owed = 0;  ///< time of fixed steps that is not due yet

  State(btDiscreteDynamicsWorld& w, BulletPenetrationDepthSolver& s, const RollbackSettings& chosen)
      : world(w), solver(s), settings(chosen), search(w, s), parts(w) {}

  void save() {
    if (start) {
      start->save_again();
    } else {
      start = std::make_unique<BulletSnapshot>(world, &solver);
    }
  }

  void try_part(double from, double length, RollbackReport& report) {
    parts.move(from, length, settings.gap);
    ++report.simulation_steps;
    while (parts.lessen_restitution(length)) {
      start->restore();
      parts.move(from, length, settings.gap);
      ++report.simulation_steps;
    }
  }

  void accept(double from, double length, RollbackReport& report) {
    parts.accept(from, length);
    ++report.parts;
    detail::WorldStep::post_tick(world, static_cast<btScalar>(length));
  }

  /// Whether the state at `time` of a part, which meets something at `impact.time`, is one just before that all the
  /// same: a gap left, and less than two gaps moved since.
  [[nodiscard]] bool is_just_before(const detail::FoundImpact& impact, double time, double clearance,
                                    const PenetrationDepth& contact) const;
  /// Reports the contact that ended a part.
  static void record(const detail::FoundImpact& impact, const PenetrationDepth& contact, FirstContact& result,
                     RollbackReport& report);
  /// Ends a part just before the impact. @return its length, `least` or more.
  double advance_to(detail::FoundImpact impact, double from, double duration, double least, RollbackReport& report);
  /// One frame, without what follows it (motion states, forces).
  void frame(btScalar step, double elapsed, RollbackReport& report);
};

RollbackStepper::RollbackStepper(btDiscreteDynamicsWorld& world, BulletPenetrationDepthSolver& solver,
                                 const RollbackSettings& settings)
    : state_(new State(world, solver, settings)) {}

RollbackStepper::~RollbackStepper() { delete state_; }

bool RollbackStepper::State::is_just_before(const detail::FoundImpact& impact, double time, double clearance,
                                            const PenetrationDepth& contact) const {
  if (!(clearance > 0 && clearance <= settings.gap)) return false;
  const Vec3 relative = velocity_at(*impact.b.body, contact.witness_b) - velocity_at(*impact.a.body, contact.witness_a);
  return (time - impact.time) * relative.norm() <= 2 * settings.gap;
}

double RollbackStepper::State::advance_to(detail::FoundImpact impact, double from, double duration, double least,
                                          RollbackReport& report) {
  FirstContact result;
  PenetrationDepth contact;
  result.undone_depth = std::max(0.0, -search.measure(impact).signed_distance());
  // A shorter part moves a little differently (gravity acts for less time, Bullet clamps a fast turn less), so that
  // each trial's own motion is searched. `low` is the latest time whose motion meets nothing, `high` the earliest whose
  // motion does; between them Newton's method on the pair's gap.
  double low = 0;
  double high = duration;
  double time = impact.time;
  for (;;) {
    start->restore();
    try_part(from, time, report);
    ++result.trials;
    detail::FoundImpact earlier;
    const bool meets = search.earliest(time, {settings.gap, settings.contact_slop}, earlier);
    if (meets) impact = earlier;
    contact = search.measure(impact);
    result.gap = contact.signed_distance();
    const double clearance = result.gap + impact.allowed_depth;
    double next = HUGE_VAL;
    if (meets) {
      if (is_just_before(impact, time, clearance, contact)) break;
      high = time;
      next = impact.time;
    } else {
      if (clearance <= settings.gap) break;
      low = time;
      const double closing =
          (velocity_at(*impact.b.body, contact.witness_b) - velocity_at(*impact.a.body, contact.witness_a))
              .dot(contact.normal);
      if (closing > 0) next = time + (clearance - 0.5 * settings.gap) / closing;
    }
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    // Where no trial was free yet, the least part says whether any is.
    if (meets && low == 0 && result.trials == 4) next = std::min(next, least);
    const bool no_finer = static_cast<btScalar>(next) == static_cast<btScalar>(time);
    if (next >= least && result.trials < settings.max_trials && !no_finer) {
      time = next;
      continue;
    }
    if (!meets) break;
    // The trials ended inside: the latest part that meets nothing is kept, or the least one, which is counted.
    time = low >= least ? low : least;
    start->restore();
    try_part(from, time, report);
    contact = search.measure(impact);
    result.gap = contact.signed_distance();
    if (low < least) {
      ++report.least_parts;
      report.deepest_run_in = std::max(report.deepest_run_in, -result.gap);
    }
    break;
  }
  result.time = from + time;
  record(impact, contact, result, report);
  return time;
}

void RollbackStepper::State::record(const detail::FoundImpact& impact, const PenetrationDepth& contact,
                                    FirstContact& result, RollbackReport& report) {
  result.body_a = impact.a.body;
  result.body_b = impact.b.body;
  result.normal = to_bullet(contact.normal);
  result.point_a = to_bullet(contact.witness_a);
  result.point_b = to_bullet(contact.witness_b);
  if (impact.allowed_depth > 0) {
    ++report.deepened;
  } else {
    report.contacts.push_back(result);
  }
}

void RollbackStepper::State::frame(btScalar step, double elapsed, RollbackReport& report) {
  const auto whole = static_cast<double>(step);
  const double least = settings.least_part * whole;
  const int known = report.contacts.size();
  search.collect();
  parts.begin_frame(step);
  double done = 0;
  int cuts = 0;
  while (whole - done > kNothingLeft * whole) {
    const double remaining = whole - done;
    detail::WorldStep::pre_tick(world, static_cast<btScalar>(remaining));
    save();
    parts.begin_part();
    search.mark_start();
    try_part(done, remaining, report);
    const bool bounded = cuts >= settings.max_contacts_per_step;
    report.bounded = report.bounded || bounded;
    detail::FoundImpact impact;
    if (bounded || remaining <= least || !search.earliest(remaining, {settings.gap, settings.contact_slop}, impact)) {
      accept(done, remaining, report);
      break;
    }
    ++cuts;
    double part = least;
    if (impact.time < least) {
      start->restore();
      try_part(done, least, report);
      ++report.least_parts;
      report.deepest_run_in = std::max(report.deepest_run_in, -search.measure(impact).signed_distance());
    } else {
      part = advance_to(std::move(impact), done, remaining, least, report);
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

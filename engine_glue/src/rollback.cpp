#include "pd/bullet/rollback.hpp"

#include <BulletCollision/CollisionShapes/btCompoundShape.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <cmath>

#include "cached_shape.hpp"
#include "moving_body.hpp"
#include "pd/bullet/scalar.hpp"
#include "pd/bullet/shape_cache.hpp"
#include "pd/contact/time_of_impact.hpp"

namespace pd {

/// A convex piece of a body.
struct RollbackStepper::Part {
  btCollisionObject* body;
  const btConvexShape* bullet_shape;
  btTransform local;  ///< of the piece in the body
  std::shared_ptr<detail::CachedShape> cached;
  double radius;  ///< about the body's origin
  btTransform start;

  [[nodiscard]] btTransform present() const { return body->getWorldTransform() * local; }
  /// As the contact algorithm takes it: two boxes are sharp.
  [[nodiscard]] const ConvexShape& shape_beside(const Part& other) const {
    return cached->sharp && other.cached->sharp ? *cached->sharp : *cached->body;
  }
};

struct RollbackStepper::Impact {
  const Part* a = nullptr;
  const Part* b = nullptr;
  double time = HUGE_VAL;
  double allowed_depth = 0;  ///< 0: a first contact
};

namespace {

double signed_distance(const PenetrationDepth& answer) {
  return answer.contact == ContactClass::separated ? answer.distance : -answer.depth;
}

Vec3 velocity_at(const btCollisionObject& object, const Vec3& point) {
  const btRigidBody* body = btRigidBody::upcast(&object);
  if (body == nullptr || body->isStaticObject()) {
    return Vec3::Zero();
  }
  const Vec3 arm = point - to_pd(body->getWorldTransform().getOrigin());
  return to_pd(body->getLinearVelocity()) + to_pd(body->getAngularVelocity()).cross(arm);
}

}  // namespace

RollbackStepper::RollbackStepper(btDiscreteDynamicsWorld& world, BulletPenetrationDepthSolver& solver,
                                 const RollbackSettings& settings)
    : world_(world), solver_(solver), settings_(settings) {}

RollbackStepper::~RollbackStepper() = default;

void RollbackStepper::collect_parts() {
  parts_.clear();
  const auto add = [&](btCollisionObject* object, const btCollisionShape* shape, const btTransform& local,
                       const auto& recurse) -> void {
    if (shape->isCompound()) {
      const auto* compound = static_cast<const btCompoundShape*>(shape);
      for (int i = 0; i < compound->getNumChildShapes(); ++i) {
        recurse(object, compound->getChildShape(i), local * compound->getChildTransform(i), recurse);
      }
    } else if (shape->isConvex()) {
      const auto* convex = static_cast<const btConvexShape*>(shape);
      if (auto cached = solver_.cache().find(*convex, 0); cached->body) {
        const double radius =
            to_pd(local.getOrigin()).norm() + bounding_radius(cached->sharp ? *cached->sharp : *cached->body);
        parts_.push_back({object, convex, local, std::move(cached), radius, local});
      }
    }
  };
  const auto& objects = world_.getCollisionObjectArray();
  for (int i = 0; i < objects.size(); ++i) {
    if (objects[i]->hasContactResponse()) {
      add(objects[i], objects[i]->getCollisionShape(), btTransform::getIdentity(), add);
    }
  }
}

void RollbackStepper::remember_start_poses() {
  for (Part& part : parts_) {
    part.start = part.present();
  }
}

bool RollbackStepper::earliest_impact(double duration, Impact& impact) {
  impact = Impact();
  TimeOfImpactSettings settings;
  settings.distance_tolerance = 0.5 * settings_.gap;
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    for (std::size_t j = i + 1; j < parts_.size(); ++j) {
      const Part& a = parts_[i];
      const Part& b = parts_[j];
      if (a.body == b.body || (a.body->isStaticOrKinematicObject() && b.body->isStaticOrKinematicObject()) ||
          !world_.getDispatcher()->needsCollision(a.body, b.body) ||
          !world_.getPairCache()->needsBroadphaseCollision(a.body->getBroadphaseHandle(),
                                                           b.body->getBroadphaseHandle())) {
        continue;
      }
      const MovingShape moving_a = detail::moving_shape(a.shape_beside(b), a.start, a.present(), duration);
      const MovingShape moving_b = detail::moving_shape(b.shape_beside(a), b.start, b.present(), duration);
      const double travel = (moving_a.motion.linear_velocity - moving_b.motion.linear_velocity).norm() * duration;
      const double apart = (moving_a.start.pose.translation() - moving_b.start.pose.translation()).norm();
      if (apart > travel + a.radius + b.radius) {
        continue;
      }
      const PenetrationDepth before = penetration_depth(moving_a.start, moving_b.start, scratch_);
      // From where it is, a pair in contact may sink by its share; then the step is cut, and Bullet sees it there.
      const double start_depth = -signed_distance(before);
      settings.allowed_depth =
          start_depth >= -2 * settings_.gap
              ? std::max(start_depth, 0.0) + settings_.contact_depth_share * std::min(a.radius, b.radius)
              : 0;
      const TimeOfImpact found = time_of_impact(moving_a, moving_b, duration, scratch_, settings);
      if (found.hit && found.time < impact.time) {
        impact = {&a, &b, found.time, settings.allowed_depth};
      }
    }
  }
  return impact.a != nullptr;
}

FirstContact RollbackStepper::advance_to(const Impact& impact, const BulletSnapshot& start, double duration,
                                         RollbackReport& report) {
  const auto measure = [&] {
    return penetration_depth({&impact.a->shape_beside(*impact.b), to_pd(impact.a->present())},
                             {&impact.b->shape_beside(*impact.a), to_pd(impact.b->present())}, scratch_);
  };
  FirstContact result;
  result.body_a = impact.a->body;
  result.body_b = impact.b->body;
  result.undone_depth = std::max(0.0, -signed_distance(measure()));

  // The bracket: apart at `low`, not apart at `high`. The motion that was searched is that of the whole step; a shorter
  // step moves a little differently (gravity acts for less time), which Newton's method on real steps makes up for.
  double low = 0;
  double high = duration;
  double time = impact.time;
  for (;;) {
    start.restore();
    world_.stepSimulation(static_cast<btScalar>(time), 0);
    ++report.simulation_steps;
    ++result.trials;
    result.contact = measure();
    result.gap = signed_distance(result.contact);
    result.time = time;
    const double clearance = result.gap + impact.allowed_depth;
    if ((clearance > 0 && clearance <= settings_.gap) || result.trials >= settings_.max_trials) {
      return result;
    }
    (clearance > 0 ? low : high) = time;
    const double closing =
        (velocity_at(*result.body_b, result.contact.witness_b) - velocity_at(*result.body_a, result.contact.witness_a))
            .dot(result.contact.normal);
    double next = closing > 0 ? time + (clearance - 0.5 * settings_.gap) / closing : HUGE_VAL;
    if (!(next > low && next < high)) {
      next = 0.5 * (low + high);
    }
    if (static_cast<btScalar>(next) == static_cast<btScalar>(time)) {
      return result;  // finer than a btScalar of time
    }
    time = next;
  }
}

RollbackReport RollbackStepper::step(btScalar step) {
  RollbackReport report;
  collect_parts();
  double done = 0;
  double remaining = static_cast<double>(step);
  // What is left below a btScalar's resolution of the step is no step.
  while (remaining > 1e-7 * static_cast<double>(step)) {
    const BulletSnapshot start(world_, &solver_);
    remember_start_poses();
    world_.stepSimulation(static_cast<btScalar>(remaining), 0);
    ++report.simulation_steps;
    report.bounded = static_cast<int>(report.contacts.size()) + report.deepened >= settings_.max_contacts_per_step;
    Impact impact;
    if (report.bounded || !earliest_impact(remaining, impact)) {
      return report;
    }
    FirstContact contact = advance_to(impact, start, remaining, report);
    const double advanced = contact.time;
    contact.time += done;
    if (impact.allowed_depth > 0) {
      ++report.deepened;
    } else {
      report.contacts.push_back(contact);
    }
    done += advanced;
    remaining -= advanced;
  }
  return report;
}

}  // namespace pd

#include "engine_glue/pair_judge.hpp"

#include <BulletCollision/CollisionShapes/btCompoundShape.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "pd/bullet/scalar.hpp"
#include "pd/bullet/shape_conversion.hpp"
#include "pd/contact/time_of_impact.hpp"
#include "pd/depth/penetration_depth.hpp"

namespace pd::test {

namespace {

/// Pairs nearer than so many gaps are in contact: the promise's own words.
constexpr double kInContactGaps = 2.25;
/// They may sink by so many slops in a step.
constexpr double kSlopsAStep = 2;
/// Poses looked at between the ends of a part.
constexpr int kPosesOnTheWay = 32;
/// Bodies fly along parabolas and turn unevenly; between the ends of a part they are taken to move straight and turn
/// evenly. Of 1/60 s that is off by g t^2 / 8 = 3.4e-4 m and something like it for the turning.
constexpr double kGrazing = 2e-3;

Pose compose(const Pose& outer, const Pose& inner) {
  return Pose::from_trusted_matrix(outer.rotation() * inner.rotation(), outer.apply(inner.translation()));
}

bool can_collide(const btCollisionObject& a, const btCollisionObject& b) {
  if (a.isStaticOrKinematicObject() && b.isStaticOrKinematicObject()) return false;
  if (!a.hasContactResponse() || !b.hasContactResponse()) return false;
  const btBroadphaseProxy& pa = *a.getBroadphaseHandle();
  const btBroadphaseProxy& pb = *b.getBroadphaseHandle();
  if ((pa.m_collisionFilterGroup & pb.m_collisionFilterMask) == 0) return false;
  if ((pb.m_collisionFilterGroup & pa.m_collisionFilterMask) == 0) return false;
  return a.checkCollideWith(&b) && b.checkCollideWith(&a);
}

}  // namespace

PairJudge::PairJudge(btDiscreteDynamicsWorld& world, const RollbackSettings& settings)
    : world_(world), settings_(settings) {
  const auto& objects = world.getCollisionObjectArray();
  for (int i = 0; i < objects.size(); ++i) {
    Body body{objects[i], {}, 0};
    add_children(*objects[i]->getCollisionShape(), Pose(), body);
    bodies_.push_back(std::move(body));
  }
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    for (std::size_t j = i + 1; j < bodies_.size(); ++j) {
      if (!can_collide(*bodies_[i].object, *bodies_[j].object)) continue;
      pairs_.push_back({i, j, {}});
      pairs_.back().distance = present(pairs_.back());
    }
  }
  ends_.push_back(present_poses());
  world.setInternalTickCallback(
      [](btDynamicsWorld* stepped, btScalar) {
        auto& judge = *static_cast<PairJudge*>(stepped->getWorldUserInfo());
        judge.ends_.push_back(judge.present_poses());
      },
      this);
}

PairJudge::~PairJudge() { world_.setInternalTickCallback(nullptr); }

void PairJudge::add_children(const btCollisionShape& shape, const Pose& local, Body& body) {
  if (shape.isCompound()) {
    const auto& compound = static_cast<const btCompoundShape&>(shape);
    for (int i = 0; i < compound.getNumChildShapes(); ++i) {
      add_children(*compound.getChildShape(i), compose(local, to_pd(compound.getChildTransform(i))), body);
    }
    return;
  }
  if (!shape.isConvex()) throw std::invalid_argument("PairJudge judges convex shapes and compounds of them");
  auto converted = to_convex_shape(static_cast<const btConvexShape&>(shape));
  if (!converted) throw std::invalid_argument("PairJudge: a shape is no convex body");
  body.radius = std::max(body.radius, local.translation().norm() + bounding_radius(*converted));
  body.children.push_back({std::move(*converted), local});
}

SignedDistance PairJudge::measure(const Body& a, const Pose& pose_a, const Body& b, const Pose& pose_b, double beyond) {
  SignedDistance least{HUGE_VAL, HUGE_VAL};
  DepthSettings settings;
  settings.bracket = Bracket::certified;
  settings.beyond = beyond;
  for (const Child& child_a : a.children) {
    const PosedShape posed_a{&child_a.shape, compose(pose_a, child_a.local)};
    for (const Child& child_b : b.children) {
      const PosedShape posed_b{&child_b.shape, compose(pose_b, child_b.local)};
      const PenetrationDepth answer = penetration_depth(posed_a, posed_b, scratch_, settings);
      const bool separated = answer.contact == ContactClass::separated;
      least.lower = std::min(least.lower, separated ? answer.distance_lower : -answer.upper);
      least.upper = std::min(least.upper, separated ? answer.distance_upper : -answer.lower);
    }
  }
  return least;
}

SignedDistance PairJudge::present(const Pair& pair) {
  const Body& a = bodies_[pair.a];
  const Body& b = bodies_[pair.b];
  return measure(a, to_pd(a.object->getWorldTransform()), b, to_pd(b.object->getWorldTransform()),
                 2 * kInContactGaps * settings_.gap);
}

double PairJudge::rounding(const Pair& pair) const {
  const Body& smaller = bodies_[bodies_[pair.a].radius < bodies_[pair.b].radius ? pair.a : pair.b];
  const btVector3 origin = smaller.object->getWorldTransform().getOrigin().absolute();
  const auto farthest = static_cast<btScalar>(static_cast<double>(origin[origin.maxAxis()]) + smaller.radius);
  const auto ulp = static_cast<double>(std::nextafter(farthest, BT_LARGE_FLOAT) - farthest);
  return std::max(1e-6 * 2 * smaller.radius, 4 * ulp);
}

bool PairJudge::met_on_the_way(const Pair& pair) {
  const double in_contact = kInContactGaps * settings_.gap;
  for (std::size_t k = 1; k + 1 < ends_.size(); ++k) {
    const SignedDistance there =
        measure(bodies_[pair.a], ends_[k][pair.a], bodies_[pair.b], ends_[k][pair.b], in_contact);
    if (there.lower <= in_contact) return true;
  }
  return false;
}

const std::vector<JudgedPair>& PairJudge::judge(const RollbackReport& report) {
  judged_.clear();
  for (Pair& pair : pairs_) {
    const SignedDistance before = pair.distance;
    pair.distance = present(pair);
    JudgedPair judged;
    judged.a = bodies_[pair.a].object;
    judged.b = bodies_[pair.b].object;
    judged.before = before.upper;
    judged.after = pair.distance.upper;
    judged.rounding = rounding(pair);
    judged.run_in = report.least_parts > 0 || report.bounded;
    if (before.lower <= kInContactGaps * settings_.gap) {
      judged.start = PairStart::in_contact;
    } else if (judged.depth() > judged.rounding && met_on_the_way(pair)) {
      judged.start = PairStart::met;
    }
    judged.allowed = judged.start == PairStart::apart
                         ? judged.rounding
                         : std::max(0.0, -before.lower) + kSlopsAStep * settings_.contact_slop + judged.rounding;
    judged_.push_back(judged);
  }
  passages_.clear();
  for (std::size_t k = 1; k < ends_.size(); ++k) look_through(ends_[k - 1], ends_[k], report.bounded);
  ends_ = {ends_.back()};
  return judged_;
}

std::vector<Pose> PairJudge::present_poses() const {
  std::vector<Pose> poses;
  for (const Body& body : bodies_) poses.push_back(to_pd(body.object->getWorldTransform()));
  return poses;
}

void PairJudge::look_through(const std::vector<Pose>& start, const std::vector<Pose>& end, bool bounded) {
  std::vector<Vec3> way(bodies_.size());
  std::vector<Eigen::AngleAxisd> turn(bodies_.size());
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    way[i] = end[i].translation() - start[i].translation();
    turn[i] =
        Eigen::AngleAxisd(Eigen::Quaterniond(Mat3(end[i].rotation() * start[i].rotation().transpose())).normalized());
  }
  const auto on_the_way = [&](std::size_t i, double share) {
    return Pose::from_trusted_matrix(
        Eigen::AngleAxisd(share * turn[i].angle(), turn[i].axis()).toRotationMatrix() * start[i].rotation(),
        start[i].translation() + share * way[i]);
  };
  for (const Pair& pair : pairs_) {
    const Body& a = bodies_[pair.a];
    const Body& b = bodies_[pair.b];
    const double reach = (way[pair.a] - way[pair.b]).norm() + std::abs(turn[pair.a].angle()) * a.radius +
                         std::abs(turn[pair.b].angle()) * b.radius;
    if (reach <= kGrazing) continue;
    const SignedDistance first = measure(a, start[pair.a], b, start[pair.b], reach);
    if (first.lower > reach) continue;
    const SignedDistance last = measure(a, end[pair.a], b, end[pair.b], reach);
    double deepest = 0;
    for (int k = 1; k < kPosesOnTheWay; ++k) {
      const double share = static_cast<double>(k) / kPosesOnTheWay;
      deepest = std::max(deepest, -measure(a, on_the_way(pair.a, share), b, on_the_way(pair.b, share), 0).upper);
    }
    if (deepest > std::max({0.0, -first.lower, -last.lower}) + kGrazing)
      passages_.push_back({a.object, b.object, deepest, bounded});
  }
}

}  // namespace pd::test

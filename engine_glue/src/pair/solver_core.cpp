#include "pair/solver_core.hpp"

#include <BulletCollision/CollisionShapes/btConvexShape.h>

#include <algorithm>

#include "pair/box_contacts.hpp"
#include "pair/query_meter.hpp"
#include "pair/solver_in_world.hpp"
#include "pair/warm_up.hpp"
#include "pd/bullet/scalar.hpp"
#include "pd/contact/time_of_impact.hpp"
#include "shapes/lane_vectors.hpp"

namespace pd::detail {

double contact_tolerance(const Vec3& a, const Vec3& b, double smaller_radius) {
  constexpr double kShare = sizeof(btScalar) == sizeof(float) ? 0x1p-30 : 0x1p-46;
  const double farthest = a.cwiseAbs().cwiseMax(b.cwiseAbs()).maxCoeff();
  return kShare * (farthest + smaller_radius);
}

bool in_range(const btTransform& pose) {
  // As `is_finite`, four numbers at a time; nobody sets the fourth.
  Lanes sum = {0, 0, 0, 0};
  for (int i = 0; i < 4; ++i) {
    Lanes row;
    load_lanes(i < 3 ? pose.getBasis()[i] : pose.getOrigin(), row);
    sum += row * btScalar(0);
  }
  if (!(sum[0] + sum[1] + sum[2] == 0)) return false;
  // Single precision ends before the core does.
  return sizeof(btScalar) == sizeof(float) || to_pd(pose.getOrigin()).cwiseAbs().maxCoeff() <= kMaxCoordinate;
}

SolverCore::SolverCore(const BulletSolverSettings& chosen) : settings(chosen), cache(chosen.cache_capacity) {}
SolverCore::~SolverCore() = default;

CachedShape& SolverCore::find(const btConvexShape& shape, std::uint64_t stamp, std::shared_ptr<CachedShape>& known,
                              ThreadBuffers& held) {
  if (shape.getShapeType() == TRIANGLE_SHAPE_PROXYTYPE) {
    held.triangles.find(static_cast<const btTriangleShape&>(shape), known,
                        [&](const btTriangleShape& triangle) { return cache.find(triangle, stamp); });
    return *known;
  }
  StepShapes{cache, stamp}.refresh(shape, known);
  return *known;
}

SolverCore::Outcome SolverCore::place(const PairQuestion& question, ThreadBuffers& held, PairAnswer& out) {
  SolverCounters& counters = held.counters;
  const bool known = question.shapes_current;
  const CachedShape& found_a = known ? *question.shapes[0] : find(question.a, question.stamp, question.shapes[0], held);
  const CachedShape& found_b = known ? *question.shapes[1] : find(question.b, question.stamp, question.shapes[1], held);
  if (!found_a.body || !found_b.body) {
    counters.unsupported.add();
    const bool refuse_a = !found_a.body && found_a.refusal.code != ErrorCode::unsupported;
    const bool refuse_b = !found_b.body && found_b.refusal.code != ErrorCode::unsupported;
    warn(found_a.body ? question.b : question.a, found_a.body ? found_b.refusal : found_a.refusal);
    return refuse_a || refuse_b ? Outcome::refused : Outcome::unsupported;
  }
  if (!in_range(question.pose_a) || !in_range(question.pose_b)) {
    counters.refused_poses.add();
    return Outcome::refused;
  }
  const SharpCorners& corners = question.corners;
  const bool pair = corners.sharp_pair && found_a.sharp && found_b.sharp;
  const bool sharp_a = found_a.sharp && (pair || corners.sharp_a), sharp_b = found_b.sharp && (pair || corners.sharp_b);
  out.a = {(sharp_a ? found_a.sharp : found_a.body).get(), to_pd(question.pose_a)};
  out.b = {(sharp_b ? found_b.sharp : found_b.body).get(), to_pd(question.pose_b)};
  out.boxes = sharp_a && sharp_b;
  return Outcome::answered;
}

void SolverCore::measure(const PairQuestion& question, ThreadBuffers& held, PairAnswer& out) {
  DepthSettings depth_settings;
  depth_settings.delta = settings.delta;
  depth_settings.bracket = Bracket::contact;
  depth_settings.beyond = question.beyond;
  depth_settings.contact_tolerance =
      contact_tolerance(out.a.pose.translation(), out.b.pose.translation(),
                        std::min(bounding_radius(*out.a.shape), bounding_radius(*out.b.shape)));
  out.depth = penetration_depth(out.a, out.b, held.scratch, depth_settings, question.warm);
  SolverCounters& counters = held.counters;
  counters.support_calls.add(out.depth.statistics.support_calls);
  if (out.depth.statistics.exact_signs > 0) {
    counters.exact_signs.add(out.depth.statistics.exact_signs);
  }
  if (!out.depth.bracket_reached) {
    counters.wider.add();
  }
  if (out.depth.warm) {
    counters.warm.add();
  }
}

SolverCore::Outcome SolverCore::answer(const PairQuestion& question, ThreadBuffers& held, PairAnswer& out) {
  held.counters.calls.add();
  QueryMeter meter(held);
  const Outcome placed = place(question, held, out);
  if (placed != Outcome::answered) return placed;
  measure(question, held, out);
  meter.count(out.depth.contact);
  return Outcome::answered;
}

SolverCore::Outcome SolverCore::contacts(const PairQuestion& question, double breaking_threshold, ThreadBuffers& held,
                                         PairAnswer& out, ContactManifold& points) {
  held.counters.calls.add();
  QueryMeter meter(held);
  const Outcome placed = place(question, held, out);
  if (placed != Outcome::answered) return placed;
  const BoxContact boxes =
      out.boxes && !question.boxes_asked
          ? ask_boxes(question.a, question.pose_a, question.b, question.pose_b, breaking_threshold, BoxWitness::placed)
          : BoxContact();
  if (boxes.answered) {
    out.depth = depth_of(boxes);
    points = boxes.manifold;
  } else {
    measure(question, held, out);
    points = contact_manifold(out.a, out.b, out.depth, breaking_threshold, held.manifold, DeepestPoint::as_lifted);
  }
  meter.count(out.depth.contact);
  return Outcome::answered;
}

SolverCore::Outcome SolverCore::stand_on(const GroundQuestion& question, ThreadBuffers& held, HalfspaceContact& out) {
  // Whoever asks has another way to ask, where what cannot be answered is counted.
  const CachedShape& found = find(question.body, question.stamp, question.shape, held);
  if (!found.body) return Outcome::unsupported;
  if (!in_range(question.pose)) return Outcome::refused;
  held.counters.calls.add();
  QueryMeter meter(held);
  const ConvexShape* body = (question.sharp_box && found.sharp ? found.sharp : found.body).get();
  out = halfspace_contact({body, to_pd(question.pose)}, question.ground, question.threshold, held.manifold);
  held.counters.support_calls.add(out.manifold.count > 0 ? 2 : 1);
  meter.count(out.contact);
  return Outcome::answered;
}

void SolverCore::warn(const btConvexShape& shape, const Error& refusal) {
  const std::uint64_t bit = std::uint64_t{1} << (shape.getShapeType() & 63);
  if ((warned_.fetch_or(bit, std::memory_order_relaxed) & bit) != 0 || !settings.warning) {
    return;
  }
  const std::string line =
      "pdepth: " + refusal.where + ": " + refusal.message +
      (refusal.code == ErrorCode::unsupported ? ". Bullet's own solver answers for it." : ". No contacts.");
  settings.warning(line.c_str(), settings.user);
}

bool SolverCore::calc_pen_depth(btSimplexSolverInterface& simplex, const btConvexShape* a, const btConvexShape* b,
                                const btTransform& pose_a, const btTransform& pose_b, btVector3& v,
                                btVector3& witness_a, btVector3& witness_b, btIDebugDraw* draw) {
  if (closed()) {
    return epa_.calcPenDepth(simplex, a, b, pose_a, pose_b, v, witness_a, witness_b, draw);
  }
  auto held = buffers.lease();
  PairAnswer found;
  // Rounded corners: Bullet's detector takes its cores and adds the margins itself.
  const PairQuestion question{.a = *a, .pose_a = pose_a, .b = *b, .pose_b = pose_b, .shapes = held->recent};
  switch (answer(question, *held, found)) {
    case Outcome::answered:
      break;
    case Outcome::refused:
      v.setZero();
      return false;
    case Outcome::unsupported:
      v.setZero();
      if (!is_finite(pose_a) || !is_finite(pose_b)) {
        return false;
      }
      held->counters.fallback.add();
      return fallback().calcPenDepth(simplex, a, b, pose_a, pose_b, v, witness_a, witness_b, draw);
  }
  const PenetrationDepth& depth = found.depth;
  v = to_bullet(depth.normal);
  if (depth.contact != ContactClass::separated) {
    witness_a = to_bullet(depth.witness_a);
    witness_b = to_bullet(depth.witness_b);
    return true;
  }
  // From the surfaces back to Bullet's cores: A's surface faces -normal, B's faces +normal.
  witness_a = to_bullet(depth.witness_a + static_cast<double>(a->getMarginNonVirtual()) * depth.normal);
  witness_b = to_bullet(depth.witness_b - static_cast<double>(b->getMarginNonVirtual()) * depth.normal);
  return false;
}

SolverInWorld* SolverCore::world_at(std::size_t place) {
  const std::lock_guard lock(mutex_);
  return worlds_[place].get();
}

SolverInWorld& SolverCore::add_world(std::size_t place, std::unique_ptr<SolverInWorld> world) {
  const std::lock_guard lock(mutex_);
  if (!installed_) warm_up(*buffers.lease());
  installed_ = true;
  if (!worlds_[place]) worlds_[place] = std::move(world);
  return *worlds_[place];
}

void SolverCore::close() {
  closed_.store(true, std::memory_order_relaxed);
  settings.fallback = nullptr;
  settings.takes_pair = nullptr;
  cache.clear();
  buffers.clear();
}

}  // namespace pd::detail

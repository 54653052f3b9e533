#include "union/deep_union.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "pair/solver_core.hpp"
#include "pd/bullet/scalar.hpp"
#include "pd/contact/time_of_impact.hpp"
#include "pd/depth/directional_depth.hpp"
#include "pd/union_contact/union_exit.hpp"
#include "pieces/piece_wrapper.hpp"
#include "shapes/moving_body.hpp"
#include "union/union_algorithm.hpp"

namespace pd::detail {

namespace {

/// Of the radius of the smaller child: contacts that solvers leave behind are far below.
constexpr double kDeep = 0.25;
/// cos 45 degrees.
constexpr double kTogether = 0.7;
/// Ways out that are no longer than this times the deepest pair's depth, which none is shorter than, are short enough.
constexpr double kShort = 1.5;
/// From here on a shorter one is not looked for.
constexpr double kShortest = 1.05;
/// Of the children in each other, the deepest, whose ways are tried.
constexpr std::size_t kMostOwnWays = 4;
/// Children that one straight way may have to pass.
constexpr int kMostStops = 12;
/// What one answer may take.
constexpr std::size_t kMostPairs = 1 << 10;
constexpr std::int64_t kMostFacets = 1 << 14;

/// The child of this number, which is there.
const Child& child_of(const std::vector<Child>& children, int number) {
  return *std::find_if(children.begin(), children.end(), [&](const Child& child) { return child.index == number; });
}

}  // namespace

void DeepUnion::clear() {
  deepest_ = 0;
  deepest_pair_.depth.depth = 0;
  normals_.clear();
  own_ways_.clear();
  torn_ = false;
}

void DeepUnion::add(const PairAnswer& answer, int child_a, int child_b, const ContactManifold& left) {
  if (answer.depth.contact != ContactClass::overlapping) return;
  own_ways_.emplace_back(answer.depth.depth, answer.depth.normal);
  if (answer.depth.depth > deepest_pair_.depth.depth) {
    deepest_pair_ = answer;
    child_a_ = child_a;
    child_b_ = child_b;
  }
  const double radius = std::min(bounding_radius(*answer.a.shape), bounding_radius(*answer.b.shape));
  if (answer.depth.depth < kDeep * radius) return;
  deepest_ = std::max(deepest_, answer.depth.depth);
  if (left.count == 0) return;
  // A facet that stands in for a covered one is far, and what lies round it was not looked at.
  torn_ = torn_ || answer.depth.normal.dot(left.normal) < kTogether ||
          std::any_of(normals_.begin(), normals_.end(),
                      [&](const Vec3& normal) { return normal.dot(left.normal) < kTogether; });
  normals_.push_back(left.normal);
}

bool DeepUnion::collect(const btCollisionObjectWrapper& body, const btCollisionObjectWrapper& other, double reach,
                        const UnionQuestion& question, SolverCore& core, Side& side) {
  const btTransform& pose = body.getWorldTransform();
  const btTransform& other_pose = other.getWorldTransform();
  const btCollisionShape& other_shape = *other.getCollisionShape();
  children_near(body, box_of(other_shape, pose.inverseTimes(other_pose)), box_of(other_shape, other_pose),
                static_cast<btScalar>(reach), side.children);
  side.posed.clear();
  side.held.clear();
  side.polytopes = true;
  for (const Child& child : side.children) {
    if (!child.shape->isConvex()) return false;
    const auto found = core.cache.find(static_cast<const btConvexShape&>(*child.shape), question.stamp);
    if (!found->body) return false;
    side.polytopes = side.polytopes && found->body->polytope() != nullptr;
    const bool part = child.index >= 0;
    side.held.push_back(found);
    side.posed.push_back({(part && found->sharp ? found->sharp : found->body).get(), to_pd(child.pose)});
  }
  return !side.posed.empty();
}

bool DeepUnion::deepest_pair_leads_out(ThreadBuffers& buffers) const {
  const Vec3 way = deepest_pair_.depth.depth * deepest_pair_.depth.normal;
  DepthSettings settings;
  settings.bracket = Bracket::contact;
  settings.beyond = 0;
  for (std::size_t i = 0; i < a_.posed.size(); ++i) {
    const PosedShape moved{a_.posed[i].shape, Pose::from_trusted_matrix(a_.posed[i].pose.rotation(),
                                                                        a_.posed[i].pose.translation() + way)};
    const Child& child_a = a_.children[i];
    const ChildBox box_a{child_a.box.lower + to_bullet(way), child_a.box.upper + to_bullet(way)};
    for (std::size_t j = 0; j < b_.posed.size(); ++j) {
      const Child& child_b = b_.children[j];
      if (child_a.index == child_a_ && child_b.index == child_b_) continue;
      if (apart(box_a, child_b.box, 0)) continue;
      const double slack = seam_slack(moved, b_.posed[j]);
      settings.contact_tolerance = slack;
      const PenetrationDepth left = penetration_depth(moved, b_.posed[j], buffers.scratch, settings);
      if (left.contact == ContactClass::overlapping && left.depth > slack) return false;
    }
  }
  return true;
}

std::optional<DeepUnion::Exit> DeepUnion::exit_along(const Vec3& n, double limit, ThreadBuffers& buffers) const {
  DepthSettings settings;
  settings.bracket = Bracket::contact;
  settings.beyond = 0;
  Exit exit;
  exit.along = n;
  exit.length = deepest_pair_.depth.depth;
  const std::size_t count_b = b_.posed.size();
  const std::size_t count = a_.posed.size() * count_b;
  // Round and round, until all have been asked at one place.
  int stops = 0;
  for (std::size_t k = 0, free = 0; free < count; k = k + 1 < count ? k + 1 : 0) {
    const std::size_t i = k / count_b;
    const std::size_t j = k % count_b;
    ++free;
    const Vec3 way = exit.length * n;
    const btVector3 moved_by = to_bullet(way);
    const Child& child_a = a_.children[i];
    if (apart({child_a.box.lower + moved_by, child_a.box.upper + moved_by}, b_.children[j].box, 0)) continue;
    const PosedShape moved{a_.posed[i].shape, Pose::from_trusted_matrix(a_.posed[i].pose.rotation(),
                                                                        a_.posed[i].pose.translation() + way)};
    const double slack = seam_slack(moved, b_.posed[j]);
    settings.contact_tolerance = slack;
    const PenetrationDepth left = penetration_depth(moved, b_.posed[j], buffers.scratch, settings);
    if (left.contact != ContactClass::overlapping || left.depth <= slack) continue;
    const auto onwards = directional_depth(moved, b_.posed[j], n, buffers.scratch);
    if (!onwards || onwards.value().contact != ContactClass::overlapping || ++stops > kMostStops) return std::nullopt;
    exit.length += onwards.value().upper;
    if (exit.length > limit) return std::nullopt;
    exit.a = i;
    exit.b = j;
    exit.facet = onwards.value().normal;
    free = 1;
  }
  return stops > 0 ? std::optional<Exit>(exit) : std::nullopt;
}

std::optional<DeepUnion::Exit> DeepUnion::short_exit(const UnionQuestion& question, const Vec3& last,
                                                     ThreadBuffers& buffers) {
  const double least = deepest_pair_.depth.depth;
  std::optional<Exit> best;
  const auto offer = [&](const Vec3& n) {
    if (best && best->length <= kShortest * least) return;
    const double length = n.norm();
    if (!(length > 0) || !std::isfinite(length)) return;
    auto exit = exit_along(n / length, best ? best->length : kShort * least, buffers);
    if (!exit) return;
    best = exit;
    // Straight off what parts last it may be shorter still.
    if (auto turned = exit_along(exit->facet, exit->length, buffers)) best = turned;
  };
  offer(last);
  std::stable_sort(own_ways_.begin(), own_ways_.end(),
                   [](const OwnWay& x, const OwnWay& y) { return x.first > y.first; });
  const std::size_t count = std::min(own_ways_.size(), kMostOwnWays);
  for (std::size_t i = 0; i < count; ++i) offer(own_ways_[i].second);
  for (std::size_t i = 1; i < count; ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      offer(own_ways_[i].first * own_ways_[i].second + own_ways_[k].first * own_ways_[k].second);
    }
  }
  // Back the way it came.
  offer(linear_velocity(*question.b.getCollisionObject()) - linear_velocity(*question.a.getCollisionObject()));
  return best;
}

bool DeepUnion::lead_out(const Exit& exit, const UnionQuestion& question, ThreadBuffers& buffers, Way& way) const {
  const PosedShape& a = a_.posed[exit.a];
  const PosedShape& b = b_.posed[exit.b];
  const Vec3 by = exit.length * exit.along;
  const PosedShape moved{a.shape, Pose::from_trusted_matrix(a.pose.rotation(), a.pose.translation() + by)};
  DepthSettings settings;
  settings.bracket = Bracket::contact;
  PenetrationDepth there = penetration_depth(moved, b, buffers.scratch, settings);
  there.contact = ContactClass::overlapping;
  there.normal = exit.along;
  there.depth = exit.length;
  there.distance = 0;
  there.witness_a = there.witness_b - by;
  way.points =
      contact_manifold(a, b, there, static_cast<double>(question.threshold), buffers.manifold, DeepestPoint::as_lifted);
  way.a = a_.children[exit.a];
  way.b = b_.children[exit.b];
  return way.points.count > 0;
}

DeepUnion::Outcome DeepUnion::find_way(const UnionQuestion& question, SolverCore& core, ThreadBuffers& buffers,
                                       Vec3& last, Way& way) {
  if (!collect(question.a, question.b, kShort * deepest_pair_.depth.depth, question, core, a_) ||
      !collect(question.b, question.a, kShort * deepest_pair_.depth.depth, question, core, b_)) {
    return Outcome::unsupported;
  }
  if (deepest_pair_leads_out(buffers)) {
    way.points = contact_manifold(deepest_pair_.a, deepest_pair_.b, deepest_pair_.depth,
                                  static_cast<double>(question.threshold), buffers.manifold, DeepestPoint::as_lifted);
    way.a = child_of(a_.children, child_a_);
    way.b = child_of(b_.children, child_b_);
    last = deepest_pair_.depth.normal;
    return Outcome::found;
  }
  const bool few = a_.posed.size() * b_.posed.size() <= kMostPairs;
  if (const auto exit = few ? short_exit(question, last, buffers) : std::nullopt;
      exit && lead_out(*exit, question, buffers, way)) {
    last = exit->along;
    return Outcome::nearly;
  }
  // A way of length d meets no child that is farther than d from the other body now.
  for (double reach = 2 * deepest_;;) {
    if (!collect(question.a, question.b, reach, question, core, a_) ||
        !collect(question.b, question.a, reach, question, core, b_) || !a_.polytopes || !b_.polytopes) {
      return Outcome::unsupported;
    }
    if (a_.posed.size() * b_.posed.size() > kMostPairs) return Outcome::over_budget;
    UnionExit::Way shortest;
    switch (buffers.union_exit.find(a_.posed, b_.posed, {kMostFacets, kPoseRounding}, buffers.scratch, shortest)) {
      case UnionExit::Outcome::over_budget:
        return Outcome::over_budget;
      case UnionExit::Outcome::apart:
        return Outcome::apart;
      case UnionExit::Outcome::found:
        break;
    }
    const double length = shortest.by.norm();
    if (!(length > 0)) return Outcome::apart;
    if (length > reach) {
      reach = 2 * length;
      continue;
    }
    const double margins = a_.posed[shortest.a].shape->margin() + b_.posed[shortest.b].shape->margin();
    last = shortest.by / length;
    if (!lead_out({last, length + margins, shortest.a, shortest.b}, question, buffers, way)) return Outcome::apart;
    return Outcome::found;
  }
}

}  // namespace pd::detail

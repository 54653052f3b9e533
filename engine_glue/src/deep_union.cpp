#include "deep_union.hpp"

#include <algorithm>
#include <optional>

#include "pd/bullet/scalar.hpp"
#include "pd/compound/compound_depth.hpp"
#include "pd/contact/time_of_impact.hpp"
#include "solver_core.hpp"
#include "union_algorithm.hpp"
#include "union_piece.hpp"

namespace pd::detail {

namespace {

/// Of the radius of the smaller child: contacts that solvers leave behind are far below.
constexpr double kDeep = 0.25;
/// cos 45 degrees.
constexpr double kTogether = 0.7;
/// What one answer may take.
constexpr std::size_t kMostPairs = 1 << 10;
constexpr std::int64_t kMostFacets = 1 << 14;

/// Cores as one body in the world.
std::optional<Compound> union_of_cores(const std::vector<PosedShape>& posed) {
  std::vector<Compound::Part> parts;
  for (const PosedShape& child : posed) parts.push_back({ConvexShape(*child.shape->polytope()), child.pose});
  auto compound = Compound::from_parts(std::move(parts));
  if (!compound) return std::nullopt;
  return std::move(compound).value();
}

/// The child of this number, which is there.
const Child& child_of(const std::vector<Child>& children, int number) {
  return *std::find_if(children.begin(), children.end(), [&](const Child& child) { return child.index == number; });
}

}  // namespace

void DeepUnion::clear() {
  deepest_ = 0;
  deepest_pair_.depth.depth = 0;
  normals_.clear();
  torn_ = false;
}

void DeepUnion::add(const PairAnswer& answer, int child_a, int child_b, const ContactManifold& left) {
  if (answer.depth.contact != ContactClass::overlapping) return;
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
  for (const Child& child : side.children) {
    if (!child.shape->isConvex()) return false;
    const auto found = core.cache.find(static_cast<const btConvexShape&>(*child.shape), question.stamp);
    if (!found->body || found->body->polytope() == nullptr) return false;
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
    const Box box_a{child_a.box.lower + to_bullet(way), child_a.box.upper + to_bullet(way)};
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

DeepUnion::Outcome DeepUnion::find_way(const UnionQuestion& question, SolverCore& core, ThreadBuffers& buffers,
                                       Way& way) {
  if (!collect(question.a, question.b, deepest_pair_.depth.depth, question, core, a_) ||
      !collect(question.b, question.a, deepest_pair_.depth.depth, question, core, b_)) {
    return Outcome::unsupported;
  }
  if (deepest_pair_leads_out(buffers)) {
    way.points = contact_manifold(deepest_pair_.a, deepest_pair_.b, deepest_pair_.depth,
                                  static_cast<double>(question.threshold), buffers.manifold, DeepestPoint::as_lifted);
    way.a = child_of(a_.children, child_a_);
    way.b = child_of(b_.children, child_b_);
    return Outcome::found;
  }
  UnionSettings settings;
  settings.method = UnionMethod::facets;
  settings.max_facets = kMostFacets;
  // A way of length d meets no child that is farther than d from the other body now.
  for (double reach = 2 * deepest_;;) {
    if (!collect(question.a, question.b, reach, question, core, a_) ||
        !collect(question.b, question.a, reach, question, core, b_)) {
      return Outcome::unsupported;
    }
    if (a_.posed.size() * b_.posed.size() > kMostPairs) return Outcome::over_budget;
    const std::optional<Compound> a = union_of_cores(a_.posed);
    const std::optional<Compound> b = union_of_cores(b_.posed);
    if (!a || !b) return Outcome::unsupported;
    const auto found =
        penetration_depth(PosedCompound{&*a, Pose()}, PosedCompound{&*b, Pose()}, buffers.scratch, settings);
    if (!found) return found.error().code == ErrorCode::limit_exceeded ? Outcome::over_budget : Outcome::unsupported;
    const UnionDepth& depth = found.value();
    if (depth.contact != ContactClass::overlapping) return Outcome::apart;
    if (depth.depth > reach) {
      reach = 2 * depth.depth;
      continue;
    }
    const auto i = static_cast<std::size_t>(depth.part_a);
    const auto j = static_cast<std::size_t>(depth.part_b);
    const double margin_a = a_.posed[i].shape->margin();
    const double margin_b = b_.posed[j].shape->margin();
    PenetrationDepth rounded = depth;
    rounded.witness_a -= margin_a * depth.normal;
    rounded.witness_b += margin_b * depth.normal;
    rounded.depth += margin_a + margin_b;
    way.points = contact_manifold(a_.posed[i], b_.posed[j], rounded, static_cast<double>(question.threshold),
                                  buffers.manifold, DeepestPoint::as_lifted);
    way.a = a_.children[i];
    way.b = b_.children[j];
    return Outcome::found;
  }
}

}  // namespace pd::detail

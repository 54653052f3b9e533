#include "union/compound_contacts.hpp"

#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/CollisionDispatch/btCompoundCollisionAlgorithm.h>

#include <algorithm>
#include <vector>

#include "pair/passing_bodies.hpp"
#include "pair/solver_core.hpp"
#include "pair/step_reach.hpp"
#include "pd/bullet/scalar.hpp"
#include "pd/contact/time_of_impact.hpp"
#include "pd/union_contact/deep_union.hpp"
#include "pd/union_contact/piece_memories.hpp"
#include "pieces/compound_facts.hpp"
#include "shapes/compound_children.hpp"
#include "shapes/moving_body.hpp"
#include "union/pieces_in_result.hpp"

namespace pd::detail {

namespace {

/// What was over the budget is asked again after 1, 3, 7, ... steps, 31 at the most: it costs the budget each time.
constexpr int kMostRefusals = 5;

using ChildPair = std::pair<int, int>;  ///< places in the lists of near children

/// Returns the place of the child of this number in a list, or the list's end. Time O(n).
std::vector<Child>::const_iterator place_in(const std::vector<Child>& children, int number) {
  return std::find_if(children.begin(), children.end(), [&](const Child& child) { return child.index == number; });
}

/// Returns the place of a child in a list. If the list does not have it, it is copied from `all` to the end.
int place_of(int number, const std::vector<Child>& all, std::vector<Child>& children) {
  const auto found = place_in(children, number);
  const auto place = static_cast<int>(found - children.begin());
  if (found == children.end()) children.push_back(*place_in(all, number));
  return place;
}

/// Finds the children of two compounds that are near each other, by Bullet's trees.
class NearChildren final : public NearSides {
 public:
  explicit NearChildren(const UnionQuestion& question) : question_(question) {}
  bool collect(double reach, NearSide& a, NearSide& b) override {
    return collect(question_.a, question_.b, reach, a_, a) && collect(question_.b, question_.a, reach, b_, b);
  }
  [[nodiscard]] const std::vector<Child>& of_a() const { return a_.children; }
  [[nodiscard]] const std::vector<Child>& of_b() const { return b_.children; }

 private:
  struct Held {
    std::vector<Child> children;
    std::vector<std::shared_ptr<CachedShape>> shapes;  ///< keep the posed bodies alive
  };
  bool collect(const btCollisionObjectWrapper& body, const btCollisionObjectWrapper& other, double reach, Held& held,
               NearSide& side) const {
    const ChildBox box = box_of(*other.getCollisionShape(), other.getWorldTransform());
    children_near(body, other, box, static_cast<btScalar>(reach), held.children);
    held.shapes.clear();
    side = {};
    for (const Child& child : held.children) {
      if (!child.shape->isConvex()) return false;
      const auto found = question_.core.cache.find(static_cast<const btConvexShape&>(*child.shape), question_.stamp);
      if (!found->body) return false;
      const bool part = child.index >= 0;
      held.shapes.push_back(found);
      side.numbers.push_back(child.index);
      side.posed.push_back({(part && found->sharp ? found->sharp : found->body).get(), to_pd(child.pose)});
    }
    return !side.posed.empty();
  }

  const UnionQuestion& question_;
  Held a_, b_;
};

/// True if two children are proved to be still farther apart than a gap.
bool still_apart(const PieceMemory& memory, const Child& a, const Child& b, double gap) {
  if (!memory.parted.known()) return false;
  const CachedShape& shape = *memory.shapes[0];
  double radius = bounding_radius(*shape.body);
  if (shape.sharp) radius = std::max(radius, bounding_radius(*shape.sharp));
  return memory.parted.beyond(gap, to_pd(a.pose), to_pd(b.pose), radius);
}

/// Up to which gap the solver can need points of two children in this step: they lie within the threshold of both
/// boxes.
btScalar reach_of(const ChildBox& a, const ChildBox& b, const StepReach& reach, btScalar threshold) {
  btVector3 lower = a.lower, upper = a.upper;
  lower.setMax(b.lower);
  upper.setMin(b.upper);
  return reach.of_pieces_near(btScalar(0.5) * (lower + upper), btScalar(0.5) * (upper - lower).length() + threshold);
}

bool all_convex(const std::vector<Child>& children) {
  return std::all_of(children.begin(), children.end(), [](const Child& child) { return child.shape->isConvex(); });
}

/// Which points of two children a step can need, and up to which gap.
struct ChildReach {
  const StepReach& of_step;
  double gap;
};

class CompoundContacts final : public UnionContacts {
 public:
  bool find(const UnionQuestion& question, Patches& patches) override;
  [[nodiscard]] PointPieces pieces_of(int pair) const override {
    const auto [i, j] = pairs_[static_cast<std::size_t>(pair)];
    return {children_a_[static_cast<std::size_t>(i)], &children_b_[static_cast<std::size_t>(j)]};
  }

 private:
  /// Brings the shapes of the near children of the question's a (side 0) or b (1) up to date.
  void find_shapes(std::size_t side, const UnionQuestion& question) const;
  /// One pair's points. @return false where a child has no exact form
  bool ask(const ChildrenInResult& pair, const UnionQuestion& question, const ChildReach& reach, PieceMemory& memory,
           Patches& patches);
  /// Where children are deep in each other, the whole's shortest way out in place of what they said against it.
  void leave_as_one(const UnionQuestion& question, Patches& patches);

  std::vector<Child> children_a_;
  std::vector<Child> children_b_;
  std::vector<ChildPair> pairs_;
  PieceMemories<PieceMemory> memories_;
  DeepUnion deep_;
};

void CompoundContacts::find_shapes(std::size_t side, const UnionQuestion& question) const {
  const btCollisionShape& body = *(side == 0 ? question.a : question.b).getCollisionShape();
  for (const Child& child : side == 0 ? children_a_ : children_b_) {
    std::shared_ptr<CachedShape>& shape = question.memory.shape_of_child(side, child.index);
    if (child.index < 0) {
      question.core.find(static_cast<const btConvexShape&>(*child.shape), question.stamp, shape, question.buffers);
    } else {
      shape = question.buffers.near.facts().look_at({static_cast<const btCompoundShape&>(body), child.index},
                                                    question.core.cache);
    }
  }
}

bool CompoundContacts::find(const UnionQuestion& question, Patches& patches) {
  const auto& [a, b, seconds, threshold, stamp, result, core, buffers, memory] = question;
  pairs_.clear();
  memories_.begin();
  deep_.clear();
  const btTransform& pose_a = a.getWorldTransform();
  const btTransform& pose_b = b.getWorldTransform();
  if (!is_finite(pose_a) || !is_finite(pose_b)) return true;
  const btCollisionShape& shape_a = *a.getCollisionShape();
  const btCollisionShape& shape_b = *b.getCollisionShape();
  const ChildBox box_a = box_of(shape_a, pose_a), box_b = box_of(shape_b, pose_b);
  // Bullet's broadphase widens boxes, so that many pairs of boxes that overlap end here, and most others below.
  children_a_.clear();
  children_b_.clear();
  if (!apart(box_a, box_b, threshold)) {
    children_near(a, b, box_b, threshold, children_a_);
    if (!children_a_.empty()) children_near(b, a, box_a, threshold, children_b_);
  }
  if (children_b_.empty()) {
    memories_.end(memory.pieces);
    memory.union_pause = memory.union_refusals = 0;
    memory.union_way.setZero();
    return true;
  }
  if (!all_convex(children_a_) || !all_convex(children_b_)) return false;
  buffers.near.begin_pair(stamp);
  find_shapes(0, question);
  find_shapes(1, question);
  const StepReach step_reach(result, threshold, static_cast<btScalar>(seconds));
  for (std::size_t i = 0; i < children_a_.size(); ++i) {
    const Child& child_a = children_a_[i];
    for (std::size_t j = 0; j < children_b_.size(); ++j) {
      const Child& child_b = children_b_[j];
      if (apart(child_a.box, child_b.box, threshold)) continue;
      const btScalar gap = reach_of(child_a.box, child_b.box, step_reach, threshold);
      if (gap < threshold && apart(child_a.box, child_b.box, gap)) continue;
      if (gCompoundChildShapePairCallback != nullptr &&
          !gCompoundChildShapePairCallback(child_a.shape, child_b.shape)) {
        continue;
      }
      const std::uint64_t number = (static_cast<std::uint64_t>(static_cast<std::uint32_t>(child_a.index + 1)) << 32U) |
                                   static_cast<std::uint32_t>(child_b.index + 1);
      PieceMemory& remembered = memories_.take(memory.pieces, number);
      const auto& shape_of_a = memory.shape_of_child(0, child_a.index);
      const auto& shape_of_b = memory.shape_of_child(1, child_b.index);
      if (remembered.shapes[0] != shape_of_a || remembered.shapes[1] != shape_of_b) {
        remembered.shapes = {shape_of_a, shape_of_b};
        remembered.parted.forget();
      }
      if (still_apart(remembered, child_a, child_b, static_cast<double>(gap))) continue;
      pairs_.emplace_back(static_cast<int>(i), static_cast<int>(j));
      const ChildrenInResult pair(result, a, child_a, b, child_b);
      if (!ask(pair, question, {step_reach, static_cast<double>(gap)}, remembered, patches)) return false;
    }
  }
  memories_.end(memory.pieces);
  const double speed = (linear_velocity(*b.getCollisionObject()) - linear_velocity(*a.getCollisionObject())).norm();
  if (deep_.needed_in_step(static_cast<double>(question.time.seconds) * speed, pairs_.size())) {
    leave_as_one(question, patches);
  } else {
    memory.union_pause = memory.union_refusals = 0;
    memory.union_way.setZero();
  }
  return true;
}

void CompoundContacts::leave_as_one(const UnionQuestion& question, Patches& patches) {
  PairMemory& memory = question.memory;
  ThreadBuffers& buffers = question.buffers;
  if (memory.union_pause > 0) {
    --memory.union_pause;
    buffers.counters.deep_unions_left.add();
    return;
  }
  NearChildren near(question);
  const Vec3 back =
      linear_velocity(*question.b.getCollisionObject()) - linear_velocity(*question.a.getCollisionObject());
  DeepUnion::Way way;
  const DeepUnion::Outcome outcome =
      deep_.find_way({near, static_cast<double>(question.threshold), kPoseRounding, back},
                     {buffers.scratch, buffers.manifold, buffers.union_exit}, memory.union_way, way);
  if (outcome == DeepUnion::Outcome::over_budget) {
    memory.union_refusals = std::min(memory.union_refusals + 1, kMostRefusals);
    memory.union_pause = (1 << memory.union_refusals) - 1;
    buffers.counters.deep_unions_left.add();
    return;
  }
  memory.union_refusals = 0;
  if (outcome != DeepUnion::Outcome::found && outcome != DeepUnion::Outcome::nearly) return;
  buffers.counters.deep_unions.add();
  if (outcome == DeepUnion::Outcome::nearly) buffers.counters.deep_unions_nearly.add();
  // The children that touch last need not touch yet.
  const ChildPair last(place_of(way.piece_a, near.of_a(), children_a_),
                       place_of(way.piece_b, near.of_b(), children_b_));
  auto pair = std::find(pairs_.begin(), pairs_.end(), last);
  if (pair == pairs_.end()) pair = pairs_.insert(pairs_.end(), last);
  patches.keep_along(way.points.normal);
  patches.add(way.points, static_cast<int>(pair - pairs_.begin()), way.piece_a, way.piece_b);
}

bool CompoundContacts::ask(const ChildrenInResult& pair, const UnionQuestion& question, const ChildReach& reach,
                           PieceMemory& memory, Patches& patches) {
  ThreadBuffers& buffers = question.buffers;
  PairAnswer answer;
  const auto& shape_a = static_cast<const btConvexShape&>(*pair.a().getCollisionShape());
  const auto& shape_b = static_cast<const btConvexShape&>(*pair.b().getCollisionShape());
  const auto threshold = static_cast<double>(question.threshold);
  ContactManifold points;
  const PairQuestion asked{.a = shape_a,
                           .pose_a = pair.a().getWorldTransform(),
                           .b = shape_b,
                           .pose_b = pair.b().getWorldTransform(),
                           .shapes = memory.shapes,
                           .warm = &memory.warm,
                           .stamp = question.stamp,
                           .corners = {true, is_part(pair.a()), is_part(pair.b())},
                           .beyond = memory.met ? kAnyDistance : reach.gap,
                           .shapes_current = true};
  const auto outcome = question.core.contacts(asked, memory.met ? threshold : reach.gap, buffers, answer, points);
  if (outcome == SolverCore::Outcome::unsupported) return false;
  if (outcome != SolverCore::Outcome::answered) return true;
  memory.met = answer.depth.signed_distance() <= reach.gap;
  memory.parted.forget();
  if (!memory.met) memory.parted.note(answer.a.pose, answer.b.pose, answer.depth);
  reach.of_step.leave_out_idle(points);
  if (reach.of_step.against_fixed()) {
    FreshPoints fresh;
    set_fresh_points(points, fresh);
    if (on_one_line(fresh, kEdge * question.threshold) && pass_each_other(answer.a, answer.b, fresh, reach.of_step)) {
      points.count = 0;
    }
  }
  AskedPieces pieces = question.of_pieces(pair.a(), pair.b());
  count_covered(keep_uncovered(pieces.as(answer.a, answer.b), answer.depth, AnswerPoints::made, points), buffers);
  const auto [i, j] = pairs_.back();
  const int piece_a = children_a_[static_cast<std::size_t>(i)].index;
  const int piece_b = children_b_[static_cast<std::size_t>(j)].index;
  deep_.add({answer.depth, answer.a, answer.b, piece_a, piece_b}, points);
  patches.add(points, static_cast<int>(pairs_.size()) - 1, piece_a, piece_b);
  return true;
}

}  // namespace

std::unique_ptr<UnionContacts> compound_contacts() { return std::make_unique<CompoundContacts>(); }

}  // namespace pd::detail

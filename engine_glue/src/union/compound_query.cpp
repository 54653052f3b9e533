#include "union/compound_query.hpp"

#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/CollisionDispatch/btCompoundCompoundCollisionAlgorithm.h>

#include <algorithm>
#include <array>
#include <memory>
#include <typeinfo>
#include <vector>

#include "pair/manifold_points.hpp"
#include "pair/points_of_pieces.hpp"
#include "pair/solver_core.hpp"
#include "pd/bullet/scalar.hpp"
#include "shapes/compound_children.hpp"
#include "union/flat_wrapper.hpp"
#include "union/pieces_in_result.hpp"

namespace pd::detail {

namespace {

/// The manifold that a result wants to have while it takes points in: it says which body comes first.
class ManifoldOfQuery {
 public:
  ManifoldOfQuery(btDispatcher& dispatcher, const btCollisionObject* a, const btCollisionObject* b)
      : dispatcher_(dispatcher), manifold_(*dispatcher.getNewManifold(a, b)) {}
  ~ManifoldOfQuery() { dispatcher_.releaseManifold(&manifold_); }
  ManifoldOfQuery(const ManifoldOfQuery&) = delete;
  ManifoldOfQuery& operator=(const ManifoldOfQuery&) = delete;
  /// Empty.
  [[nodiscard]] btPersistentManifold& for_next_pair() {
    if (manifold_.getNumContacts() > 0) manifold_.clearManifold();
    return manifold_;
  }
  [[nodiscard]] btScalar breaking_threshold() const { return manifold_.getContactBreakingThreshold(); }

 private:
  btDispatcher& dispatcher_;
  btPersistentManifold& manifold_;
};

/// True if no point of one box is farther than that from any point of the other. Then it need not be asked whether the
/// bodies in them are.
bool lie_within(const ChildBox& a, const ChildBox& b, double reach) {
  btVector3 lower = a.lower, upper = a.upper;
  lower.setMin(b.lower);
  upper.setMax(b.upper);
  return static_cast<double>((upper - lower).length2()) <= reach * reach;
}

/// The near children of a body, and what those were converted to that have been asked.
struct NearOfBody {
  std::vector<Child> children;
  std::vector<std::shared_ptr<CachedShape>> shapes;
};

/// One query of two bodies.
class Query {
 public:
  Query(const btCollisionObjectWrapper& a, const btCollisionObjectWrapper& b, SolverCore& core,
        btDispatcher& dispatcher, btManifoldResult& result)
      : core_(core),
        dispatcher_(dispatcher),
        result_(result),
        manifold_(dispatcher, a.getCollisionObject(), b.getCollisionObject()),
        buffers_(core.buffers.lease()),
        stamp_(core.next_stamp()),
        flat_a_(a, core.flat_compounds, stamp_, memory_a_),
        flat_b_(b, core.flat_compounds, stamp_, memory_b_),
        a_(flat_a_.wrapper()),
        b_(flat_b_.wrapper()) {
    buffers_->near.begin_pair(stamp_);
  }

  void ask(const btDispatcherInfo& info) {
    const btTransform& pose_a = a_.getWorldTransform();
    const btTransform& pose_b = b_.getWorldTransform();
    if (!is_finite(pose_a) || !is_finite(pose_b)) return;
    const btScalar within = result_.m_closestPointDistanceThreshold;
    children_near(a_, b_, box_of(*b_.getCollisionShape(), pose_b), within, near_a_.children);
    if (near_a_.children.empty()) return;
    children_near(b_, a_, box_of(*a_.getCollisionShape(), pose_a), within, near_b_.children);
    if (near_b_.children.empty()) return;
    near_a_.shapes.resize(near_a_.children.size());
    near_b_.shapes.resize(near_b_.children.size());
    for (std::size_t i = 0; i < near_a_.children.size(); ++i) {
      const Child& child_a = near_a_.children[i];
      for (std::size_t j = 0; j < near_b_.children.size(); ++j) {
        const Child& child_b = near_b_.children[j];
        if (apart(child_a.box, child_b.box, within) || !may_meet(child_a, child_b)) continue;
        const ChildrenInResult pair(result_, a_, child_a, b_, child_b);
        const bool told = convert(near_a_, i) && convert(near_b_, j) && tell_points(pair, i, j, info);
        if (!told) tell_alone(pair, info);
      }
    }
  }

 private:
  /// @return false where the child is not convex
  bool convert(NearOfBody& near, std::size_t i) {
    const btCollisionShape& shape = *near.children[i].shape;
    if (!shape.isConvex()) return false;
    if (!near.shapes[i]) core_.find(static_cast<const btConvexShape&>(shape), stamp_, near.shapes[i], *buffers_);
    return true;
  }

  /// By the host's callbacks, in the order in which Bullet's algorithms call them.
  [[nodiscard]] bool may_meet(const Child& child_a, const Child& child_b) const {
    const bool of_a = a_.getCollisionShape()->isCompound(), of_b = b_.getCollisionShape()->isCompound();
    const btShapePairCallback callback =
        of_a && of_b ? gCompoundCompoundChildShapePairCallback : gCompoundChildShapePairCallback;
    if (callback == nullptr) return true;
    return of_b ? callback(child_a.shape, child_b.shape) : callback(child_b.shape, child_a.shape);
  }

  /// @return false where a child has no exact form
  bool tell_points(const ChildrenInResult& pair, std::size_t i, std::size_t j, const btDispatcherInfo& info) {
    shapes_ = {near_a_.shapes[i], near_b_.shapes[j]};
    const double contact_reach = static_cast<double>(manifold_.breaking_threshold());
    const double asked_reach =
        static_cast<double>(manifold_.breaking_threshold() + result_.m_closestPointDistanceThreshold);
    const PairQuestion asked{.a = static_cast<const btConvexShape&>(*pair.a().getCollisionShape()),
                             .pose_a = pair.a().getWorldTransform(),
                             .b = static_cast<const btConvexShape&>(*pair.b().getCollisionShape()),
                             .pose_b = pair.b().getWorldTransform(),
                             .shapes = shapes_,
                             .stamp = stamp_,
                             .corners = {true, is_part(pair.a()), is_part(pair.b())},
                             .beyond = lie_within(near_a_.children[i].box, near_b_.children[j].box, asked_reach)
                                           ? kAnyDistance
                                           : asked_reach,
                             .shapes_current = true};
    PairAnswer answer;
    ContactManifold points;
    const auto outcome = core_.contacts(asked, contact_reach, *buffers_, answer, points);
    if (outcome == SolverCore::Outcome::unsupported) return false;
    if (outcome != SolverCore::Outcome::answered) return true;
    keep_points_of_pieces({.a = pair.a(),
                           .b = pair.b(),
                           .contact_reach = contact_reach,
                           .asked_reach = asked_reach,
                           .seconds = static_cast<double>(info.m_timeStep),
                           .shapes = {core_.cache, stamp_}},
                          answer, *buffers_, points);
    if (points.count == 0) return true;
    btPersistentManifold& manifold = manifold_.for_next_pair();
    result_.setPersistentManifold(&manifold);
    FreshPoints fresh;
    set_fresh_points(points, fresh);
    if (fresh.count == 1) {
      const FreshPoint& point = fresh.points[0];
      result_.addContactPoint(point.normal, point.point_on_b, point.distance);
    } else {
      add_points(manifold, fresh, time_of(info), result_);
    }
    return true;
  }

  /// By an algorithm of the pair's own, as Bullet's compounds ask all of their children.
  void tell_alone(const ChildrenInResult& pair, const btDispatcherInfo& info) {
    const bool far = result_.m_closestPointDistanceThreshold > 0;
    btCollisionAlgorithm* const algorithm = dispatcher_.findAlgorithm(
        &pair.a(), &pair.b(), nullptr, far ? BT_CLOSEST_POINT_ALGORITHMS : BT_CONTACT_POINT_ALGORITHMS);
    if (algorithm == nullptr) return;
    algorithm->processCollision(&pair.a(), &pair.b(), info, &result_);
    algorithm->~btCollisionAlgorithm();
    dispatcher_.freeCollisionAlgorithm(algorithm);
  }

  SolverCore& core_;
  btDispatcher& dispatcher_;
  btManifoldResult& result_;
  ManifoldOfQuery manifold_;
  ThreadBufferPool::Lease buffers_;
  std::uint64_t stamp_;
  FlatMemory memory_a_, memory_b_;
  FlatWrapper flat_a_, flat_b_;
  const btCollisionObjectWrapper& a_;
  const btCollisionObjectWrapper& b_;
  NearOfBody near_a_, near_b_;
  std::array<std::shared_ptr<CachedShape>, 2> shapes_;
};

}  // namespace

void CompoundQuery::processCollision(const btCollisionObjectWrapper* a, const btCollisionObjectWrapper* b,
                                     const btDispatcherInfo& info, btManifoldResult* result) {
  SolverCore& core = world_.core();
  if (core.closed() || typeid(*result) == typeid(btManifoldResult)) {
    bullets_.process(a, b, info, result, Kind::table);
    return;
  }
  const ChildBox box_a = box_of(*a->getCollisionShape(), a->getWorldTransform());
  const ChildBox box_b = box_of(*b->getCollisionShape(), b->getWorldTransform());
  if (apart(box_a, box_b, result->m_closestPointDistanceThreshold)) return;
  Query(*a, *b, core, *m_dispatcher, *result).ask(info);
}

}  // namespace pd::detail

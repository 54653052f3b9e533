#include "compound_algorithm.hpp"

#include <BulletCollision/BroadphaseCollision/btDbvt.h>
#include <BulletCollision/CollisionDispatch/btCollisionConfiguration.h>
#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/CollisionDispatch/btCompoundCollisionAlgorithm.h>
#include <BulletCollision/CollisionDispatch/btConvexConvexAlgorithm.h>
#include <BulletCollision/CollisionShapes/btCompoundShape.h>

#include <algorithm>
#include <optional>
#include <vector>

#include "covered_contact.hpp"
#include "installation.hpp"
#include "patch_manifolds.hpp"
#include "pd/bullet/scalar.hpp"
#include "solver_core.hpp"

namespace pd::detail {

static_assert(sizeof(CompoundAlgorithm) <= sizeof(btConvexConvexAlgorithm));

namespace {

/// A child of a compound, or the convex body itself (index -1).
struct Child {
  const btCollisionShape* shape;
  btTransform pose;
  int index;
};

struct Box {
  btVector3 lower;
  btVector3 upper;
};

Box box_of(const btCollisionShape& shape, const btTransform& pose) {
  Box box;
  shape.getAabb(pose, box.lower, box.upper);
  return box;
}

bool apart(const Box& a, const Box& b, btScalar reach) {
  for (int i = 0; i < 3; ++i) {
    if (a.lower[i] > b.upper[i] + reach || b.lower[i] > a.upper[i] + reach) return true;
  }
  return false;
}

/// The children whose boxes come within `reach` of a box in the compound's frame, by number.
void children_near(const btCollisionObjectWrapper& wrapper, const Box& local, const Box& world, btScalar reach,
                   std::vector<Child>& children) {
  children.clear();
  const btCollisionShape& shape = *wrapper.getCollisionShape();
  const btTransform& pose = wrapper.getWorldTransform();
  if (!shape.isCompound()) {
    children.push_back({&shape, pose, -1});
    return;
  }
  const auto& compound = static_cast<const btCompoundShape&>(shape);
  const auto visit = [&](int i) {
    const Child child{compound.getChildShape(i), pose * compound.getChildTransform(i), i};
    if (!apart(box_of(*child.shape, child.pose), world, reach)) children.push_back(child);
  };
  if (const btDbvt* tree = compound.getDynamicAabbTree()) {
    struct Leaves : public btDbvt::ICollide {
      explicit Leaves(const decltype(visit)& function) : each(function) {}
      void Process(const btDbvtNode* leaf) override { each(leaf->dataAsInt); }
      const decltype(visit)& each;
    } leaves(visit);
    const btVector3 extra(reach, reach, reach);
    tree->collideTV(tree->m_root, btDbvtVolume::FromMM(local.lower - extra, local.upper + extra), leaves);
    // The tree's order depends on its history.
    std::sort(children.begin(), children.end(), [](const Child& x, const Child& y) { return x.index < y.index; });
  } else {
    for (int i = 0; i < compound.getNumChildShapes(); ++i) visit(i);
  }
}

/// Two children in place of their bodies in the result, as Bullet's own algorithms do, and back.
class ChildrenInResult {
 public:
  ChildrenInResult(btManifoldResult& result, const btCollisionObjectWrapper& a, const Child& child_a,
                   const btCollisionObjectWrapper& b, const Child& child_b)
      : result_(result), before_0_(result.getBody0Wrap()), before_1_(result.getBody1Wrap()) {
    wrap(a, child_a, wrapper_a_);
    wrap(b, child_b, wrapper_b_);
    const bool swapped = result.getBody0Internal() != a.getCollisionObject();
    place(swapped ? b : a, swapped ? child_b : child_a, swapped ? *wrapper_b_ : *wrapper_a_, true);
    place(swapped ? a : b, swapped ? child_a : child_b, swapped ? *wrapper_a_ : *wrapper_b_, false);
  }
  ~ChildrenInResult() {
    result_.setBody0Wrap(before_0_);
    result_.setBody1Wrap(before_1_);
  }
  ChildrenInResult(const ChildrenInResult&) = delete;
  ChildrenInResult& operator=(const ChildrenInResult&) = delete;

  [[nodiscard]] const btCollisionObjectWrapper& a() const { return *wrapper_a_; }
  [[nodiscard]] const btCollisionObjectWrapper& b() const { return *wrapper_b_; }

 private:
  static void wrap(const btCollisionObjectWrapper& body, const Child& child,
                   std::optional<btCollisionObjectWrapper>& wrapper) {
    const bool whole = child.index < 0;
    wrapper.emplace(whole ? body.m_parent : &body, child.shape, body.getCollisionObject(), child.pose,
                    whole ? body.m_partId : -1, whole ? body.m_index : child.index);
  }
  void place(const btCollisionObjectWrapper& body, const Child& child, const btCollisionObjectWrapper& wrapper,
             bool first) {
    const int part = child.index < 0 ? body.m_partId : -1;
    const int index = child.index < 0 ? body.m_index : child.index;
    if (first) {
      result_.setBody0Wrap(&wrapper);
      result_.setShapeIdentifiersA(part, index);
    } else {
      result_.setBody1Wrap(&wrapper);
      result_.setShapeIdentifiersB(part, index);
    }
  }

  btManifoldResult& result_;
  const btCollisionObjectWrapper* before_0_;
  const btCollisionObjectWrapper* before_1_;
  std::optional<btCollisionObjectWrapper> wrapper_a_;
  std::optional<btCollisionObjectWrapper> wrapper_b_;
};

using ChildPair = std::pair<int, int>;  ///< places in the lists of near children

class ChildrenOfPoint : public PointSurroundings {
 public:
  ChildrenOfPoint(btManifoldResult& result, const btCollisionObjectWrapper& a, const std::vector<Child>& children_a,
                  const btCollisionObjectWrapper& b, const std::vector<Child>& children_b,
                  const std::vector<ChildPair>& pairs)
      : result_(result), a_(a), children_a_(children_a), b_(b), children_b_(children_b), pairs_(pairs) {}
  void enter(int pair) override {
    const auto [i, j] = pairs_[static_cast<std::size_t>(pair)];
    inside_.emplace(result_, a_, children_a_[static_cast<std::size_t>(i)], b_,
                    children_b_[static_cast<std::size_t>(j)]);
  }
  void leave() override { inside_.reset(); }

 private:
  btManifoldResult& result_;
  const btCollisionObjectWrapper& a_;
  const std::vector<Child>& children_a_;
  const btCollisionObjectWrapper& b_;
  const std::vector<Child>& children_b_;
  const std::vector<ChildPair>& pairs_;
  std::optional<ChildrenInResult> inside_;
};

bool all_convex(const std::vector<Child>& children) {
  return std::all_of(children.begin(), children.end(), [](const Child& child) { return child.shape->isConvex(); });
}

}  // namespace

/// What lives between steps.
struct CompoundAlgorithm::State {
  State(const Installation& of, const btCollisionAlgorithmConstructionInfo& info)
      : installation(of), construction(info), manifolds(of.core(), *info.m_dispatcher1) {}
  ~State() {
    if (bullets != nullptr) {
      bullets->~btCollisionAlgorithm();
      construction.m_dispatcher1->freeCollisionAlgorithm(bullets);
    }
  }
  State(const State&) = delete;
  State& operator=(const State&) = delete;

  /// Fills `patches` with the points of all pairs of children.
  /// @return false where a child is not convex or has no exact form
  bool find_points(const btCollisionObjectWrapper& a, const btCollisionObjectWrapper& b, double seconds,
                   btScalar threshold, btManifoldResult& result);
  /// One pair's points. @return false where a child has no exact form
  bool ask(const ChildrenInResult& pair, double seconds, double threshold, std::uint64_t stamp, ChildPairMemory& memory,
           ThreadBuffers& buffers);
  /// What the pair remembers of two children: taken from last step's memory, or new.
  ChildPairMemory& remember(std::uint64_t number);

  const Installation& installation;
  btCollisionAlgorithmConstructionInfo construction;
  PatchManifolds manifolds;
  btCollisionAlgorithm* bullets = nullptr;  ///< answers for what we do not
  std::vector<Child> children_a;
  std::vector<Child> children_b;
  std::vector<ChildPair> pairs;
  std::vector<ChildPairMemory> fresh_memory;
  Patches patches;
  bool used = false;
};

CompoundAlgorithm::CompoundAlgorithm(const btCollisionAlgorithmConstructionInfo& info,
                                     const btCollisionObjectWrapper* a, const btCollisionObjectWrapper* b,
                                     const Installation& installation)
    : btActivatingCollisionAlgorithm(info, a, b), state_(std::make_unique<State>(installation, info)) {}

CompoundAlgorithm::~CompoundAlgorithm() = default;

btCollisionAlgorithm* CompoundAlgorithm::CreateFunc::CreateCollisionAlgorithm(
    btCollisionAlgorithmConstructionInfo& info, const btCollisionObjectWrapper* a, const btCollisionObjectWrapper* b) {
  const BulletSolverSettings& settings = installation.core().settings;
  const bool ours =
      !settings.takes_pair || settings.takes_pair(*a->getCollisionObject(), *b->getCollisionObject(), settings.user);
  if (!ours || !settings.unions_as_one) {
    return installation.bullets_algorithm(info, a, b);
  }
  void* memory = info.m_dispatcher1->allocateCollisionAlgorithm(sizeof(CompoundAlgorithm));
  return new (memory) CompoundAlgorithm(info, a, b, installation);
}

void CompoundAlgorithm::getAllContactManifolds(btManifoldArray& found) {
  state_->manifolds.append_to(found);
  if (state_->bullets != nullptr) state_->bullets->getAllContactManifolds(found);
}

void CompoundAlgorithm::processCollision(const btCollisionObjectWrapper* a, const btCollisionObjectWrapper* b,
                                         const btDispatcherInfo& info, btManifoldResult* result) {
  State& state = *state_;
  btPersistentManifold& first = state.manifolds.first(*a->getCollisionObject(), *b->getCollisionObject());
  result->setPersistentManifold(&first);
  const btScalar threshold = first.getContactBreakingThreshold() + result->m_closestPointDistanceThreshold;
  const bool closed = state.installation.core().closed();
  if (!closed && state.find_points(*a, *b, static_cast<double>(info.m_timeStep), threshold, *result)) {
    ChildrenOfPoint around(*result, *a, state.children_a, *b, state.children_b, state.pairs);
    state.manifolds.replace(state.patches, *result, around);
    return;
  }
  state.manifolds.clear();
  if (state.bullets == nullptr) state.bullets = state.installation.bullets_algorithm(state.construction, a, b);
  state.bullets->processCollision(a, b, info, result);
}

ChildPairMemory& CompoundAlgorithm::State::remember(std::uint64_t number) {
  std::vector<ChildPairMemory>& old = manifolds.memory().children;
  const auto found = std::lower_bound(old.begin(), old.end(), number,
                                      [](const ChildPairMemory& x, std::uint64_t n) { return x.children < n; });
  if (found != old.end() && found->children == number) {
    fresh_memory.push_back(std::move(*found));
    found->children = number;  // still found in its place by the search for the next
  } else {
    fresh_memory.emplace_back();
    fresh_memory.back().children = number;
  }
  return fresh_memory.back();
}

bool CompoundAlgorithm::State::find_points(const btCollisionObjectWrapper& a, const btCollisionObjectWrapper& b,
                                           double seconds, btScalar threshold, btManifoldResult& result) {
  patches.clear();
  pairs.clear();
  fresh_memory.clear();
  const btTransform& pose_a = a.getWorldTransform();
  const btTransform& pose_b = b.getWorldTransform();
  if (!is_finite(pose_a) || !is_finite(pose_b)) return true;
  const Box world_a = box_of(*a.getCollisionShape(), pose_a);
  const Box world_b = box_of(*b.getCollisionShape(), pose_b);
  children_near(a, box_of(*b.getCollisionShape(), pose_a.inverseTimes(pose_b)), world_b, threshold, children_a);
  children_near(b, box_of(*a.getCollisionShape(), pose_b.inverseTimes(pose_a)), world_a, threshold, children_b);
  if (!all_convex(children_a) || !all_convex(children_b)) return false;
  auto buffers = installation.core().buffers.lease();
  // What is used for the first time may belong to a query between two steps, whose shapes nobody compared.
  const std::uint64_t stamp = used ? installation.stamp() : 0;
  used = true;
  for (std::size_t i = 0; i < children_a.size(); ++i) {
    const Box box_a = box_of(*children_a[i].shape, children_a[i].pose);
    for (std::size_t j = 0; j < children_b.size(); ++j) {
      const Child& child_a = children_a[i];
      const Child& child_b = children_b[j];
      if (apart(box_a, box_of(*child_b.shape, child_b.pose), threshold)) continue;
      if (gCompoundChildShapePairCallback != nullptr &&
          !gCompoundChildShapePairCallback(child_a.shape, child_b.shape)) {
        continue;
      }
      const std::uint64_t number = (static_cast<std::uint64_t>(static_cast<std::uint32_t>(child_a.index + 1)) << 32U) |
                                   static_cast<std::uint32_t>(child_b.index + 1);
      pairs.emplace_back(static_cast<int>(i), static_cast<int>(j));
      const ChildrenInResult pair(result, a, child_a, b, child_b);
      if (!ask(pair, seconds, static_cast<double>(threshold), stamp, remember(number), *buffers)) return false;
    }
  }
  manifolds.memory().children.swap(fresh_memory);
  return true;
}

bool CompoundAlgorithm::State::ask(const ChildrenInResult& pair, double seconds, double threshold, std::uint64_t stamp,
                                   ChildPairMemory& memory, ThreadBuffers& buffers) {
  SolverCore& core = installation.core();
  PairAnswer answer;
  const auto& shape_a = static_cast<const btConvexShape&>(*pair.a().getCollisionShape());
  const auto& shape_b = static_cast<const btConvexShape&>(*pair.b().getCollisionShape());
  const auto outcome =
      core.answer(shape_a, pair.a().getWorldTransform(), shape_b, pair.b().getWorldTransform(),
                  {true, is_part(pair.a()), is_part(pair.b())}, stamp, memory.shapes, &memory.warm, buffers, answer);
  if (outcome == SolverCore::Outcome::unsupported) return false;
  if (outcome != SolverCore::Outcome::answered) return true;
  ContactManifold points =
      contact_manifold(answer.a, answer.b, answer.depth, threshold, buffers.manifold, DeepestPoint::as_lifted);
  keep_uncovered(pair.a(), pair.b(), answer, threshold, seconds, stamp, core, buffers, points);
  patches.add(points, static_cast<int>(pairs.size()) - 1, pair.a().m_index, pair.b().m_index);
  return true;
}

}  // namespace pd::detail

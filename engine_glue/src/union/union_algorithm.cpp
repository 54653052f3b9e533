#include "union/union_algorithm.hpp"

#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "pair/bullets_stand_in.hpp"
#include "pair/solver_core.hpp"
#include "union/flat_wrapper.hpp"
#include "union/pieces_in_result.hpp"

namespace pd::detail {

namespace {

using MakeContacts = std::unique_ptr<UnionContacts> (*)();

/// A search of one kind of union, and what it found.
struct UnionSearch {
  explicit UnionSearch(MakeContacts make) : kind(make), contacts(make()) {}

  MakeContacts kind;
  std::unique_ptr<UnionContacts> contacts;
  Patches patches;
};

/// The searches of a thread, one for each kind of union.
class ThreadSearches final : public WorkingMemory {
 public:
  static UnionSearch& of(ThreadBuffers& buffers, MakeContacts kind) {
    if (!buffers.unions) buffers.unions = std::make_unique<ThreadSearches>();
    auto& all = static_cast<ThreadSearches&>(*buffers.unions).searches_;
    const auto found = std::find_if(all.begin(), all.end(), [&](const auto& search) { return search->kind == kind; });
    if (found != all.end()) return **found;
    return *all.emplace_back(std::make_unique<UnionSearch>(kind));
  }

 private:
  std::vector<std::unique_ptr<UnionSearch>> searches_;
};

/// Puts the pieces of points into the result.
class PiecesOfPoints final : public PointSurroundings {
 public:
  PiecesOfPoints(const UnionQuestion& question, const UnionContacts& contacts)
      : question_(question), contacts_(contacts) {}
  void enter(int piece) override {
    const btCollisionObjectWrapper &a = question_.a, &b = question_.b;
    btManifoldResult& result = question_.result;
    const PointPieces pieces = contacts_.pieces_of(piece);
    child_of_a_.emplace(result, a, pieces.of_a);
    if (pieces.child_of_b != nullptr) {
      child_of_b_.emplace(result, b, *pieces.child_of_b);
    } else if (pieces.triangle != nullptr) {
      triangle_.emplace(result, b, *pieces.triangle);
    } else {
      whole_b_.emplace(result, b);
    }
  }
  void leave() override {
    child_of_a_.reset();
    child_of_b_.reset();
    triangle_.reset();
    whole_b_.reset();
  }
  [[nodiscard]] bool numbers(int piece, PieceNumbers& out) const override {
    const btCollisionObjectWrapper &a = question_.a, &b = question_.b;
    const auto& [of_a, child, triangle] = contacts_.pieces_of(piece);
    const int part_b = child != nullptr ? part_of_child(b, *child) : triangle != nullptr ? triangle->part : b.m_partId;
    const int index_b = child != nullptr      ? index_of_child(b, *child)
                        : triangle != nullptr ? triangle->index
                                              : b.m_index;
    out = {part_of_child(a, of_a), index_of_child(a, of_a), part_b, index_b};
    if (question_.result.getBody0Internal() != a.getCollisionObject()) {
      out = {out.part_1, out.index_1, out.part_0, out.index_0};
    }
    return true;
  }

 private:
  const UnionQuestion& question_;
  const UnionContacts& contacts_;
  std::optional<ChildInResult> child_of_a_, child_of_b_;
  std::optional<TriangleInResult> triangle_;
  std::optional<PieceInResult> whole_b_;
};

/// Keeps what the first of a step's trials found for those after it.
struct FoundInTrial {
  explicit FoundInTrial(MakeContacts kind) : search(kind) {}

  UnionSearch search;
  std::uint64_t trials = 0;  ///< `SolverCore::trials`
  btScalar threshold = 0;
  btTransform pose_a, pose_b;
  UnionPairMemory memory;  ///< as it was left
};

}  // namespace

/// What lives between steps.
struct UnionAlgorithm::State {
  State(const SolverInWorld& of, const btCollisionAlgorithmConstructionInfo& info, const Kind& k)
      : world(of), kind(k), manifolds(of.core(), *info.m_dispatcher1), bullets(of, *info.m_dispatcher1) {}

  const SolverInWorld& world;
  Kind kind;
  PatchManifolds manifolds;
  BulletsStandIn bullets;
  FlatMemory flat[2];  ///< of the question's a and b
  bool used = false;

  /// Finds the pair's patches. Trials that begin at one state take what the first one found: it is the longest, so that
  /// no point is missing. @return null: Bullet's own algorithm has to answer
  UnionSearch* find(const UnionQuestion& question);

 private:
  std::unique_ptr<FoundInTrial> found_;  ///< in worlds that are stepped in trials
};

UnionSearch* UnionAlgorithm::State::find(const UnionQuestion& question) {
  const std::uint64_t trials = question.core.trials();
  UnionPairMemory& memory = manifolds.memory();
  if (trials == 0) {
    if (found_) found_->trials = 0;
    UnionSearch& search = ThreadSearches::of(question.buffers, kind.contacts);
    search.patches.clear();
    const bool found = search.contacts->find(question, search.patches);
    return found ? &search : nullptr;
  }
  const btTransform& pose_a = question.a.getWorldTransform();
  const btTransform& pose_b = question.b.getWorldTransform();
  if (!found_) found_ = std::make_unique<FoundInTrial>(kind.contacts);
  if (trials == found_->trials && question.threshold == found_->threshold && pose_a == found_->pose_a &&
      pose_b == found_->pose_b) {
    memory = found_->memory;
    return &found_->search;
  }
  UnionSearch& search = found_->search;
  search.patches.clear();
  found_->trials = 0;
  if (!search.contacts->find(question, search.patches)) return nullptr;
  found_->trials = trials;
  found_->threshold = question.threshold;
  found_->pose_a = pose_a;
  found_->pose_b = pose_b;
  found_->memory = memory;
  return &search;
}

UnionAlgorithm::UnionAlgorithm(const btCollisionAlgorithmConstructionInfo& info, const btCollisionObjectWrapper* a,
                               const btCollisionObjectWrapper* b, const SolverInWorld& world, const Kind& kind)
    : AlgorithmShell(info, a, b), state_(std::make_unique<State>(world, info, kind)) {}

UnionAlgorithm::~UnionAlgorithm() = default;

void UnionAlgorithm::getAllContactManifolds(btManifoldArray& manifolds) {
  state_->manifolds.append_to(manifolds);
  state_->bullets.append_to(manifolds);
}

void UnionAlgorithm::processCollision(const btCollisionObjectWrapper* a, const btCollisionObjectWrapper* b,
                                      const btDispatcherInfo& info, btManifoldResult* result) {
  State& s = *state_;
  const btCollisionObjectWrapper& one = s.kind.swapped ? *b : *a;
  const btCollisionObjectWrapper& other = s.kind.swapped ? *a : *b;
  btPersistentManifold& first = s.manifolds.first(*one.getCollisionObject(), *other.getCollisionObject());
  result->setPersistentManifold(&first);
  if (!s.world.core().closed()) {
    // A stamp of its own has each shape compared once if nobody compared them in this step.
    SolverCore& core = s.world.core();
    const std::uint64_t of_step = s.world.stamp(info, !std::exchange(s.used, true));
    const std::uint64_t stamp = of_step != 0 ? of_step : core.next_stamp();
    const btScalar threshold = first.getContactBreakingThreshold() + result->m_closestPointDistanceThreshold;
    const FlatWrapper flat_one(one, core.flat_compounds, stamp, s.flat[0]);
    const FlatWrapper flat_other(other, core.flat_compounds, stamp, s.flat[1]);
    auto buffers = core.buffers.lease();
    const UnionQuestion question{.a = flat_one.wrapper(),
                                 .b = flat_other.wrapper(),
                                 .time = time_of(info),
                                 .threshold = threshold,
                                 .stamp = stamp,
                                 .result = *result,
                                 .core = core,
                                 .buffers = *buffers,
                                 .memory = s.manifolds.memory()};
    if (UnionSearch* search = s.find(question)) {
      s.bullets.release();
      PiecesOfPoints pieces(question, *search->contacts);
      s.manifolds.replace(search->patches, question.time, *result, pieces);
      search->contacts->remember_chosen(search->patches, question.memory);
      return;
    }
  }
  s.manifolds.clear();
  s.bullets.process(a, b, info, result);
}

}  // namespace pd::detail

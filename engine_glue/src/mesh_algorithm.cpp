#include "mesh_algorithm.hpp"

#include <BulletCollision/BroadphaseCollision/btBroadphaseProxy.h>
#include <BulletCollision/CollisionDispatch/btCollisionConfiguration.h>
#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/CollisionDispatch/btConvexConvexAlgorithm.h>
#include <BulletCollision/CollisionShapes/btConcaveShape.h>
#include <BulletCollision/CollisionShapes/btTriangleCallback.h>
#include <BulletCollision/CollisionShapes/btTriangleShape.h>

#include <algorithm>
#include <optional>
#include <vector>

#include "covered_contact.hpp"
#include "installation.hpp"
#include "manifold_points.hpp"
#include "patches.hpp"
#include "pd/bullet/scalar.hpp"
#include "solver_core.hpp"

namespace pd::detail {

static_assert(sizeof(MeshAlgorithm) <= sizeof(btConvexConvexAlgorithm));

namespace {

struct MetTriangle {
  btVector3 corners[3];
  int part;
  int index;
};

/// Collects the triangles that a box meets, but for those without area, which have no surface, and those whose corners
/// are no numbers.
class TrianglesInBox : public btTriangleCallback {
 public:
  TrianglesInBox(const btVector3& lower, const btVector3& upper, std::vector<MetTriangle>& met)
      : lower_(lower), upper_(upper), met_(met) {}

  void processTriangle(btVector3* corners, int part, int index) override {
    for (int axis = 0; axis < 3; ++axis) {
      const auto [low, high] = std::minmax({corners[0][axis], corners[1][axis], corners[2][axis]});
      if (low > upper_[axis] || high < lower_[axis]) return;
    }
    const Vec3 across = (to_pd(corners[1]) - to_pd(corners[0])).cross(to_pd(corners[2]) - to_pd(corners[0]));
    if (!across.allFinite() || across.isZero(0)) {
      ++skipped;
      return;
    }
    met_.push_back({{corners[0], corners[1], corners[2]}, part, index});
  }

  int skipped = 0;

 private:
  btVector3 lower_;
  btVector3 upper_;
  std::vector<MetTriangle>& met_;
};

/// Puts the triangle in place of the mesh in the result, as Bullet's own algorithm does, and back.
class TriangleInResult {
 public:
  TriangleInResult(btManifoldResult& result, const btCollisionObjectWrapper& mesh, const MetTriangle& triangle,
                   btScalar margin)
      : result_(result),
        shape_(triangle.corners[0], triangle.corners[1], triangle.corners[2]),
        wrapper_(&mesh, &shape_, mesh.getCollisionObject(), mesh.getWorldTransform(), triangle.part, triangle.index),
        mesh_is_a_(result.getBody0Internal() == mesh.getCollisionObject()),
        before_(mesh_is_a_ ? result.getBody0Wrap() : result.getBody1Wrap()) {
    shape_.setMargin(margin);
    if (mesh_is_a_) {
      result.setBody0Wrap(&wrapper_);
      result.setShapeIdentifiersA(triangle.part, triangle.index);
    } else {
      result.setBody1Wrap(&wrapper_);
      result.setShapeIdentifiersB(triangle.part, triangle.index);
    }
  }
  ~TriangleInResult() {
    if (mesh_is_a_) {
      result_.setBody0Wrap(before_);
    } else {
      result_.setBody1Wrap(before_);
    }
  }
  TriangleInResult(const TriangleInResult&) = delete;
  TriangleInResult& operator=(const TriangleInResult&) = delete;

  [[nodiscard]] const btTriangleShape& shape() const { return shape_; }
  [[nodiscard]] const btCollisionObjectWrapper& wrapper() const { return wrapper_; }

 private:
  btManifoldResult& result_;
  btTriangleShape shape_;
  btCollisionObjectWrapper wrapper_;
  bool mesh_is_a_;
  const btCollisionObjectWrapper* before_;
};

/// The number of a triangle's feature pair among those of all triangles.
std::int64_t feature_of(const MetTriangle& triangle, std::int64_t feature) {
  const auto number = static_cast<std::uint64_t>(feature) * 0x9E3779B97F4A7C15ULL +
                      static_cast<std::uint64_t>(static_cast<std::uint32_t>(triangle.part)) * 0xC2B2AE3D27D4EB4FULL +
                      static_cast<std::uint64_t>(static_cast<std::uint32_t>(triangle.index)) * 0x165667B19E3779F9ULL;
  return static_cast<std::int64_t>(number >> 11U);
}

}  // namespace

/// What lives between steps.
struct MeshAlgorithm::State {
  struct Kept {
    btPersistentManifold* manifold;
    PairMemory memory;
  };

  State(const Installation& of, bool is_swapped, const btCollisionAlgorithmConstructionInfo& info)
      : installation(of), swapped(is_swapped), construction(info) {}
  ~State() {
    for (const auto& kept : manifolds) {
      installation.core().pairs.remove(kept->manifold);
      construction.m_dispatcher1->releaseManifold(kept->manifold);
    }
    if (bullets != nullptr) {
      bullets->~btCollisionAlgorithm();
      construction.m_dispatcher1->freeCollisionAlgorithm(bullets);
    }
  }
  State(const State&) = delete;
  State& operator=(const State&) = delete;

  Kept& manifold(std::size_t i, const btCollisionObjectWrapper& convex, const btCollisionObjectWrapper& mesh) {
    while (i >= manifolds.size()) {
      manifolds.push_back(std::make_unique<Kept>());
      manifolds.back()->manifold =
          construction.m_dispatcher1->getNewManifold(convex.getCollisionObject(), mesh.getCollisionObject());
      installation.core().pairs.add(manifolds.back()->manifold, &manifolds.back()->memory);
    }
    return *manifolds[i];
  }

  const Installation& installation;
  bool swapped;
  btCollisionAlgorithmConstructionInfo construction;
  std::vector<std::unique_ptr<Kept>> manifolds;
  btCollisionAlgorithm* bullets = nullptr;  ///< answers for what we do not
  std::vector<MetTriangle> triangles;
  Patches patches;
  bool used = false;

  void clear() const {
    for (const auto& kept : manifolds) kept->manifold->clearManifold();
  }

  /// Fills `patches` with the points of all triangles.
  /// @return false where the body has no exact form
  bool find_points(const btCollisionObjectWrapper& convex, const btCollisionObjectWrapper& mesh, double seconds,
                   btScalar threshold, btManifoldResult& result);
  void keep_points(const btCollisionObjectWrapper& convex, const btCollisionObjectWrapper& mesh,
                   btManifoldResult& result);
};

MeshAlgorithm::MeshAlgorithm(const btCollisionAlgorithmConstructionInfo& info, const btCollisionObjectWrapper* a,
                             const btCollisionObjectWrapper* b, const Installation& installation, bool swapped)
    : btActivatingCollisionAlgorithm(info, a, b), state_(std::make_unique<State>(installation, swapped, info)) {}

MeshAlgorithm::~MeshAlgorithm() = default;

bool MeshAlgorithm::takes(int proxy_type) {
  return proxy_type == TRIANGLE_MESH_SHAPE_PROXYTYPE || proxy_type == SCALED_TRIANGLE_MESH_SHAPE_PROXYTYPE ||
         proxy_type == MULTIMATERIAL_TRIANGLE_MESH_PROXYTYPE || proxy_type == FAST_CONCAVE_MESH_PROXYTYPE ||
         proxy_type == TERRAIN_SHAPE_PROXYTYPE || proxy_type == CUSTOM_CONCAVE_SHAPE_TYPE;
}

btCollisionAlgorithm* MeshAlgorithm::CreateFunc::CreateCollisionAlgorithm(btCollisionAlgorithmConstructionInfo& info,
                                                                          const btCollisionObjectWrapper* a,
                                                                          const btCollisionObjectWrapper* b) {
  const BulletSolverSettings& settings = installation.core().settings;
  const bool ours =
      !settings.takes_pair || settings.takes_pair(*a->getCollisionObject(), *b->getCollisionObject(), settings.user);
  if (!ours || !settings.unions_as_one) {
    return installation.dispatcher()
        ->getCollisionConfiguration()
        ->getCollisionAlgorithmCreateFunc(a->getCollisionShape()->getShapeType(),
                                          b->getCollisionShape()->getShapeType())
        ->CreateCollisionAlgorithm(info, a, b);
  }
  void* memory = info.m_dispatcher1->allocateCollisionAlgorithm(sizeof(MeshAlgorithm));
  return new (memory) MeshAlgorithm(info, a, b, installation, m_swapped);
}

void MeshAlgorithm::getAllContactManifolds(btManifoldArray& manifolds) {
  for (const auto& kept : state_->manifolds) manifolds.push_back(kept->manifold);
  if (state_->bullets != nullptr) state_->bullets->getAllContactManifolds(manifolds);
}

void MeshAlgorithm::processCollision(const btCollisionObjectWrapper* a, const btCollisionObjectWrapper* b,
                                     const btDispatcherInfo& info, btManifoldResult* result) {
  State& state = *state_;
  const btCollisionObjectWrapper& convex = state.swapped ? *b : *a;
  const btCollisionObjectWrapper& mesh = state.swapped ? *a : *b;
  // Of the pair, as Bullet keeps it; there is always one, so that hosts see the pair.
  btPersistentManifold* first = state.manifold(0, convex, mesh).manifold;
  result->setPersistentManifold(first);
  const btScalar threshold = first->getContactBreakingThreshold() + result->m_closestPointDistanceThreshold;
  const bool closed = state.installation.core().closed();
  if (!closed && state.find_points(convex, mesh, static_cast<double>(info.m_timeStep), threshold, *result)) {
    state.keep_points(convex, mesh, *result);
    result->setPersistentManifold(first);
    return;
  }
  state.clear();
  if (state.bullets == nullptr) {
    state.bullets = state.installation.dispatcher()
                        ->getCollisionConfiguration()
                        ->getCollisionAlgorithmCreateFunc(a->getCollisionShape()->getShapeType(),
                                                          b->getCollisionShape()->getShapeType())
                        ->CreateCollisionAlgorithm(state.construction, a, b);
  }
  state.bullets->processCollision(a, b, info, result);
}

bool MeshAlgorithm::State::find_points(const btCollisionObjectWrapper& convex, const btCollisionObjectWrapper& mesh,
                                       double seconds, btScalar threshold, btManifoldResult& result) {
  SolverCore& core = installation.core();
  const auto& body = static_cast<const btConvexShape&>(*convex.getCollisionShape());
  const auto& concave = static_cast<const btConcaveShape&>(*mesh.getCollisionShape());
  const btTransform& pose = mesh.getWorldTransform();
  triangles.clear();
  patches.clear();
  if (!is_finite(convex.getWorldTransform()) || !is_finite(pose)) return true;
  btVector3 lower;
  btVector3 upper;
  body.getAabb(pose.inverseTimes(convex.getWorldTransform()), lower, upper);
  const btScalar reach = concave.getMargin() + threshold;
  const btVector3 extra(reach, reach, reach);
  TrianglesInBox collector(lower - extra, upper + extra, triangles);
  concave.processAllTriangles(&collector, lower - extra, upper + extra);
  auto buffers = core.buffers.lease();
  if (collector.skipped > 0) buffers->counters.skipped_triangles.add(collector.skipped);
  // What is used for the first time may belong to a query between two steps, whose shapes nobody compared.
  const std::uint64_t stamp = used ? installation.stamp() : 0;
  used = true;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const TriangleInResult triangle(result, mesh, triangles[i], concave.getMargin());
    PairAnswer answer;
    const auto outcome = core.answer(body, convex.getWorldTransform(), triangle.shape(), pose,
                                     {true, is_part(convex), false}, stamp, buffers->recent, nullptr, *buffers, answer);
    if (outcome == SolverCore::Outcome::unsupported) return false;
    if (outcome != SolverCore::Outcome::answered) continue;
    ContactManifold points = contact_manifold(answer.a, answer.b, answer.depth, static_cast<double>(threshold),
                                              buffers->manifold, DeepestPoint::as_lifted);
    keep_uncovered(convex, triangle.wrapper(), answer, static_cast<double>(threshold), seconds, stamp, core, *buffers,
                   points);
    for (int k = 0; k < points.count; ++k) {
      points.points[static_cast<std::size_t>(k)].feature_id =
          feature_of(triangles[i], points.points[static_cast<std::size_t>(k)].feature_id);
    }
    patches.add(points, static_cast<int>(i));
  }
  return true;
}

void MeshAlgorithm::State::keep_points(const btCollisionObjectWrapper& convex, const btCollisionObjectWrapper& mesh,
                                       btManifoldResult& result) {
  class Around : public PointSurroundings {
   public:
    Around(const State& state, const btCollisionObjectWrapper& mesh, btManifoldResult& result, const Patch& patch)
        : state_(state), mesh_(mesh), result_(result), patch_(patch) {}
    void enter(int point) override {
      const int piece = patch_.pieces[static_cast<std::size_t>(point)];
      inside_.emplace(result_, mesh_, state_.triangles[static_cast<std::size_t>(piece)],
                      mesh_.getCollisionShape()->getMargin());
    }
    void leave() override { inside_.reset(); }

   private:
    const State& state_;
    const btCollisionObjectWrapper& mesh_;
    btManifoldResult& result_;
    const Patch& patch_;
    std::optional<TriangleInResult> inside_;
  };

  const double threshold = static_cast<double>(manifolds[0]->manifold->getContactBreakingThreshold());
  patches.choose(kPatches, threshold);
  // A patch goes to the manifold that had its normal last step, as far as those go round.
  std::array<int, kPatches> taken{};
  for (std::size_t m = 0; m < manifolds.size(); ++m) {
    const btPersistentManifold& manifold = *manifolds[m]->manifold;
    taken[m] = manifold.getNumContacts() == 0 ? -1 : patches.claim(to_pd(manifold.getContactPoint(0).m_normalWorldOnB));
  }
  for (std::size_t m = 0; m < static_cast<std::size_t>(kPatches); ++m) {
    int patch = m < manifolds.size() ? taken[m] : -1;
    if (patch < 0) patch = patches.claim_any();
    if (patch < 0) {
      if (m < manifolds.size()) manifolds[m]->manifold->clearManifold();
      continue;
    }
    Kept& kept = manifold(m, convex, mesh);
    const Patch& chosen = patches[patch];
    Around around(*this, mesh, result, chosen);
    result.setPersistentManifold(kept.manifold);
    replace_points(*kept.manifold, kept.memory, chosen.fresh, result, around);
  }
}

}  // namespace pd::detail

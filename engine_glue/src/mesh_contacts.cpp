#include "mesh_contacts.hpp"

#include <BulletCollision/BroadphaseCollision/btBroadphaseProxy.h>
#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/CollisionShapes/btConcaveShape.h>
#include <BulletCollision/CollisionShapes/btTriangleCallback.h>
#include <BulletCollision/CollisionShapes/btTriangleShape.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "covered_contact.hpp"
#include "flat_ground.hpp"
#include "met_triangle.hpp"
#include "one_sided.hpp"
#include "pd/bullet/scalar.hpp"
#include "piece_memories.hpp"
#include "rounded_box.hpp"
#include "solver_core.hpp"

namespace pd::detail {

namespace {

/// Of a way out of a triangle: so much farther, a body that follows it is off the triangle beyond rounding.
constexpr double kClear = 1 + 0x1p-6;

/// Triangles of one step that a pair remembers, some 2 KB each; those met after them begin anew each step.
constexpr std::size_t kMostRemembered = 128;

std::uint64_t number_of(const MetTriangle& triangle) {
  return (static_cast<std::uint64_t>(static_cast<std::uint32_t>(triangle.part)) << 32U) |
         static_cast<std::uint32_t>(triangle.index);
}

/// Collects the triangles within reach of a body, but for those without area, which have no surface, and those whose
/// corners are no numbers.
class TrianglesInReach : public btTriangleCallback {
 public:
  /// @param pose  of the body in the mesh's frame
  /// @param reach  how far from the body triangles count
  TrianglesInReach(const btConvexShape& body, const btTransform& pose, btScalar reach, std::vector<MetTriangle>& met)
      : box_(rounded_box(body, pose)), met_(met) {
    body.getAabb(pose, lower_, upper_);
    lower_ -= btVector3(reach, reach, reach);
    upper_ += btVector3(reach, reach, reach);
    // What rounding of the boxes may add.
    reach_ = 1.001 * static_cast<double>(reach) + kRounding * (to_pd(lower_).norm() + to_pd(upper_).norm());
  }

  void processTriangle(btVector3* corners, int part, int index) override {
    for (int axis = 0; axis < 3; ++axis) {
      const auto [low, high] = std::minmax({corners[0][axis], corners[1][axis], corners[2][axis]});
      if (low > upper_[axis] || high < lower_[axis]) return;
    }
    const Vec3 points[3] = {to_pd(corners[0]), to_pd(corners[1]), to_pd(corners[2])};
    const Vec3 across = (points[1] - points[0]).cross(points[2] - points[0]);
    if (!across.allFinite() || across.isZero(0)) {
      ++skipped;
      return;
    }
    if (out_of_reach(box_, points, across, reach_, kRounding)) return;
    met_.push_back({{corners[0], corners[1], corners[2]}, part, index});
  }

  [[nodiscard]] const btVector3& lower() const { return lower_; }
  [[nodiscard]] const btVector3& upper() const { return upper_; }

  int skipped = 0;

 private:
  static constexpr double kRounding = sizeof(btScalar) == sizeof(float) ? 0x1p-20 : 0x1p-48;

  RoundedBox box_;
  btVector3 lower_;
  btVector3 upper_;
  double reach_;
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

class TriangleOfPoint : public PointSurroundings {
 public:
  TriangleOfPoint(const btCollisionObjectWrapper& mesh, btManifoldResult& result,
                  const std::vector<MetTriangle>& triangles)
      : mesh_(mesh), result_(result), triangles_(triangles) {}
  void enter(int triangle) override {
    inside_.emplace(result_, mesh_, triangles_[static_cast<std::size_t>(triangle)],
                    mesh_.getCollisionShape()->getMargin());
  }
  void leave() override { inside_.reset(); }

 private:
  const btCollisionObjectWrapper& mesh_;
  btManifoldResult& result_;
  const std::vector<MetTriangle>& triangles_;
  std::optional<TriangleInResult> inside_;
};

class MeshContacts final : public UnionContacts {
 public:
  bool find(const UnionQuestion& question, SolverCore& core, PairMemory& memory, Patches& patches) override;
  void replace(const UnionQuestion& question, Patches& patches, PatchManifolds& manifolds) override {
    TriangleOfPoint around(question.b, question.result, triangles_);
    manifolds.replace(patches, static_cast<btScalar>(question.seconds), question.result, around);
  }

 private:
  SolverCore::Outcome ask(const UnionQuestion& question, const TriangleInResult& triangle, const btTransform& pose_a,
                          PieceMemory* memory, SolverCore& core, ThreadBuffers& buffers, PairAnswer& answer) const;
  void add_fronts(const UnionQuestion& question, SolverCore& core, ThreadBuffers& buffers, Patches& patches);

  std::vector<MetTriangle> triangles_;
  FlatGround flat_;
  PieceMemories memories_;
  OneSided one_sided_;
};

/// The side from which the corners run counter-clockwise (unit, in the world). Requires an area.
Vec3 front_of(const MetTriangle& triangle, const btTransform& pose) {
  const Vec3 across = (to_pd(triangle.corners[1]) - to_pd(triangle.corners[0]))
                          .cross(to_pd(triangle.corners[2]) - to_pd(triangle.corners[0]));
  return (to_pd(pose).rotation() * across).normalized();
}

SolverCore::Outcome MeshContacts::ask(const UnionQuestion& question, const TriangleInResult& triangle,
                                      const btTransform& pose_a, PieceMemory* memory, SolverCore& core,
                                      ThreadBuffers& buffers, PairAnswer& answer) const {
  const auto& body = static_cast<const btConvexShape&>(*question.a.getCollisionShape());
  const bool met = memory != nullptr && memory->met;
  const PairQuestion asked{body,
                           pose_a,
                           triangle.shape(),
                           question.b.getWorldTransform(),
                           {true, is_part(question.a), false},
                           met ? kAnyDistance : static_cast<double>(question.threshold),
                           question.stamp,
                           memory != nullptr ? memory->shapes : buffers.recent,
                           memory != nullptr ? &memory->warm : nullptr};
  return core.answer(asked, buffers, answer);
}

/// The contacts along the fronts of triangles that the body stands through, where none of the others leads off them.
void MeshContacts::add_fronts(const UnionQuestion& question, SolverCore& core, ThreadBuffers& buffers,
                              Patches& patches) {
  const btTransform& pose = question.a.getWorldTransform();
  for (const OneSided::Behind& behind : one_sided_.behind()) {
    const MetTriangle& met = triangles_[static_cast<std::size_t>(behind.triangle)];
    const TriangleInResult triangle(question.result, question.b, met, question.b.getCollisionShape()->getMargin());
    PairAnswer answer;
    const std::vector<Vec3>& ways = one_sided_.ways_out();
    const bool left = std::any_of(ways.begin(), ways.end(), [&](const Vec3& way) {
      // A little farther than touching, which rounding would decide.
      const btTransform moved(pose.getBasis(), pose.getOrigin() + to_bullet(Vec3(kClear * way)));
      return ask(question, triangle, moved, nullptr, core, buffers, answer) == SolverCore::Outcome::answered &&
             answer.depth.contact != ContactClass::overlapping;
    });
    if (left || ask(question, triangle, pose, nullptr, core, buffers, answer) != SolverCore::Outcome::answered)
      continue;
    const ContactManifold points =
        along_front(triangle.wrapper(), answer, behind.front, static_cast<double>(question.threshold), buffers);
    patches.add(points, behind.triangle, met.part, met.index);
  }
}

bool MeshContacts::find(const UnionQuestion& question, SolverCore& core, PairMemory& memory, Patches& patches) {
  const btCollisionObjectWrapper& convex = question.a;
  const btCollisionObjectWrapper& mesh = question.b;
  const auto& body = static_cast<const btConvexShape&>(*convex.getCollisionShape());
  const auto& concave = static_cast<const btConcaveShape&>(*mesh.getCollisionShape());
  const btTransform& pose = mesh.getWorldTransform();
  const auto threshold = static_cast<double>(question.threshold);
  const bool one_sided = core.settings.one_sided_meshes;
  triangles_.clear();
  one_sided_.clear();
  memories_.begin();
  if (!is_finite(convex.getWorldTransform()) || !is_finite(pose)) return true;
  TrianglesInReach collector(body, pose.inverseTimes(convex.getWorldTransform()),
                             concave.getMargin() + question.threshold, triangles_);
  concave.processAllTriangles(&collector, collector.lower(), collector.upper());
  auto buffers = core.buffers.lease();
  buffers->cover.near.begin_pair(question.stamp);
  if (collector.skipped > 0) buffers->counters.skipped_triangles.add(collector.skipped);
  if (flat_.find(question, triangles_, core, *buffers, memory, patches)) {
    memories_.end(memory.pieces);
    return true;
  }
  for (std::size_t i = 0; i < triangles_.size(); ++i) {
    const TriangleInResult triangle(question.result, mesh, triangles_[i], concave.getMargin());
    PairAnswer answer;
    PieceMemory* const remembered =
        i < kMostRemembered ? &memories_.take(memory.pieces, number_of(triangles_[i])) : nullptr;
    const auto outcome = ask(question, triangle, convex.getWorldTransform(), remembered, core, *buffers, answer);
    if (outcome == SolverCore::Outcome::unsupported) return false;
    if (outcome != SolverCore::Outcome::answered) continue;
    if (remembered != nullptr) remembered->met = answer.depth.signed_distance() <= threshold;
    const Vec3 front = one_sided ? front_of(triangles_[i], pose) : Vec3(Vec3::Zero());
    if (one_sided && !one_sided_.admit(answer, front, static_cast<int>(i))) continue;
    ContactManifold points =
        contact_manifold(answer.a, answer.b, answer.depth, threshold, buffers->manifold, DeepestPoint::as_lifted);
    keep_uncovered(convex, triangle.wrapper(), answer, front, threshold, question.seconds, question.stamp, core,
                   *buffers, points);
    patches.add(points, static_cast<int>(i), triangles_[i].part, triangles_[i].index);
  }
  memories_.end(memory.pieces);
  if (one_sided) add_fronts(question, core, *buffers, patches);
  return true;
}

}  // namespace

std::unique_ptr<UnionContacts> mesh_contacts() { return std::make_unique<MeshContacts>(); }

bool takes_mesh(int proxy_type) {
  return proxy_type == TRIANGLE_MESH_SHAPE_PROXYTYPE || proxy_type == SCALED_TRIANGLE_MESH_SHAPE_PROXYTYPE ||
         proxy_type == MULTIMATERIAL_TRIANGLE_MESH_PROXYTYPE || proxy_type == FAST_CONCAVE_MESH_PROXYTYPE ||
         proxy_type == TERRAIN_SHAPE_PROXYTYPE || proxy_type == CUSTOM_CONCAVE_SHAPE_TYPE;
}

}  // namespace pd::detail

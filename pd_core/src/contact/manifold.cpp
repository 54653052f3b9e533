#include "pd/contact/manifold.hpp"

#include <algorithm>
#include <cmath>

#include "contact/manifold_clip.hpp"
#include "contact/manifold_reduce.hpp"
#include "contact/supporting_face.hpp"

namespace pd {

namespace detail {

struct ManifoldBuffers {
  SupportingFace face_a;
  SupportingFace face_b;
  ClipBuffers clip;
  std::vector<ContactPoint> points;
  std::vector<Vec2> flat;  ///< the points across the normal
};

}  // namespace detail

namespace {

using detail::ClipVertex;
using detail::ContactFrame;
using detail::Vec2;

/// Two corners closer than this times the size of the intersection are one: a thousandth of a percent of a face is
/// below what a solver can feel, and far above the rounding of a cut.
constexpr double kMergeRatio = 1e-6;
/// Of the breaking threshold: depths of a resting contact differ by so much from frame to frame.
constexpr double kNoiseRatio = 1e-3;

/// The corners of the intersection, lifted to both faces, that are no farther apart than the threshold.
/// @return the depth of the deepest of them.
double lift_corners(const ContactFrame& frame, double margin_a, double margin_b, double signed_depth,
                    double breaking_threshold, double size, detail::ManifoldBuffers& buffers) {
  auto& points = buffers.points;
  auto& flat = buffers.flat;
  points.clear();
  flat.clear();
  double deepest = -breaking_threshold;
  for (const ClipVertex& vertex : buffers.clip.polygon) {
    const double height_a = face_height(buffers.face_a, frame, vertex.point) - margin_a;
    const double height_b = face_height(buffers.face_b, frame, vertex.point) + margin_b;
    // Along n no pair is deeper than the bodies are; what the lifted heights say beyond that is rounding.
    const double depth = std::min(height_b - height_a, signed_depth);
    const bool repeated = std::any_of(flat.begin(), flat.end(), [&](const Vec2& p) {
      return (p - vertex.point).cwiseAbs().maxCoeff() <= kMergeRatio * size;
    });
    if (depth < -breaking_threshold || repeated) continue;
    const Vec3 on_b = frame.origin + vertex.point.x() * frame.u + vertex.point.y() * frame.w + height_b * frame.n;
    points.push_back({on_b - depth * frame.n, on_b, depth, vertex.id});
    flat.push_back(vertex.point);
    deepest = std::max(deepest, depth);
  }
  return deepest;
}

}  // namespace

ManifoldScratch::ManifoldScratch() : buffers_(std::make_unique<detail::ManifoldBuffers>()) {}
ManifoldScratch::~ManifoldScratch() = default;
ManifoldScratch::ManifoldScratch(ManifoldScratch&&) noexcept = default;
ManifoldScratch& ManifoldScratch::operator=(ManifoldScratch&&) noexcept = default;

ContactManifold contact_manifold(const PosedShape& a, const PosedShape& b, const PenetrationDepth& answer,
                                 double breaking_threshold, ManifoldScratch& scratch) {
  ContactManifold manifold;
  manifold.normal = answer.normal;
  const double signed_depth = answer.contact == ContactClass::separated ? -answer.distance : answer.depth;
  if (signed_depth < -breaking_threshold) return manifold;
  // 1. The faces that meet, cut by each other across the normal.
  auto& buffers = scratch.buffers();
  const Vec3& n = answer.normal;
  const ContactFrame frame(n, 0.5 * (answer.witness_a + answer.witness_b));
  detail::supporting_face(a, -n, answer.feature_a, buffers.face_a);
  detail::supporting_face(b, n, answer.feature_b, buffers.face_b);
  detail::intersect_faces(buffers.face_a, buffers.face_b, frame, buffers.clip);

  // 2. Its corners, lifted back to both faces.
  double size = 0;
  for (const ClipVertex& vertex : buffers.clip.polygon) size = std::max(size, vertex.point.cwiseAbs().maxCoeff());
  const double deepest =
      lift_corners(frame, a.shape->margin(), b.shape->margin(), signed_depth, breaking_threshold, size, buffers);

  // 3. The witnesses join where the corners miss them by more than the noise of a resting contact.
  auto& points = buffers.points;
  auto& flat = buffers.flat;
  const double noise = std::max(kNoiseRatio * breaking_threshold, kMergeRatio * size);
  std::size_t first = points.size();
  if (points.empty() || deepest < signed_depth - noise) {
    const Vec3 on_b = answer.witness_b;
    points.push_back({on_b - signed_depth * n, on_b, signed_depth, detail::make_id(detail::IdKind::witness, 0, 0)});
    flat.push_back(frame.flatten(on_b));
  } else {
    first = detail::deepest_point(points, flat, deepest, noise);
  }

  // 4. Four of them.
  if (points.size() > 4) detail::reduce_to_four(points, flat, first);
  manifold.count = static_cast<int>(points.size());
  std::copy(points.begin(), points.end(), manifold.points.begin());
  return manifold;
}

}  // namespace pd

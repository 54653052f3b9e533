#include "pd/contact/manifold.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "contact/manifold_buffers.hpp"
#include "contact/manifold_reduce.hpp"
#include "depth/pair/scaled_shape.hpp"

namespace pd {

namespace {

using detail::ClipVertex;
using detail::ContactFrame;
using detail::LiftedCorner;
using detail::Vec2;

/// How far points may lie off their bodies for those who judge, as a share of the lengths at hand: far above rounding.
constexpr double kJudged = 1e-8;

/// The corners of the intersection, lifted to both faces, that are no farther apart than the threshold.
/// @return the depth of the deepest of them.
double lift_corners(const ContactFrame& frame, double margin_a, double margin_b, double signed_depth,
                    double breaking_threshold, double size, detail::ManifoldBuffers& buffers) {
  auto& lifted = buffers.lifted;
  auto& flat = buffers.flat;
  lifted.clear();
  flat.clear();
  double deepest = -breaking_threshold;
  if (buffers.clip.polygon.empty()) return deepest;
  const detail::FaceHeight heights_a(buffers.face_a, frame), heights_b(buffers.face_b, frame);
  for (const ClipVertex& vertex : buffers.clip.polygon) {
    const double height_a = heights_a.above(vertex.point) - margin_a;
    const double height_b = heights_b.above(vertex.point) + margin_b;
    // Along n no pair is deeper than the bodies are; what the lifted heights say beyond that is rounding.
    const double depth = std::min(height_b - height_a, signed_depth);
    // Points of a whole rim lie apart.
    const bool repeated = !buffers.clip.whole_rim && std::any_of(flat.begin(), flat.end(), [&](const Vec2& p) {
      return (p - vertex.point).cwiseAbs().maxCoeff() <= detail::kMergeRatio * size;
    });
    if (depth < -breaking_threshold || repeated) continue;
    lifted.push_back({height_b, depth, vertex.id});
    flat.push_back(vertex.point);
    deepest = std::max(deepest, depth);
  }
  return deepest;
}

/// Gives the deepest point the bodies' depth, which is known: what its lifted corner misses of it is halved between its
/// two ends. The other points keep their own: a face that lies tilted on another rests on the differences between them.
void end_at_depth(ContactManifold& manifold, double signed_depth) {
  const Vec3& n = manifold.normal;
  const auto deepest = std::max_element(manifold.points.begin(), manifold.points.begin() + manifold.count,
                                        [](const ContactPoint& x, const ContactPoint& y) { return x.depth < y.depth; });
  deepest->position_b += 0.5 * (signed_depth - deepest->depth) * n;
  deepest->position_a = deepest->position_b - signed_depth * n;
  deepest->depth = signed_depth;
}

ContactManifold manifold_of(const PosedShape& a, const PosedShape& b, const PenetrationDepth& answer,
                            double breaking_threshold, DeepestPoint deepest_point, detail::ManifoldBuffers& buffers) {
  ContactManifold manifold;
  manifold.normal = answer.normal;
  const double signed_depth = -answer.signed_distance();
  if (signed_depth < -breaking_threshold) return manifold;
  // 1. The faces that meet, cut by each other across the normal.
  const Vec3& n = answer.normal;
  const ContactFrame frame(n, 0.5 * (answer.witness_a + answer.witness_b));
  detail::supporting_face(a, -n, answer.feature_a, buffers.face_a);
  detail::supporting_face(b, n, answer.feature_b, buffers.face_b);
  // An engine lets two edges rest on each other that are nearly parallel; who judges is given points of both bodies.
  const bool judged = deepest_point == DeepestPoint::on_bodies;
  detail::intersect_faces(buffers.face_a, buffers.face_b, frame, judged ? kJudged : HUGE_VAL, buffers.clip);

  // 2. Its corners, lifted back to both faces.
  double size = 0;
  for (const ClipVertex& vertex : buffers.clip.polygon) size = std::max(size, vertex.point.cwiseAbs().maxCoeff());
  const double deepest =
      lift_corners(frame, a.shape->margin(), b.shape->margin(), signed_depth, breaking_threshold, size, buffers);

  // 3. The witnesses join where the corners miss them by more than the noise of a resting contact, or of rounding.
  auto& lifted = buffers.lifted;
  auto& flat = buffers.flat;
  const double reach = size + answer.witness_a.cwiseAbs().maxCoeff() + answer.depth;
  const double noise =
      judged ? kJudged * reach : std::max(detail::kNoiseRatio * breaking_threshold, detail::kMergeRatio * size);
  constexpr std::int64_t kWitness = detail::make_id(detail::IdKind::witness, 0, 0);
  std::size_t first = lifted.size();
  if (lifted.empty() || deepest < signed_depth - noise) {
    lifted.push_back({0, signed_depth, kWitness});
    flat.push_back(frame.flatten(answer.witness_b));
  } else {
    first = detail::deepest_point(std::span<const LiftedCorner>(lifted), flat, deepest, noise);
  }

  // 4. Four of them.
  if (lifted.size() > 4) {
    detail::reduce_to_four(std::span<LiftedCorner>(lifted), flat, first);
    lifted.resize(4);
  }
  manifold.count = static_cast<int>(lifted.size());
  for (std::size_t i = 0; i < lifted.size(); ++i) {
    const LiftedCorner& corner = lifted[i];
    const Vec3 on_b =
        corner.id == kWitness
            ? answer.witness_b
            : Vec3(frame.origin + flat[i].x() * frame.u + flat[i].y() * frame.w + corner.height_b * frame.n);
    manifold.points[i] = {on_b - corner.depth * n, on_b, corner.depth, corner.id};
  }
  if (deepest_point != DeepestPoint::as_lifted) end_at_depth(manifold, signed_depth);
  return manifold;
}

/// Whether two polytopes count the same vertices and facets.
bool same_vertices(const PosedShape& x, const PosedShape& y) {
  const ConvexPolytope* const p = x.shape->polytope();
  const ConvexPolytope* const q = y.shape->polytope();
  return !p || (p->num_vertices() == q->num_vertices() && p->num_facets() == q->num_facets());
}

}  // namespace

ManifoldScratch::ManifoldScratch() : buffers_(std::make_unique<detail::ManifoldBuffers>()) {}
ManifoldScratch::~ManifoldScratch() = default;
ManifoldScratch::ManifoldScratch(ManifoldScratch&&) noexcept = default;
ManifoldScratch& ManifoldScratch::operator=(ManifoldScratch&&) noexcept = default;

ContactManifold contact_manifold(const PosedShape& a, const PosedShape& b, const PenetrationDepth& answer,
                                 double breaking_threshold, ManifoldScratch& scratch, DeepestPoint deepest) {
  const int exponent = detail::extreme_exponent(a, b);
  if (exponent == 0) return manifold_of(a, b, answer, breaking_threshold, deepest, scratch.buffers());
  // At size 1, where areas are ordinary numbers.
  const Vec3& origin = a.pose.translation();
  const detail::ScaledPair near(a, b, exponent);
  PenetrationDepth near_answer = answer;
  near_answer.witness_a -= origin;
  near_answer.witness_b -= origin;
  detail::scale_answer(near_answer, -exponent);
  // A body far smaller than the pair may lose vertices at that size: its features are searched anew there.
  if (!same_vertices(a, near.a())) near_answer.feature_a = Feature();
  if (!same_vertices(b, near.b())) near_answer.feature_b = Feature();
  ContactManifold manifold = manifold_of(near.a(), near.b(), near_answer, std::ldexp(breaking_threshold, -exponent),
                                         deepest, scratch.buffers());
  for (int i = 0; i < manifold.count; ++i) {
    ContactPoint& point = manifold.points[static_cast<std::size_t>(i)];
    point.position_a = detail::times_power(point.position_a, exponent) + origin;
    point.position_b = detail::times_power(point.position_b, exponent) + origin;
    point.depth = std::ldexp(point.depth, exponent);
  }
  return manifold;
}

}  // namespace pd

#include "pd/contact/halfspace_contact.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "contact/manifold_buffers.hpp"
#include "contact/manifold_reduce.hpp"
#include "depth/difference/smooth_difference.hpp"
#include "numeric/unit_roundoff.hpp"
#include "pd/contact/time_of_impact.hpp"
#include "shape/support/polytope_support.hpp"

namespace pd {

namespace {

/// Of a support along a unit vector: a product with a rotation, a support of its own error of 6u, a product and sums of
/// four terms; curved cores with a quotient and a root.
constexpr double kRounding = 48 * detail::kUnitRoundoff;

/// The point of the core farthest in a direction, and its vertex.
struct Farthest {
  Vec3 point;
  Feature feature;
};

Farthest farthest(const PosedShape& body, const Vec3& direction) {
  if (const ConvexPolytope* polytope = body.shape->polytope()) {
    const int v = detail::support_vertex(*polytope, body.pose.rotation().transpose() * direction, -1);
    return {body.pose.apply(polytope->vertex(v)), {Feature::Kind::vertex, v, -1}};
  }
  const Mat3 rotation = body.pose.nearest_rotation();
  const Vec3 local = detail::support_point(body.shape->core(), rotation.transpose() * direction);
  return {rotation * local + body.pose.translation(), Feature()};
}

}  // namespace

HalfspaceContact halfspace_contact(const PosedShape& a, const Halfspace3& ground, double breaking_threshold,
                                   ManifoldScratch& scratch) {
  const Vec3& n = ground.normal;
  const double margin = a.shape->margin();
  const auto height = [&](const Vec3& point) { return n.dot(point) - ground.offset; };

  // 1. The signed distance.
  HalfspaceContact out;
  out.manifold.normal = n;
  const Farthest lowest = farthest(a, -n);
  const double distance = height(lowest.point) - margin;
  const double error = kRounding * (a.pose.translation().norm() + bounding_radius(*a.shape) + std::abs(ground.offset));
  out.lower = distance - error;
  out.upper = distance + error;
  if (out.lower > 0) {
    out.contact = ContactClass::separated;
  } else {
    out.contact = out.upper < 0 ? ContactClass::overlapping : ContactClass::touching;
  }
  if (distance > breaking_threshold) return out;
  out.highest = height(farthest(a, n).point) + margin;

  // 2. The corners of the face that looks down, each as deep as it is.
  detail::ManifoldBuffers& buffers = scratch.buffers();
  auto& points = buffers.points;
  auto& flat = buffers.flat;
  points.clear();
  flat.clear();
  const detail::ContactFrame frame(n, lowest.point);
  double deepest = -breaking_threshold;
  double size = 0;
  const auto push = [&](const Vec3& on_core, double depth, std::int64_t id) {
    const Vec3 on_a = on_core - margin * n;
    points.push_back({on_a, on_a + depth * n, depth, id});
    flat.push_back(frame.flatten(on_core));
    size = std::max(size, flat.back().cwiseAbs().maxCoeff());
    deepest = std::max(deepest, depth);
  };
  detail::supporting_face(a, -n, lowest.feature, buffers.face_a);
  const bool single = buffers.face_a.vertices.size() == 1;  // the lowest point itself
  for (const detail::FaceVertex& vertex : buffers.face_a.vertices) {
    if (single) break;
    // No point of the body lies lower than its lowest; what a corner says beyond that is rounding.
    const double depth = std::min(margin - height(vertex.point), -distance);
    if (depth >= -breaking_threshold) {
      push(vertex.point, depth, detail::make_id(detail::IdKind::vertex_a, vertex.id, 0));
    }
  }

  // 3. The lowest point joins where they miss it by more than the noise of a resting contact; four of them.
  const double noise = std::max(detail::kNoiseRatio * breaking_threshold, detail::kMergeRatio * size);
  std::size_t first = points.size();
  if (points.empty() || deepest < -distance - noise) {
    push(lowest.point, -distance, detail::make_id(detail::IdKind::witness, 0, 0));
  } else {
    first = detail::deepest_point(std::span<const ContactPoint>(points), flat, deepest, noise);
  }
  if (points.size() > 4) {
    detail::reduce_to_four(std::span<ContactPoint>(points), flat, first);
    points.resize(4);
  }
  out.manifold.count = static_cast<int>(points.size());
  std::copy(points.begin(), points.end(), out.manifold.points.begin());
  return out;
}

}  // namespace pd

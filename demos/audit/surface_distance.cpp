#include "audit/surface_distance.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "audit/exact_depth.hpp"

namespace pd::audit {

namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();

double distance_to_segment(const Vec3& p, const Vec3& from, const Vec3& to) {
  const Vec3 edge = to - from;
  const double t = std::clamp(edge.dot(p - from) / edge.squaredNorm(), 0.0, 1.0);
  return (p - from - t * edge).norm();
}

/// To the polygon of a facet whose plane lies `height` below the point.
double distance_to_facet(const ConvexPolytope& polytope, int facet, const Vec3& p, double height) {
  const auto corners = polytope.facet_vertices(facet);
  const Vec3& normal = polytope.facet_normal(facet);
  double least = kFar;
  bool inside = true;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec3 from = polytope.vertex(corners[i]);
    const Vec3 to = polytope.vertex(corners[(i + 1) % corners.size()]);
    if (normal.cross(to - from).dot(p - from) < 0) {
      inside = false;
      least = std::min(least, distance_to_segment(p, from, to));
    }
  }
  return inside ? std::abs(height) : least;
}

/// Negative inside, by the distance from the boundary. Requires facets.
double signed_distance(const ConvexPolytope& polytope, const Vec3& p) {
  double highest = -kFar;
  double outside = kFar;
  for (int f = 0; f < polytope.num_facets(); ++f) {
    const double height = polytope.facet_normal(f).dot(p - polytope.vertex(polytope.facet_vertices(f)[0]));
    highest = std::max(highest, height);
    // The nearest point lies in a facet that sees the point; of a flat body both sides hold it.
    if (height >= 0) outside = std::min(outside, distance_to_facet(polytope, f, p, height));
  }
  return highest < 0 ? highest : outside;
}

double polytope_distance(const ConvexPolytope& polytope, const Vec3& p) {
  if (polytope.num_facets() > 0) return signed_distance(polytope, p);
  if (polytope.num_vertices() == 1) return (p - polytope.vertex(0)).norm();
  return distance_to_segment(p, polytope.vertex(0), polytope.vertex(1));
}

Vec3 into_frame(const Pose& pose, const Vec3& point) {
  const Vec3 offset = point - pose.translation();
  // A recorded matrix is a rotation only up to 1e-6.
  return pose.is_quaternion() ? Vec3(pose.rotation().transpose() * offset) : Vec3(pose.rotation().inverse() * offset);
}

double halfspace_distance(const Halfspace3& halfspace, const Pose& pose, const Vec3& point) {
  return std::abs(halfspace.normal.dot(into_frame(pose, point)) - halfspace.offset) / halfspace.normal.norm();
}

const RecordedShape& point_shape() {
  static const RecordedShape shape = [] {
    RecordedShape made;
    made.kind = "convex";
    made.body.emplace(ConvexShape(*ConvexPolytope::from_points(std::vector<Vec3>{Vec3::Zero()})));
    return made;
  }();
  return shape;
}

}  // namespace

double surface_distance(const RecordedShape& shape, const Pose& pose, const Vec3& point, double delta,
                        Scratch& scratch) {
  if (shape.halfspace) return halfspace_distance(*shape.halfspace, pose, point);
  if (!shape.is_union && shape.convex().polytope() != nullptr) {
    return std::abs(polytope_distance(*shape.convex().polytope(), into_frame(pose, point)) - shape.convex().margin());
  }
  RecordedContact contact;
  contact.a = &point_shape();
  contact.b = &shape;
  contact.pose_a = Pose::from_trusted_matrix(Mat3::Identity(), point);
  contact.pose_b = pose;
  const auto answer = body_depth(contact, delta, scratch);
  if (!answer) return kFar;
  return answer->contact == ContactClass::separated ? answer->distance_lower : answer->lower;
}

}  // namespace pd::audit

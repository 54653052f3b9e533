#include "support/shared_solid.hpp"

#include <vector>

namespace pd::demo {

namespace {

struct Plane {
  Vec3 normal;
  double offset;  ///< <normal, x> <= offset inside
};

struct Posed {
  std::vector<Vec3> vertices;
  std::vector<Plane> planes;
};

Posed place(const ConvexPolytope& polytope, const Pose& pose) {
  Posed posed;
  for (int v = 0; v < polytope.num_vertices(); ++v) posed.vertices.push_back(pose.apply(polytope.vertex(v)));
  for (int f = 0; f < polytope.num_facets(); ++f) {
    const Vec3 normal = pose.rotation() * polytope.facet_normal(f);
    const auto vertex = static_cast<std::size_t>(polytope.facet_vertices(f)[0]);
    posed.planes.push_back({normal, normal.dot(posed.vertices[vertex])});
  }
  return posed;
}

/// Adds what of the edges (and so of the vertices) of one body lies inside the other: each edge, clipped.
void add_clipped_edges(const ConvexPolytope& body, const Posed& posed, const Posed& other, std::vector<Vec3>& points) {
  for (int h = 0; h < body.num_half_edges(); ++h) {
    const int from = body.half_edge(h).origin;
    const int to = body.target(h);
    if (from > to) continue;
    const Vec3& p = posed.vertices[static_cast<std::size_t>(from)];
    const Vec3& q = posed.vertices[static_cast<std::size_t>(to)];
    double enter = 0;
    double leave = 1;
    for (const Plane& plane : other.planes) {
      const double at_p = plane.normal.dot(p) - plane.offset;
      const double at_q = plane.normal.dot(q) - plane.offset;
      if (at_p > 0 && at_q > 0) leave = -1;
      if (at_p > 0 && at_q <= 0) enter = std::max(enter, at_p / (at_p - at_q));
      if (at_p <= 0 && at_q > 0) leave = std::min(leave, at_p / (at_p - at_q));
      if (enter > leave) break;
    }
    if (enter > leave) continue;
    points.push_back(p + enter * (q - p));
    points.push_back(p + leave * (q - p));
  }
}

}  // namespace

std::optional<ConvexPolytope> shared_solid(const ConvexPolytope& a, const Pose& pose_a, const ConvexPolytope& b,
                                           const Pose& pose_b) {
  if (a.affine_dimension() < 3 || b.affine_dimension() < 3) return std::nullopt;
  const Posed posed_a = place(a, pose_a);
  const Posed posed_b = place(b, pose_b);
  std::vector<Vec3> points;
  add_clipped_edges(a, posed_a, posed_b, points);
  add_clipped_edges(b, posed_b, posed_a, points);
  const Expected<ConvexPolytope> hull = ConvexPolytope::from_points(points);
  if (!hull || hull->affine_dimension() < 3) return std::nullopt;
  return *hull;
}

}  // namespace pd::demo

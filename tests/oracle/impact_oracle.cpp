#include "oracle/impact_oracle.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace pd::oracle {

namespace {

/// A polytope's vertices, axes and edges, turned about the pivot: positions relative to the pivot.
struct Turning {
  std::vector<Vec3> vertices;
  std::vector<Vec3> normals;
  std::vector<Vec3> edges;  ///< unit
  Vec3 pivot;
  RigidMotion motion;

  explicit Turning(const MovingShape& body) : pivot(body.start.pose.translation() - body.arm), motion(body.motion) {
    const ConvexPolytope& p = *body.start.shape->polytope();
    const Mat3& r = body.start.pose.rotation();
    for (int v = 0; v < p.num_vertices(); ++v) vertices.emplace_back(r * p.vertex(v) + body.arm);
    for (int f = 0; f < p.num_facets(); ++f) normals.emplace_back(r * p.facet_normal(f));
    for (int v = 0; v < p.num_vertices(); ++v) {
      for (const std::int32_t w : p.neighbours(v)) {
        if (w > v) {
          edges.emplace_back(
              (vertices[static_cast<std::size_t>(w)] - vertices[static_cast<std::size_t>(v)]).normalized());
        }
      }
    }
    // A segment is apart along what is across it, a point along what leads to it: the caller adds those.
  }

  [[nodiscard]] Eigen::Quaterniond turn(double time) const {
    const Vec3 half = 0.5 * time * motion.angular_velocity;
    const double angle = half.norm();
    const double share = angle > 0 ? std::sin(angle) / angle : 1;
    return {std::cos(angle), share * half.x(), share * half.y(), share * half.z()};
  }
  [[nodiscard]] double speed() const {
    double radius = 0;
    for (const Vec3& v : vertices) radius = std::max(radius, v.norm());
    return motion.angular_velocity.norm() * radius;
  }
};

struct Placed {
  std::vector<Vec3> vertices;
  std::vector<Vec3> normals;
  std::vector<Vec3> edges;

  Placed(const Turning& body, double time, const Vec3& origin) {
    const Mat3 r = body.turn(time).toRotationMatrix();
    const Vec3 at = body.pivot - origin + time * body.motion.linear_velocity;
    for (const Vec3& v : body.vertices) vertices.emplace_back(r * v + at);
    for (const Vec3& n : body.normals) normals.emplace_back(r * n);
    for (const Vec3& e : body.edges) edges.emplace_back(r * e);
  }
};

/// min over A less max over B, or the other way round, whichever is larger.
double along(const Placed& a, const Placed& b, const Vec3& n) {
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  double a_low = kInfinite, a_high = -kInfinite, b_low = kInfinite, b_high = -kInfinite;
  for (const Vec3& v : a.vertices) {
    const double x = v.dot(n);
    a_low = std::min(a_low, x);
    a_high = std::max(a_high, x);
  }
  for (const Vec3& v : b.vertices) {
    const double x = v.dot(n);
    b_low = std::min(b_low, x);
    b_high = std::max(b_high, x);
  }
  return std::max(a_low - b_high, b_low - a_high);
}

double separation(const Turning& a, const Turning& b, double time) {
  const Placed pa(a, time, a.pivot);
  const Placed pb(b, time, a.pivot);
  double best = -std::numeric_limits<double>::infinity();
  for (const Vec3& n : pa.normals) best = std::max(best, along(pa, pb, n));
  for (const Vec3& n : pb.normals) best = std::max(best, along(pa, pb, n));
  for (const Vec3& e : pa.edges) {
    for (const Vec3& f : pb.edges) {
      const Vec3 n = e.cross(f);
      const double length = n.norm();
      if (length > 1e-12) best = std::max(best, along(pa, pb, n / length));
    }
  }
  // Flat bodies: what is across an edge within its plane.
  for (const auto* flat : {&pa, &pb}) {
    if (flat->normals.size() > 2) continue;
    for (const Vec3& n : flat->normals) {
      for (const Vec3& e : flat->edges) best = std::max(best, along(pa, pb, n.cross(e).normalized()));
    }
  }
  return best;
}

}  // namespace

double axis_separation(const MovingShape& a, const MovingShape& b, double time) {
  return separation(Turning(a), Turning(b), time);
}

FirstImpact first_impact(const MovingShape& a, const MovingShape& b, double duration, double resolution) {
  const Turning ta(a);
  const Turning tb(b);
  const double speed = (a.motion.linear_velocity - b.motion.linear_velocity).norm() + ta.speed() + tb.speed();
  std::vector<std::pair<double, double>> open{{0, duration}};  // later spans first
  while (!open.empty()) {
    const auto [from, to] = open.back();
    open.pop_back();
    const double middle = 0.5 * (from + to);
    if (separation(ta, tb, middle) > 0.5 * (to - from) * speed) continue;
    if (to - from <= resolution) return {true, from};
    open.emplace_back(middle, to);
    open.emplace_back(from, middle);
  }
  return {false, duration};
}

}  // namespace pd::oracle

#include "shape/exact_hull.hpp"

#include <array>
#include <boost/multiprecision/cpp_int.hpp>

namespace pd::test {
namespace {

using Rational = boost::multiprecision::cpp_rational;
using Exact3 = std::array<Rational, 3>;

Exact3 minus(const Exact3& a, const Exact3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Exact3 times(const Exact3& a, const Exact3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Rational dot(const Exact3& a, const Exact3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/// A plane that has the points on it and all others on one side.
struct SupportingPlane {
  Exact3 normal;
  std::set<std::size_t> on;
};

std::vector<SupportingPlane> supporting_planes(const std::vector<Exact3>& p) {
  const std::size_t n = p.size();
  std::set<std::set<std::size_t>> known;
  std::vector<SupportingPlane> planes;
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = i + 1; j < n; ++j) {
      for (std::size_t k = j + 1; k < n; ++k) {
        const Exact3 normal = times(minus(p[j], p[i]), minus(p[k], p[i]));
        if (dot(normal, normal).is_zero()) continue;
        bool above = false;
        bool below = false;
        std::set<std::size_t> on;
        for (std::size_t q = 0; q < n && !(above && below); ++q) {
          const int side = dot(normal, minus(p[q], p[i])).sign();
          above = above || side > 0;
          below = below || side < 0;
          if (side == 0) on.insert(q);
        }
        if (!(above && below) && known.insert(on).second) planes.push_back({normal, on});
      }
    }
  }
  return planes;
}

/// Of the directions, three that span space.
bool span_space(const std::vector<Exact3>& directions) {
  const std::size_t n = directions.size();
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = i + 1; j < n; ++j) {
      for (std::size_t k = j + 1; k < n; ++k) {
        if (!dot(directions[i], times(directions[j], directions[k])).is_zero()) return true;
      }
    }
  }
  return false;
}

}  // namespace

ExactHull exact_hull(std::span<const Vec3> points) {
  std::vector<Exact3> p;
  std::vector<int> ids;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Exact3 q{Rational(points[i].x()), Rational(points[i].y()), Rational(points[i].z())};
    if (std::find(p.begin(), p.end(), q) == p.end()) {
      p.push_back(q);
      ids.push_back(static_cast<int>(i));
    }
  }
  const std::vector<SupportingPlane> planes = supporting_planes(p);
  // A vertex is a point whose supporting facets have normals of rank three.
  ExactHull hull;
  std::vector<bool> is_vertex(p.size(), false);
  for (std::size_t q = 0; q < p.size(); ++q) {
    std::vector<Exact3> here;
    for (const SupportingPlane& plane : planes) {
      if (plane.on.count(q) != 0) here.push_back(plane.normal);
    }
    is_vertex[q] = span_space(here);
    if (is_vertex[q]) hull.vertices.insert(ids[q]);
  }
  for (const SupportingPlane& plane : planes) {
    std::set<int> facet;
    for (const std::size_t q : plane.on) {
      if (is_vertex[q]) facet.insert(ids[q]);
    }
    hull.facets.insert(facet);
  }
  return hull;
}

ExactHull combinatorics(const ConvexPolytope& polytope) {
  ExactHull hull;
  for (int v = 0; v < polytope.num_vertices(); ++v) hull.vertices.insert(polytope.caller_id(v));
  for (int f = 0; f < polytope.num_facets(); ++f) {
    std::set<int> facet;
    for (const int v : polytope.facet_vertices(f)) facet.insert(polytope.caller_id(v));
    hull.facets.insert(facet);
  }
  return hull;
}

}  // namespace pd::test

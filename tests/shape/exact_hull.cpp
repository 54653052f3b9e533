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
  const std::size_t n = p.size();
  // Supporting planes as the sets of points on them.
  std::set<std::set<std::size_t>> planes;
  std::vector<Exact3> normals;
  std::vector<std::set<std::size_t>> members;
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
        if (above && below) continue;
        if (planes.insert(on).second) {
          normals.push_back(normal);
          members.push_back(on);
        }
      }
    }
  }
  // A vertex is a point whose supporting facets have normals of rank three.
  ExactHull hull;
  std::vector<bool> is_vertex(n, false);
  for (std::size_t q = 0; q < n; ++q) {
    std::vector<Exact3> here;
    for (std::size_t f = 0; f < members.size(); ++f) {
      if (members[f].count(q) != 0) here.push_back(normals[f]);
    }
    for (std::size_t i = 0; i < here.size() && !is_vertex[q]; ++i) {
      for (std::size_t j = i + 1; j < here.size() && !is_vertex[q]; ++j) {
        for (std::size_t k = j + 1; k < here.size() && !is_vertex[q]; ++k) {
          is_vertex[q] = !dot(here[i], times(here[j], here[k])).is_zero();
        }
      }
    }
    if (is_vertex[q]) hull.vertices.insert(ids[q]);
  }
  for (const auto& plane : members) {
    std::set<int> facet;
    for (const std::size_t q : plane) {
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

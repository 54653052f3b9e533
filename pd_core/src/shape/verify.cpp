#include "pd/shape/verify.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "numeric/number_text.hpp"
#include "pd/numeric/predicates.hpp"

namespace pd {
namespace {

using detail::indexed;
using Finding = std::optional<std::string>;

Finding check_vertices(const ConvexPolytope& p) {
  Vec3 max_abs = Vec3::Zero();
  std::vector<int> ids;
  for (int v = 0; v < p.num_vertices(); ++v) {
    const Vec3 here = p.vertex(v);
    max_abs = max_abs.cwiseMax(here.cwiseAbs());
    ids.push_back(p.caller_id(v));
    if (v == 0) continue;
    const Vec3 before = p.vertex(v - 1);
    if (!std::lexicographical_compare(before.data(), before.data() + 3, here.data(), here.data() + 3)) {
      return indexed("vertices", v) + " is not after its predecessor";
    }
  }
  if (max_abs != p.max_abs_coordinates()) return "max_abs_coordinates are not those of the vertices";
  if (max_abs.maxCoeff() != p.max_abs_coordinate()) return "max_abs_coordinate is not that of the vertices";
  std::sort(ids.begin(), ids.end());
  if (std::adjacent_find(ids.begin(), ids.end()) != ids.end()) return "two vertices have one caller id";
  if (p.padded_size() < p.num_vertices() || p.padded_size() % ConvexPolytope::kPadding != 0) return "padding is wrong";
  for (int v = p.num_vertices(); v < p.padded_size(); ++v) {
    if (p.x()[v] != p.x()[0] || p.y()[v] != p.y()[0] || p.z()[v] != p.z()[0]) return "padding is not vertex 0";
  }
  return std::nullopt;
}

Finding check_half_edges(const ConvexPolytope& p) {
  int next_index = 0;
  for (int v = 0; v < p.num_vertices(); ++v) {
    const auto neighbours = p.neighbours(v);
    const int degree = static_cast<int>(neighbours.size());
    if (p.first_half_edge(v) != next_index) return "half-edges are not stored by origin";
    if (degree < p.affine_dimension()) return indexed("vertices", v) + " has too few neighbours";
    for (int k = 0; k < degree; ++k) {
      const int h = next_index + k;
      const HalfEdge edge = p.half_edge(h);
      const auto valid = [&](int index) { return index >= 0 && index < p.num_half_edges(); };
      if (!valid(edge.twin) || !valid(edge.next)) return indexed("half_edges", h) + " leads nowhere";
      const HalfEdge twin = p.half_edge(edge.twin);
      const HalfEdge next = p.half_edge(edge.next);
      if (edge.origin != v || neighbours[static_cast<std::size_t>(k)] != p.target(h)) {
        return indexed("half_edges", h) + " does not join its origin to the neighbour listed";
      }
      if (twin.twin != h || twin.origin == v) return indexed("half_edges", h) + " is not its twin's twin";
      if (next.origin != twin.origin || next.facet != edge.facet) {
        return indexed("half_edges", h) + " is not followed by an edge of its facet";
      }
      if (k > 0 && neighbours[static_cast<std::size_t>(k)] <= neighbours[0]) {
        return indexed("neighbours", v) + " do not begin with the lowest";
      }
      if (p.affine_dimension() >= 2) {
        // Counter-clockwise: the reverse of the edge that precedes h in its facet leaves v next.
        const int reverse_of_previous = next_index + (k + 1) % degree;
        if (p.half_edge(p.half_edge(reverse_of_previous).twin).next != h) {
          return indexed("neighbours", v) + " are not in counter-clockwise order";
        }
      }
    }
    next_index += degree;
  }
  if (next_index != p.num_half_edges()) return "half-edges are left over";
  return std::nullopt;
}

Finding check_loops(const ConvexPolytope& p) {
  int total = 0;
  int last_first = -1;
  for (int f = 0; f < p.num_facets(); ++f) {
    const auto loop = p.facet_vertices(f);
    total += static_cast<int>(loop.size());
    if (loop.size() < 3) return indexed("facets", f) + " has fewer than three vertices";
    if (std::any_of(loop.begin(), loop.end(), [&](int vertex) { return vertex < loop[0]; })) {
      return indexed("facets", f) + " does not begin with its lowest vertex";
    }
    int h = p.facet_half_edge(f);
    if (h <= last_first) return indexed("facets", f) + " is out of order";
    last_first = h;
    for (const int v : loop) {
      if (p.half_edge(h).origin != v || p.half_edge(h).facet != f) {
        return indexed("facets", f) + " has other half-edges";
      }
      h = p.half_edge(h).next;
    }
    if (h != p.facet_half_edge(f)) return indexed("facets", f) + " is not a closed loop";
  }
  if (p.affine_dimension() >= 2 && total != p.num_half_edges()) return "a half-edge belongs to no facet";
  return std::nullopt;
}

/// Strictly convex, wound once, in one plane.
Finding check_polygon(const ConvexPolytope& p, int f) {
  const auto loop = p.facet_vertices(f);
  const std::size_t n = loop.size();
  const auto corner = [&](std::size_t i) { return p.vertex(loop[i % n]); };
  const auto seen = [&](std::size_t i, int axis) {
    const Vec3 c = corner(i);
    return std::array<double, 2>{c[(axis + 1) % 3], c[(axis + 2) % 3]};
  };
  int axis = 2;
  while (axis >= 0 && orient2d(seen(0, axis), seen(1, axis), seen(2, axis)) == 0) --axis;
  if (axis < 0) return indexed("facets", f) + " begins with three collinear vertices";
  const int turn = orient2d(seen(0, axis), seen(1, axis), seen(2, axis));
  int crossings = 0;
  for (std::size_t i = 0; i < n; ++i) {
    if (!coplanar(corner(0), corner(1), corner(2), corner(i))) return indexed("facets", f) + " is not planar";
    if (orient2d(seen(i, axis), seen(i + 1, axis), seen(i + 2, axis)) != turn) {
      return indexed("facets", f) + " is not strictly convex";
    }
    if ((seen(i, axis) < seen(i + 1, axis)) != (seen(i + 1, axis) < seen(i + 2, axis))) ++crossings;
  }
  if (crossings != 2) return indexed("facets", f) + " winds more than once";
  if (!(std::abs(p.facet_normal(f).norm() - 1) <= 1e-15)) return indexed("facet_normals", f) + " is not a unit vector";
  return std::nullopt;
}

int side(const ConvexPolytope& p, int f, int v) {
  const auto loop = p.facet_vertices(f);
  return orient3d(p.vertex(loop[0]), p.vertex(loop[1]), p.vertex(loop[2]), p.vertex(v));
}

Finding check_convexity(const ConvexPolytope& p, double max_global_tests) {
  for (int f = 0; f < p.num_facets(); ++f) {
    if (auto finding = check_polygon(p, f)) return finding;
  }
  if (p.affine_dimension() < 3) return std::nullopt;
  if (p.num_vertices() - p.num_edges() + p.num_facets() != 2) return "Euler's formula does not hold";
  for (int h = 0; h < p.num_half_edges(); ++h) {
    const HalfEdge twin = p.half_edge(p.half_edge(h).twin);
    if (side(p, p.half_edge(h).facet, p.target(twin.next)) >= 0) return indexed("half_edges", h) + " is not convex";
  }
  if (static_cast<double>(p.num_vertices()) * p.num_facets() > max_global_tests) return std::nullopt;
  for (int f = 0; f < p.num_facets(); ++f) {
    const auto loop = p.facet_vertices(f);
    for (int v = 0; v < p.num_vertices(); ++v) {
      const int expected = std::find(loop.begin(), loop.end(), v) != loop.end() ? 0 : -1;
      if (side(p, f, v) != expected) return indexed("vertices", v) + " is not below " + indexed("facets", f);
    }
  }
  return std::nullopt;
}

}  // namespace

std::string verify_polytope(const ConvexPolytope& p, double max_global_tests) {
  const int d = p.affine_dimension();
  if (d < 0 || d > 3 || p.num_vertices() < d + 1) return "too few vertices for the affine dimension";
  if (d == 0 && (p.num_vertices() != 1 || p.num_half_edges() != 0)) return "a point has one vertex and no edge";
  if (d == 1 && (p.num_vertices() != 2 || p.num_half_edges() != 2)) return "a segment has two vertices and one edge";
  if (d < 2 && p.num_facets() != 0) return "a point or a segment has no facet";
  if (d == 2 && p.num_facets() != 2) return "a polygon is doubly covered";
  if (auto finding = check_vertices(p)) return *finding;
  if (auto finding = check_half_edges(p)) return *finding;
  if (auto finding = check_loops(p)) return *finding;
  return check_convexity(p, max_global_tests).value_or("");
}

}  // namespace pd

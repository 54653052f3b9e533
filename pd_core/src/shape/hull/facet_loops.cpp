#include "shape/hull/facet_loops.hpp"

#include "shape/hull/disjoint_sets.hpp"

namespace pd::detail {
namespace {

/// The edge of t that starts at vertex v.
int edge_from(const HullTriangle& t, int v) {
  int edge = 0;
  while (t.vertex[edge] != v) ++edge;
  return edge;
}

}  // namespace

FacetLoops merge_facets(const Quickhull& hull, int num_points) {
  const std::vector<HullTriangle>& triangles = hull.triangles();
  const auto at = [&](std::int32_t t) -> const HullTriangle& { return triangles[static_cast<std::size_t>(t)]; };
  const auto count = static_cast<std::int32_t>(triangles.size());

  DisjointSets facets(triangles.size());
  std::vector<std::uint8_t> ridges(triangles.size(), 0);  // bit i: edge i separates two facets
  std::vector<std::int32_t> degree(static_cast<std::size_t>(num_points), 0);
  for (std::int32_t t = 0; t < count; ++t) {
    for (int i = 0; i < 3; ++i) {
      const std::int32_t n = at(t).neighbour[i];
      if (n < t) continue;
      const int from = at(t).vertex[i];
      const int to = at(t).vertex[(i + 1) % 3];
      const int back = edge_from(at(n), to);
      if (hull.side(at(t), at(n).vertex[(back + 2) % 3]) == 0) {
        facets.unite(t, n);
      } else {
        ridges[static_cast<std::size_t>(t)] =
            static_cast<std::uint8_t>(ridges[static_cast<std::size_t>(t)] | (1U << i));
        ridges[static_cast<std::size_t>(n)] =
            static_cast<std::uint8_t>(ridges[static_cast<std::size_t>(n)] | (1U << back));
        ++degree[static_cast<std::size_t>(from)];
        ++degree[static_cast<std::size_t>(to)];
      }
    }
  }

  FacetLoops loops;
  loops.offsets.reserve(triangles.size() + 1);
  loops.vertices.reserve(3 * triangles.size());
  std::vector<bool> traced(triangles.size(), false);
  const auto is_ridge = [&](std::int32_t t, int edge) {
    return ((ridges[static_cast<std::size_t>(t)] >> edge) & 1U) != 0;
  };
  for (std::int32_t first = 0; first < count; ++first) {
    const auto facet = static_cast<std::size_t>(facets.find(first));
    if (traced[facet] || ridges[static_cast<std::size_t>(first)] == 0) continue;
    traced[facet] = true;
    int first_edge = 0;
    while (!is_ridge(first, first_edge)) ++first_edge;
    std::int32_t t = first;
    int edge = first_edge;
    do {
      const int vertex = at(t).vertex[edge];
      if (degree[static_cast<std::size_t>(vertex)] >= 3) loops.vertices.push_back(vertex);
      const int target = at(t).vertex[(edge + 1) % 3];
      edge = (edge + 1) % 3;
      while (!is_ridge(t, edge)) {  // turn about the target, inside the facet
        t = at(t).neighbour[edge];
        edge = edge_from(at(t), target);
        // The edge just crossed ends at the target here; the next one starts there.
      }
    } while (t != first || edge != first_edge);
    loops.end_facet();
  }
  return loops;
}

}  // namespace pd::detail

#include "pd/structure/twin_hierarchy.hpp"

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <utility>
#include <vector>

#include "numeric/floating_point_guard.hpp"

namespace pd {

namespace {

std::size_t index(int i) { return static_cast<std::size_t>(i); }

/// P_i, and where its parts stand in the inner hierarchy.
struct TwinLevel {
  PolyhedralHierarchy outer;
  std::vector<std::int32_t> vertices;      ///< of P, ascending, by vertex of P_i
  std::vector<std::int32_t> first;         ///< by facet, one more at the end: into `triangles`
  std::vector<std::int32_t> triangles;     ///< of the inner hierarchy, by facet
  std::vector<std::int32_t> sorted;        ///< the same ascending
  std::vector<std::int32_t> sorted_facet;  ///< and the facet of each
};

struct Side {
  std::int32_t from, to, triangle;
  friend bool operator<(const Side& x, const Side& y) { return x.from != y.from ? x.from < y.from : x.to < y.to; }
};

/// Facets of the polytope by triangle (indices into `triangles`): those with a side that is an edge, then across the
/// diagonals.
std::vector<std::int32_t> facets_of(const ConvexPolytope& polytope, const PolyhedralHierarchy& inner,
                                    const std::vector<std::int32_t>& whole,
                                    const std::vector<std::int32_t>& triangles) {
  const auto local = [&](std::int32_t v) {
    return static_cast<std::int32_t>(std::lower_bound(whole.begin(), whole.end(), v) - whole.begin());
  };
  std::vector<Side> edges, sides;
  for (int h = 0; h < polytope.num_half_edges(); ++h) {
    edges.push_back({polytope.half_edge(h).origin, polytope.target(h), polytope.half_edge(h).facet});
  }
  for (std::size_t k = 0; k < triangles.size(); ++k) {
    const auto& corners = inner.face(triangles[k]);
    for (std::size_t i = 0; i < 3; ++i) {
      sides.push_back({local(corners[i]), local(corners[(i + 1) % 3]), static_cast<std::int32_t>(k)});
    }
  }
  std::sort(edges.begin(), edges.end());
  std::sort(sides.begin(), sides.end());
  const auto find = [](const std::vector<Side>& in, std::int32_t from, std::int32_t to) -> const Side* {
    const auto at = std::lower_bound(in.begin(), in.end(), Side{from, to, 0});
    return at != in.end() && at->from == from && at->to == to ? &*at : nullptr;
  };
  std::vector<std::int32_t> facets(triangles.size(), -1), stack;
  for (const Side& side : sides) {
    const Side* edge = find(edges, side.from, side.to);
    if (edge == nullptr || facets[index(side.triangle)] >= 0) continue;
    facets[index(side.triangle)] = edge->triangle;
    stack.push_back(side.triangle);
  }
  while (!stack.empty()) {
    const std::int32_t k = stack.back();
    stack.pop_back();
    const auto& corners = inner.face(triangles[index(k)]);
    for (std::size_t i = 0; i < 3; ++i) {
      const Side* across = find(sides, local(corners[(i + 1) % 3]), local(corners[i]));
      if (facets[index(across->triangle)] >= 0) continue;
      facets[index(across->triangle)] = facets[index(k)];
      stack.push_back(across->triangle);
    }
  }
  return facets;
}

/// Both directions of the pointers between triangles and facets.
void link(const PolyhedralHierarchy& inner, const std::vector<std::int32_t>& triangles, TwinLevel& level) {
  const ConvexPolytope& polytope = level.outer.polytope();
  const std::vector<std::int32_t> facets = facets_of(polytope, inner, level.vertices, triangles);
  level.first.assign(index(polytope.num_facets()) + 1, 0);
  for (const std::int32_t f : facets) ++level.first[index(f) + 1];
  for (std::size_t f = 1; f < level.first.size(); ++f) level.first[f] += level.first[f - 1];
  std::vector<std::int32_t> next(level.first.begin(), level.first.end() - 1);
  level.triangles.resize(triangles.size());
  for (std::size_t k = 0; k < triangles.size(); ++k) level.triangles[index(next[index(facets[k])]++)] = triangles[k];
  level.sorted = triangles;
  level.sorted_facet = facets;
}

std::size_t bytes(const std::vector<std::int32_t>& v) { return v.capacity() * sizeof(v[0]); }

}  // namespace

struct TwinHierarchy::Storage {
  PolyhedralHierarchy inner;
  std::vector<TwinLevel> levels;
};

Expected<TwinHierarchy> TwinHierarchy::build(const ConvexPolytope& polytope) {
  const detail::FloatingPointGuard guard;
  auto inner = PolyhedralHierarchy::build(polytope, HierarchyKind::inner);
  if (!inner) return inner.error();
  Storage data{*std::move(inner), {}};
  const PolyhedralHierarchy& h = data.inner;
  std::vector<std::int32_t> vertices(index(polytope.num_vertices())), triangles, born;
  for (std::size_t v = 0; v < vertices.size(); ++v) vertices[v] = static_cast<std::int32_t>(v);
  // A triangle is there from the level below its creator's last one, those of level 0 from the start.
  std::vector<std::vector<std::int32_t>> births(h.levels().size());
  for (int f = 0; f < h.num_faces(); ++f) {
    births[h.creator(f) < 0 ? 0 : index(h.last_level(h.creator(f))) + 1].push_back(f);
  }
  std::vector<Vec3> points;
  for (int i = 0; i < static_cast<int>(h.levels().size()); ++i) {
    std::erase_if(vertices, [&](std::int32_t v) { return h.last_level(v) < i; });
    const auto gone = [&](std::int32_t f) {
      const auto& c = h.face(f);
      return std::any_of(c.begin(), c.end(), [&](std::int32_t v) { return h.last_level(v) < i; });
    };
    std::erase_if(triangles, gone);
    const auto middle = static_cast<std::ptrdiff_t>(triangles.size());
    triangles.insert(triangles.end(), births[index(i)].begin(), births[index(i)].end());
    std::inplace_merge(triangles.begin(), triangles.begin() + middle, triangles.end());
    points.clear();
    for (const std::int32_t v : vertices) points.push_back(polytope.vertex(v));
    // The stored order of vertices is canonical, so that those of P_i follow each other as in P.
    const auto hull = i == 0 ? Expected<ConvexPolytope>(polytope) : ConvexPolytope::from_points(points);
    assert(hull && hull->num_vertices() == static_cast<int>(vertices.size()));
    auto outer = PolyhedralHierarchy::build(*hull, HierarchyKind::outer);
    if (!outer) return outer.error();
    TwinLevel level{*std::move(outer), vertices, {}, {}, {}, {}};
    link(h, triangles, level);
    data.levels.push_back(std::move(level));
  }
  return TwinHierarchy(std::make_shared<const Storage>(std::move(data)));
}

const PolyhedralHierarchy& TwinHierarchy::inner() const { return data_->inner; }
int TwinHierarchy::num_levels() const { return static_cast<int>(data_->levels.size()); }
const PolyhedralHierarchy& TwinHierarchy::outer(int level) const { return data_->levels[index(level)].outer; }

int TwinHierarchy::vertex_of_whole(int level, int v) const { return data_->levels[index(level)].vertices[index(v)]; }

int TwinHierarchy::vertex_of_level(int level, int v) const {
  const auto& all = data_->levels[index(level)].vertices;
  const auto at = std::lower_bound(all.begin(), all.end(), v);
  return at != all.end() && *at == v ? static_cast<int>(at - all.begin()) : -1;
}

int TwinHierarchy::facet_of_triangle(int level, int f) const {
  const TwinLevel& l = data_->levels[index(level)];
  const auto at = std::lower_bound(l.sorted.begin(), l.sorted.end(), f);
  return at != l.sorted.end() && *at == f ? l.sorted_facet[static_cast<std::size_t>(at - l.sorted.begin())] : -1;
}

std::span<const std::int32_t> TwinHierarchy::triangles_of_facet(int level, int facet) const {
  const TwinLevel& l = data_->levels[index(level)];
  return std::span(l.triangles)
      .subspan(index(l.first[index(facet)]), index(l.first[index(facet) + 1] - l.first[index(facet)]));
}

std::size_t TwinHierarchy::memory_bytes() const {
  std::size_t sum = sizeof(Storage) + data_->inner.memory_bytes();
  for (const TwinLevel& l : data_->levels) {
    sum += sizeof(TwinLevel) + l.outer.memory_bytes() + bytes(l.vertices) + bytes(l.first) + bytes(l.triangles) +
           bytes(l.sorted) + bytes(l.sorted_facet);
    if (!l.outer.polytope().same_storage(data_->inner.polytope())) sum += l.outer.polytope().memory_bytes();
  }
  return sum;
}

}  // namespace pd

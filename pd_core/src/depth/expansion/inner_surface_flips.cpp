/// @file
/// Reflex edges flipped: what a surface loses in convexity while its points move is won back where that is cheap.
#include <algorithm>
#include <cmath>

#include "depth/expansion/inner_surface.hpp"

namespace pd::detail {

namespace {

/// As triangle_planes.
struct Plane {
  Vec3 normal;
  double level;
  double key;
};
Plane plane_through(const Vec3& p, const Vec3& q, const Vec3& r) {
  Plane out;
  out.normal = (q - p).cross(r - p);
  const double a = p.dot(out.normal), b = q.dot(out.normal), c = r.dot(out.normal);
  const double least = std::min({a, b, c});
  const double squared = out.normal.squaredNorm();
  out.level = std::max({a, b, c});
  out.key = squared > 0 ? least * std::abs(least) / squared : std::numeric_limits<double>::lowest();
  return out;
}

}  // namespace

void InnerSurface::set_plane(int f, const Vec3& normal, double level, double key) {
  nx_[f] = normal.x();
  ny_[f] = normal.y();
  nz_[f] = normal.z();
  levels_[f] = level;
  keys_[f] = key;
}

void InnerSurface::join(std::int32_t outside, std::int32_t edge) {
  triangles_[edge >> 2].adj[edge & 3] = outside;
  triangles_[outside >> 2].adj[outside & 3] = edge;
}

void InnerSurface::flip_reflex_edges() {
  open_edges_.clear();
  for (int f = 0; f < slots_; ++f) {
    if (keys_[f] == kRemoved) continue;
    for (std::int32_t e = 0; e < 3; ++e) {
      if (triangles_[f].adj[e] >> 2 > f && is_reflex(f, e)) open_edges_.push_back(4 * f + e);
    }
  }
  if (open_edges_.empty()) return;
  // Every flip makes the volume larger, up to rounding.
  for (int left = kMostFlips * slots_; left > 0 && !open_edges_.empty(); --left) {
    const std::int32_t edge = open_edges_.back();
    open_edges_.pop_back();
    flip(edge >> 2, edge & 3);
  }
  nearest_ = least_key(keys_.data(), slots_);
  if constexpr (kValidate) validate_after_insertion(*this, false, checked_insertions_);
}

bool InnerSurface::is_reflex(int f, std::int32_t e) const {
  const std::int32_t beyond = triangles_[f].adj[e];
  const Vec3& apex = vertices[triangles_[beyond >> 2].v[last_edge(beyond & 3)]].x;
  return normal(f).dot(apex) > levels_[f];
}

/// Two faces u v a and v u w with a reflex edge u v become u w a and w v a; where u or v has no other face but one,
/// they and that one become a single face. Nothing happens where the new faces would not have the origin behind them.
void InnerSurface::flip(int f, std::int32_t e) {
  if (keys_[f] == kRemoved || !is_reflex(f, e)) return;
  const int g = triangles_[f].adj[e] >> 2;
  const std::int32_t h = triangles_[f].adj[e] & 3;
  const SurfaceTriangle first = triangles_[f];
  const SurfaceTriangle second = triangles_[g];
  const std::int32_t u = first.v[e], v = first.v[next_edge(e)], a = first.v[last_edge(e)], w = second.v[last_edge(h)];
  if (a == w) return;
  const std::int32_t beyond_va = first.adj[next_edge(e)], beyond_au = first.adj[last_edge(e)];
  const std::int32_t beyond_uw = second.adj[next_edge(h)], beyond_wv = second.adj[last_edge(h)];
  if (beyond_au >> 2 == beyond_uw >> 2) return drop_vertex(f, g, beyond_uw >> 2, {w, v, a}, u, beyond_wv, beyond_va);
  if (beyond_va >> 2 == beyond_wv >> 2) return drop_vertex(f, g, beyond_wv >> 2, {a, u, w}, v, beyond_au, beyond_uw);
  const Plane uwa = plane_through(vertices[u].x, vertices[w].x, vertices[a].x);
  const Plane wva = plane_through(vertices[w].x, vertices[v].x, vertices[a].x);
  if (!(uwa.key > 0 && wva.key > 0) || uwa.normal.dot(vertices[v].x) > uwa.level) return;
  triangles_[f] = {{u, w, a}, {}};
  triangles_[g] = {{w, v, a}, {}};
  set_plane(f, uwa.normal, uwa.level, uwa.key);
  set_plane(g, wva.normal, wva.level, wva.key);
  join(beyond_uw, 4 * f);
  join(beyond_au, 4 * f + 2);
  join(beyond_wv, 4 * g);
  join(beyond_va, 4 * g + 1);
  join(4 * f + 1, 4 * g + 2);
  for (const std::int32_t edge : {4 * f, 4 * f + 2, 4 * g, 4 * g + 1}) open_edges_.push_back(edge);
}

/// Faces f, g and `third` are all that the vertex has: the triangle around them takes their place, unless the vertex
/// lies above it. `beyond_first`, `beyond_last`: across its first and second edge.
void InnerSurface::drop_vertex(int f, int g, int third, const std::array<std::int32_t, 3>& around, std::int32_t vertex,
                               std::int32_t beyond_first, std::int32_t beyond_second) {
  if (in_use_ <= 4) return;
  const Plane plane = plane_through(vertices[around[0]].x, vertices[around[1]].x, vertices[around[2]].x);
  if (!(plane.key > 0) || plane.normal.dot(vertices[vertex].x) > plane.level) return;
  const SurfaceTriangle& last = triangles_[third];
  std::int32_t e = 0;
  while (last.v[e] == vertex || last.v[next_edge(e)] == vertex) ++e;
  const std::int32_t beyond_third = last.adj[e];
  triangles_[f] = {{around[0], around[1], around[2]}, {}};
  set_plane(f, plane.normal, plane.level, plane.key);
  for (const int gone : {g, third}) keys_[gone] = levels_[gone] = kRemoved;
  in_use_ -= 2;
  join(beyond_first, 4 * f);
  join(beyond_second, 4 * f + 1);
  join(beyond_third, 4 * f + 2);
  for (std::int32_t i = 0; i < 3; ++i) open_edges_.push_back(4 * f + i);
}

}  // namespace pd::detail

#include "shape/support/polytope_support.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>

#include "numeric/unit_roundoff.hpp"
#include "shape/support/direction_table.hpp"
#include "shape/support/vertex_arrays.hpp"

namespace pd::detail {

namespace {

/// Facets with more vertices are left to a search, of bodies of up to so many vertices to a scan.
constexpr int kMostLevelVertices = 16;
constexpr int kMostScanned = 1024;

int scan(const ConvexPolytope& p, const Vec3& d) { return farthest_vertex(arrays_of(p), d.x(), d.y(), d.z()); }

int better(const ConvexPolytope& p, const Vec3& d, int v, int w) {
  if (v < 0 || w < 0) return std::max({v, w, 0});
  return p.vertex(w).dot(d) > p.vertex(v).dot(d) ? w : v;
}

/// @param target  (half-edge) -> the vertex that it leads to, without a sign: an address without another step.
template <class Target>
int climb_by(const ConvexPolytope& p, const Vec3& d, int from, const Target& target) {
  const double *const x = p.x(), *const y = p.y(), *const z = p.z();
  const double dx = d.x(), dy = d.y(), dz = d.z();
  const auto height = [&](std::uint32_t v) { return x[v] * dx + y[v] * dy + z[v] * dz; };
  auto v = static_cast<std::uint32_t>(from);
  double value = height(v);
  for (;;) {
    std::uint32_t next = v;
    const int end = p.first_half_edge(static_cast<int>(v) + 1);
    for (int h = p.first_half_edge(static_cast<int>(v)); h < end; ++h) {
      const std::uint32_t w = target(static_cast<std::size_t>(h));
      const double candidate = height(w);
      if (candidate > value) {
        value = candidate;
        next = w;
      }
    }
    if (next == v) return static_cast<int>(v);
    v = next;
  }
}

int climb(const ConvexPolytope& p, const Vec3& d, int v) {
  const ConvexPolytope::Storage& s = p.storage();
  if (s.width.bytes() == sizeof(std::uint16_t)) {  // most bodies that are too large for a scan
    return climb_by(p, d, v, [targets = s.neighbours](std::size_t h) -> std::uint32_t {
      std::uint16_t w = 0;
      std::memcpy(&w, targets + h * sizeof(w), sizeof(w));
      return w;
    });
  }
  return climb_by(p, d, v, [&s](std::size_t h) { return static_cast<std::uint32_t>(s.width.read(s.neighbours, h)); });
}

}  // namespace

int support_vertex(const ConvexPolytope& p, const Vec3& direction, int near) {
  if (p.num_vertices() <= kScanLimit) return scan(p, direction);
  Vec3 scaled;
  const int first = scale_for_search(direction, scaled) ? farthest_in_table(p.storage(), scaled) : -1;
  return climb(p, direction, better(p, direction, first, near));
}

int coarse_support_vertex(const ConvexPolytope& p, const Vec3& direction) {
  if (p.num_vertices() <= kScanLimit) return scan(p, direction);
  Vec3 scaled;
  return scale_for_search(direction, scaled) ? farthest_in_table(p.storage(), scaled) : -1;
}

int certified_support_vertex(const ConvexPolytope& p, const Vec3& direction, int v, std::vector<std::int32_t>& stack) {
  if (p.num_vertices() <= kScanLimit) return v;  // a scan has seen them all
  const double size = direction.cwiseAbs().sum();
  v = climb(p, direction, v);
  stack.clear();
  stack.push_back(v);
  int best = v;
  double best_value = p.vertex(v).dot(direction);
  for (std::size_t i = 0; i < stack.size(); ++i) {
    const int most = p.num_vertices() <= kMostScanned ? kMostLevelVertices : kScanLimit;
    if (stack.size() > static_cast<std::size_t>(most)) return scan(p, direction);
    const Vec3 from = p.vertex(stack[i]);
    for (const std::int32_t w : p.neighbours(stack[i])) {
      const Vec3 edge = p.vertex(w) - from;
      // Difference, product and two sums: 4u of the products' magnitudes.
      if (edge.dot(direction) < -8 * kUnitRoundoff * edge.cwiseAbs().maxCoeff() * size) continue;
      if (std::find(stack.begin(), stack.end(), w) != stack.end()) continue;
      stack.push_back(w);
      const double value = p.vertex(w).dot(direction);
      if (value > best_value) {
        best_value = value;
        best = w;
      }
    }
  }
  return best;
}

int confirmed_support_vertex(const ConvexPolytope& p, const Vec3& direction, const std::array<int, 3>& vertices) {
  if (p.num_vertices() <= kScanLimit) return scan(p, direction);
  const double* const x = p.x();
  const double* const y = p.y();
  const double* const z = p.z();
  const double dx = direction.x(), dy = direction.y(), dz = direction.z();
  // Two products of three terms, each within 3u of the sum of its terms' magnitudes, and their difference.
  const double doubt = 8 * kUnitRoundoff * p.radius() * (std::abs(dx) + std::abs(dy) + std::abs(dz));
  std::int32_t level[kMostLevelVertices];
  int count = 0;
  const auto is_listed = [&](std::int32_t v) { return std::find(level, level + count, v) != level + count; };
  for (const int v : vertices) {
    if (!is_listed(v)) level[count++] = v;
  }
  int best = -1;
  double best_value = 0;
  for (int i = 0; i < count; ++i) {
    const int v = level[i];
    const double value = x[v] * dx + y[v] * dy + z[v] * dz;
    for (const std::int32_t w : p.neighbours(v)) {
      const double other = x[w] * dx + y[w] * dy + z[w] * dz;
      if (other < value - doubt || is_listed(w)) continue;
      // Another vertex of the facet that the three lie on, or a higher one.
      if (other > value + doubt) return -1;
      if (count == kMostLevelVertices) return p.num_vertices() <= kMostScanned ? scan(p, direction) : -1;
      level[count++] = w;
    }
    if (best >= 0 && value <= best_value) continue;
    best = v;
    best_value = value;
  }
  return best;
}

}  // namespace pd::detail

#include "shape/polytope_support.hpp"

#include <algorithm>
#include <cmath>

#include "shape/farthest_vertex.hpp"

namespace pd::detail {

namespace {

int scan(const ConvexPolytope& p, const Vec3& d) {
  return farthest_vertex(p.x(), p.y(), p.z(), p.num_vertices(), d.x(), d.y(), d.z());
}

/// The best of about sqrt(n) vertices spread over the canonical order.
int sampled_start(const ConvexPolytope& p, const Vec3& d) {
  const int n = p.num_vertices();
  const int step = std::max(8, static_cast<int>(std::sqrt(static_cast<double>(n))));
  int best = 0;
  double best_value = p.vertex(0).dot(d);
  for (int v = step; v < n; v += step) {
    const double value = p.vertex(v).dot(d);
    if (value > best_value) {
      best_value = value;
      best = v;
    }
  }
  return best;
}

int climb(const ConvexPolytope& p, const Vec3& d, int v) {
  double value = p.vertex(v).dot(d);
  for (;;) {
    int next = v;
    double next_value = value;
    for (const std::int32_t w : p.neighbours(v)) {
      const double candidate = p.vertex(w).dot(d);
      if (candidate > next_value) {
        next_value = candidate;
        next = w;
      }
    }
    if (next == v) return v;
    v = next;
    value = next_value;
  }
}

}  // namespace

int support_vertex(const ConvexPolytope& p, const Vec3& direction, int near) {
  if (p.num_vertices() <= kScanLimit) return scan(p, direction);
  return climb(p, direction, near >= 0 ? near : sampled_start(p, direction));
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
    if (stack.size() > kScanLimit) return scan(p, direction);
    const Vec3 from = p.vertex(stack[i]);
    for (const std::int32_t w : p.neighbours(stack[i])) {
      const Vec3 edge = p.vertex(w) - from;
      // Difference, product and two sums: 4u of the products' magnitudes.
      if (edge.dot(direction) < -8 * 0x1p-53 * edge.cwiseAbs().maxCoeff() * size) continue;
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

}  // namespace pd::detail

#include "shape/polytope_support.hpp"

#include <algorithm>
#include <cmath>

namespace pd::detail {

namespace {

constexpr int kLanes = 8;

/// Scans in a fixed lane order, so that the winner among equals does not depend on the instruction set.
int scan(const double* x, const double* y, const double* z, int n, const Vec3& d) {
  double best[kLanes];
  double block_of[kLanes];
  for (int k = 0; k < kLanes; ++k) {
    best[k] = x[k] * d.x() + y[k] * d.y() + z[k] * d.z();
    block_of[k] = 0;
  }
  for (int i = kLanes; i < n; i += kLanes) {
    const double block = i;
    for (int k = 0; k < kLanes; ++k) {
      const double value = x[i + k] * d.x() + y[i + k] * d.y() + z[i + k] * d.z();
      const bool better = value > best[k];
      best[k] = better ? value : best[k];
      block_of[k] = better ? block : block_of[k];
    }
  }
  int winner = 0;
  int winner_id = static_cast<int>(block_of[0]);
  for (int k = 1; k < kLanes; ++k) {
    const int id = static_cast<int>(block_of[k]) + k;
    if (best[k] > best[winner] || (best[k] == best[winner] && id < winner_id)) {
      winner = k;
      winner_id = id;
    }
  }
  return winner_id < n ? winner_id : 0;  // the padding repeats vertex 0
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
  if (p.num_vertices() <= kScanLimit) return scan(p.x(), p.y(), p.z(), p.num_vertices(), direction);
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
    if (stack.size() > kScanLimit) return scan(p.x(), p.y(), p.z(), p.num_vertices(), direction);
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

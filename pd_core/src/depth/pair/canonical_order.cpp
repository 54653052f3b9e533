#include "depth/pair/canonical_order.hpp"

#include <cstring>
#include <utility>

namespace pd::detail {

namespace {

int compare(double x, double y) { return (x > y) - (x < y); }

int compare(const Vec3& x, const Vec3& y) {
  for (int i = 0; i < 3; ++i) {
    if (const int c = compare(x[i], y[i])) return c;
  }
  return 0;
}

int compare(const ConvexPolytope& x, const ConvexPolytope& y) {
  if (x.same_storage(y)) return 0;
  if (x.num_vertices() != y.num_vertices()) return x.num_vertices() < y.num_vertices() ? -1 : 1;
  const int first = compare(x.vertex(0), y.vertex(0));
  if (first != 0 || x.num_vertices() == 1) return first;
  // Two copies of one shape are common, and their bytes are compared faster than their numbers.
  const auto same_bytes = [bytes = sizeof(double) * static_cast<std::size_t>(x.num_vertices())](
                              const double* p, const double* q) { return std::memcmp(p, q, bytes) == 0; };
  if (same_bytes(x.x(), y.x()) && same_bytes(x.y(), y.y()) && same_bytes(x.z(), y.z())) return 0;
  for (int v = 0; v < x.num_vertices(); ++v) {
    if (const int c = compare(x.vertex(v), y.vertex(v))) return c;
  }
  return 0;
}
int compare(const Ellipsoid& x, const Ellipsoid& y) { return compare(x.radii, y.radii); }
int compare(const SphereHull& x, const SphereHull& y) {
  const auto p = x.spheres(), q = y.spheres();
  if (p.size() != q.size()) return p.size() < q.size() ? -1 : 1;
  for (std::size_t i = 0; i < p.size(); ++i) {
    if (const int c = compare(p[i].centre, q[i].centre)) return c;
    if (const int c = compare(p[i].radius, q[i].radius)) return c;
  }
  return 0;
}
template <class Round>
int compare(const Round& x, const Round& y) {
  if (x.axis != y.axis) return x.axis < y.axis ? -1 : 1;
  if (const int c = compare(x.radius, y.radius)) return c;
  return compare(x.half_height, y.half_height);
}

int compare(const ConvexShape& x, const ConvexShape& y) {
  if (x.core().index() != y.core().index()) return x.core().index() < y.core().index() ? -1 : 1;
  // Two polytopes, the common case, without a table of functions.
  const int cores =
      x.polytope()
          ? compare(*x.polytope(), *y.polytope())
          : std::visit(
                [&](const auto& core) { return compare(core, std::get<std::decay_t<decltype(core)>>(y.core())); },
                x.core());
  return cores != 0 ? cores : compare(x.margin(), y.margin());
}

int compare(const Pose& x, const Pose& y) {
  if (const int c = compare(x.translation(), y.translation())) return c;
  for (int i = 0; i < 9; ++i) {
    if (const int c = compare(x.rotation()(i / 3, i % 3), y.rotation()(i / 3, i % 3))) return c;
  }
  return 0;
}

}  // namespace

int compare_bodies(const PosedShape& a, const PosedShape& b) {
  const int shapes = compare(*a.shape, *b.shape);
  return shapes != 0 ? shapes : compare(a.pose, b.pose);
}

void exchange_bodies(PenetrationDepth& answer) {
  answer.translation = -answer.translation;
  answer.normal = -answer.normal;
  std::swap(answer.witness_a, answer.witness_b);
  std::swap(answer.feature_a, answer.feature_b);
}

void clear_negative_zeros(PenetrationDepth& answer) {
  answer.translation.array() += 0.0;
  answer.normal.array() += 0.0;
}

}  // namespace pd::detail

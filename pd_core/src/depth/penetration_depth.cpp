#include "pd/depth/penetration_depth.hpp"

#include <algorithm>
#include <cstring>
#include <limits>

#include "depth/pair/grid_depth.hpp"
#include "depth/pair/polytope_depth.hpp"
#include "depth/pair/shallow_depth.hpp"
#include "depth/pair/smooth_depth.hpp"
#include "numeric/floating_point_guard.hpp"
#include "pd/depth/scratch.hpp"

namespace pd {

Scratch::Scratch() : buffers_(std::make_unique<detail::ScratchBuffers>()) {}
Scratch::~Scratch() = default;
Scratch::Scratch(Scratch&&) noexcept = default;
Scratch& Scratch::operator=(Scratch&&) noexcept = default;

void WarmCertificate::clear() { state_ = State(); }

std::size_t WarmCertificate::memory_bytes() const {
  return sizeof(*this) + state_.vertices.capacity() * sizeof(CachedVertex) +
         state_.faces.capacity() * sizeof(CachedFace) +
         (state_.reference.distances.capacity() + state_.reference.spreads.capacity()) * sizeof(float);
}

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
  if (const int c = compare(x.vertex(0), y.vertex(0))) return c;
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

/// A pair is solved in one order, whichever way it was asked: by content, so that neither addresses nor the caller's
/// order of vertices matter, and by comparisons that a power of two does not change.
bool in_canonical_order(const PosedShape& a, const PosedShape& b) {
  const int shapes = compare(*a.shape, *b.shape);
  return shapes != 0 ? shapes < 0 : compare(a.pose, b.pose) <= 0;
}

void turn_round(PenetrationDepth& answer) {
  answer.translation = -answer.translation;
  answer.normal = -answer.normal;
  std::swap(answer.witness_a, answer.witness_b);
  std::swap(answer.feature_a, answer.feature_b);
}

void solve(const PosedShape& a, const PosedShape& b, const DepthSettings& settings, detail::ScratchBuffers& buffers,
           WarmCertificate* warm, PenetrationDepth& out) {
  const ConvexPolytope* const polytope_a = a.shape->polytope();
  const ConvexPolytope* const polytope_b = b.shape->polytope();
  const detail::Margins margins{a.shape->margin(), b.shape->margin()};
  if (settings.method == Method::grid) {
    detail::grid_depth(a, b, settings, buffers, out);
  } else if (settings.method == Method::shallow) {
    const double delta = settings.delta > 0 ? settings.delta : detail::kDefaultShallowDelta;
    const Expected<DirectionGrid> grid =
        direction_grid(GridKind::geodesic, delta / 4, GridExtent::sphere, std::numeric_limits<std::int64_t>::max());
    ShallowCounts counts;
    detail::shallow_depth({polytope_a, polytope_b, &a.pose, &b.pose, margins}, delta, *grid, settings, buffers, out,
                          counts);
  } else if (polytope_a && polytope_b) {
    detail::polytope_depth({polytope_a, polytope_b, &a.pose, &b.pose, margins}, settings, buffers, warm, out);
  } else {
    detail::smooth_depth(a, b, settings, buffers, out, warm);
  }
}

}  // namespace

PenetrationDepth penetration_depth(const PosedShape& a, const PosedShape& b, Scratch& scratch,
                                   const DepthSettings& settings, WarmCertificate* warm) {
  const detail::FloatingPointGuard guard;
  PenetrationDepth out;
  const bool in_order = in_canonical_order(a, b);
  scratch.buffers().surface.watch.mirrored = !in_order;
  if (in_order) {
    solve(a, b, settings, scratch.buffers(), warm, out);
  } else {
    solve(b, a, settings, scratch.buffers(), warm, out);
    turn_round(out);
  }
  // No negative zeros: a swap negates, and people read the numbers.
  out.translation.array() += 0.0;
  out.normal.array() += 0.0;
  return out;
}

bool supports(Method method, const ConvexShape& a, const ConvexShape& b) {
  switch (method) {
    case Method::automatic:
    case Method::expansion:
    case Method::grid:
      return true;
    case Method::overlay:
    case Method::shallow:
      return a.polytope() && b.polytope();
    default:
      return false;
  }
}

}  // namespace pd

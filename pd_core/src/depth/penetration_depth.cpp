#include "pd/depth/penetration_depth.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>

#include "depth/pair/beyond.hpp"
#include "depth/pair/canonical_order.hpp"
#include "depth/pair/grid_depth.hpp"
#include "depth/pair/polytope_depth.hpp"
#include "depth/pair/shallow_depth.hpp"
#include "depth/pair/slender_pair.hpp"
#include "depth/pair/smooth_depth.hpp"
#include "numeric/floating_point_guard.hpp"
#include "pd/depth/scratch.hpp"

namespace pd {

namespace {

/// Whether a certified distance past `beyond` is answer enough.
bool asks_beyond(const DepthSettings& settings) { return settings.beyond < std::numeric_limits<double>::infinity(); }

void solve(const PosedShape& a, const PosedShape& b, const DepthSettings& settings, detail::ScratchBuffers& buffers,
           WarmCertificate* warm, PenetrationDepth& out) {
  if (asks_beyond(settings) && detail::answer_beyond(a, b, settings, buffers, warm, out)) return;
  const ConvexPolytope* const polytope_a = a.shape->polytope();
  const ConvexPolytope* const polytope_b = b.shape->polytope();
  const detail::Margins margins{a.shape->margin(), b.shape->margin()};
  if (settings.method == Method::grid) {
    detail::grid_depth(a, b, settings, buffers, out);
  } else if (settings.method == Method::shallow && polytope_a && polytope_b) {
    // The answer is exact whatever delta is: more rays only spare facets.
    const double delta =
        std::clamp(settings.delta > 0 ? settings.delta : detail::kDefaultShallowDelta, detail::kLeastShallowDelta, 1.0);
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
  if (asks_beyond(settings) && warm != nullptr) detail::remember_plane(out, *warm);
}

/// Asks for the first lines of a polytope's block, where its sizes and vertices stand, before they are read: the lines
/// of both bodies are then waited for at once. A pair with a memory was asked about a frame ago, and waits for less.
void fetch_early(const ConvexShape& shape) {
  constexpr std::size_t kLine = 64, kLines = 8;
  const ConvexPolytope* const polytope = shape.polytope();
  if (polytope == nullptr) return;
  const auto* const block = reinterpret_cast<const std::byte*>(&polytope->storage());
  for (std::size_t i = 0; i < kLines; ++i) __builtin_prefetch(block + i * kLine);
}

}  // namespace

PenetrationDepth penetration_depth(const PosedShape& a, const PosedShape& b, Scratch& scratch,
                                   const DepthSettings& settings, WarmCertificate* warm) {
  const detail::FloatingPointGuard guard;
  PenetrationDepth out;
  const bool spheres = detail::is_sphere(*a.shape) && detail::is_sphere(*b.shape);
  if ((spheres && detail::answer_spheres(a, b, settings, out)) ||
      (asks_beyond(settings) && detail::balls_may_lie_beyond(a, b, settings.beyond) &&
       detail::answer_balls_beyond(a, b, settings.beyond, out))) {
    detail::clear_negative_zeros(out);
    return out;
  }
  if (warm == nullptr && !asks_beyond(settings)) {
    fetch_early(*a.shape);
    fetch_early(*b.shape);
  }
  const bool in_order = detail::compare_bodies(a, b) <= 0;
  scratch.buffers().surface.watch.mirrored = !in_order;
  if (in_order) {
    solve(a, b, settings, scratch.buffers(), warm, out);
  } else {
    solve(b, a, settings, scratch.buffers(), warm, out);
    detail::exchange_bodies(out);
  }
  detail::clear_negative_zeros(out);
  return out;
}

bool supports(Method method, const ConvexShape& a, const ConvexShape& b) {
  switch (method) {
    case Method::automatic:
    case Method::expansion:
    case Method::grid:
      return true;
    case Method::overlay:
    case Method::decomposition:
    case Method::shallow:
      return a.polytope() && b.polytope();
  }
  return false;
}

}  // namespace pd

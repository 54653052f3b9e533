#include "pd/planar/convex_polygon.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <string>

#include "numeric/floating_point_guard.hpp"
#include "pd/numeric/predicates.hpp"
#include "planar/angle_grid.hpp"
#include "planar/convex_signs.hpp"

namespace pd {

namespace {

constexpr double kLargestCoordinate = 1e300;
/// Below this many vertices a binary search touches a few cache lines anyway.
constexpr int kLeastTabulated = 64;

/// Edges are sorted by angle from the lexicographically least vertex on: does this one come before a direction?
bool before(const detail::PolygonEdge& edge, const detail::PolygonEdge& level, int half) {
  const int he = detail::half_of(edge);
  return he != half ? he < half : detail::turn(edge, level) > 0;
}

/// Andrew's monotone chain over points in lexicographic order without duplicates.
std::vector<std::int32_t> hull_of(std::span<const Point2> points, const std::vector<std::int32_t>& sorted) {
  const auto at = [&](std::int32_t i) -> const Point2& { return points[static_cast<std::size_t>(i)]; };
  std::vector<std::int32_t> hull;
  const auto add = [&](std::int32_t i, std::size_t least) {
    while (hull.size() >= least + 2 && orient2d(at(hull[hull.size() - 2]), at(hull.back()), at(i)) <= 0) {
      hull.pop_back();
    }
    hull.push_back(i);
  };
  for (const std::int32_t i : sorted) add(i, 0);
  const std::size_t lower = hull.size() - 1;
  for (std::size_t k = sorted.size() - 1; k-- > 0;) add(sorted[k], lower);
  hull.pop_back();
  return hull;
}

}  // namespace

Expected<ConvexPolygon> ConvexPolygon::from_points(std::span<const Point2> points) {
  const detail::FloatingPointGuard guard;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::string where = "points[" + std::to_string(i) + "]";
    for (const double c : points[i]) {
      if (!std::isfinite(c)) return Error{ErrorCode::non_finite, "two finite numbers are needed", where};
      if (std::abs(c) > kLargestCoordinate)
        return Error{ErrorCode::out_of_range, "coordinates are limited to 1e300", where};
    }
  }
  if (points.empty()) return Error{ErrorCode::too_few_points, "a polygon needs at least three points", "points"};
  std::vector<std::int32_t> order(points.size());
  std::iota(order.begin(), order.end(), 0);
  const auto at = [&](std::int32_t i) -> const Point2& { return points[static_cast<std::size_t>(i)]; };
  std::sort(order.begin(), order.end(),
            [&](std::int32_t i, std::int32_t j) { return at(i) != at(j) ? at(i) < at(j) : i < j; });
  order.erase(std::unique(order.begin(), order.end(), [&](std::int32_t i, std::int32_t j) { return at(i) == at(j); }),
              order.end());
  ConvexPolygon polygon;
  if (order.size() >= 3) polygon.caller_ids_ = hull_of(points, order);
  if (polygon.caller_ids_.size() < 3) {
    return Error{ErrorCode::not_full_dimensional, "the points lie on one line; a polygon has an inside", "points"};
  }
  for (const std::int32_t i : polygon.caller_ids_) polygon.points_.push_back(at(i));
  polygon.tabulate_edges();
  return polygon;
}

void ConvexPolygon::tabulate_edges() {
  const int n = num_vertices();
  if (n < kLeastTabulated) return;
  const int count = static_cast<int>(std::bit_ceil(static_cast<unsigned>(n)) / 2);
  first_edges_.reserve(static_cast<std::size_t>(count) + 1);
  first_edges_.push_back(0);
  int edge = 0;
  for (int k = 1; k < count; ++k) {
    const Point2 origin{0, 0}, direction = detail::grid_direction(k, count);
    const detail::PolygonEdge level{&origin, &direction};
    const int half = detail::half_of(level);
    while (edge < n && before(detail::edge_of(*this, edge, 1), level, half)) ++edge;
    first_edges_.push_back(edge);
  }
  first_edges_.push_back(n);
}

int ConvexPolygon::extreme(const Point2& direction, std::int64_t* probes) const {
  // The first edge at or after the direction's left normal falls or runs level: it leaves the extreme vertex.
  const Point2 origin{0, 0}, normal{-direction[1], direction[0]};
  const detail::PolygonEdge level{&origin, &normal};
  const int half = detail::half_of(level);
  int low = -1, high = num_vertices();
  if (!first_edges_.empty()) {
    // The place is within a fraction of a cell: the normal is certainly not before the cell before its own, and before
    // the end of the one behind it.
    const int cells = static_cast<int>(first_edges_.size()) - 1;
    const int cell = static_cast<int>(detail::grid_place(normal, cells));
    low = first_edges_[static_cast<std::size_t>(std::max(cell - 1, 0))] - 1;
    high = first_edges_[static_cast<std::size_t>(std::min(cell + 2, cells))];
  }
  while (high - low > 1) {
    const int middle = low + (high - low) / 2;
    (before(detail::edge_of(*this, middle, 1), level, half) ? low : high) = middle;
    if (probes != nullptr) ++*probes;
  }
  return high == num_vertices() ? 0 : high;
}

ConvexDifference convex_difference(const ConvexPolygon& p, const ConvexPolygon& q) {
  const detail::FloatingPointGuard guard;
  ConvexDifference difference;
  const int n = p.num_vertices(), m = q.num_vertices();
  // Edges of P from its least vertex on, and of -Q from its own, which is Q's greatest: both in the order of angles.
  int greatest = 0;
  for (int i = 1; i < m; ++i) {
    if (q.vertex(i) > q.vertex(greatest)) greatest = i;
  }
  int i = 0, j = 0;
  while (i < n || j < m) {
    const int vp = i % n, vq = (greatest + j) % m;
    int order = i == n ? 1 : (j == m ? -1 : 0);
    if (order == 0) {
      const detail::PolygonEdge e = detail::edge_of(p, vp, 1), f = detail::edge_of(q, vq, -1);
      const int he = detail::half_of(e), hf = detail::half_of(f);
      order = he != hf ? he - hf : -detail::turn(e, f);
    }
    difference.corners.push_back({vp, vq, order <= 0, order >= 0});
    if (order <= 0) ++i;
    if (order >= 0) ++j;
  }
  return difference;
}

}  // namespace pd

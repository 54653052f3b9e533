#include "planar/disc_bracket.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "pd/planar/convex_polygon.hpp"

namespace pd::detail {

namespace {

/// The hull of a convex polygon's vertices, each moved by `reach` in the directions in which it may be farthest.
/// @param turn  of the directions, in steps from one to the next; 0: along the axes, too
Expected<Polygon> moved_apart(const Polygon& convex, double reach, double turn) {
  // More than the angle between two directions, so that the hull misses no corner.
  constexpr double kAside = 8.0 / DiscBracket::kCorners;
  std::vector<Point2> points;
  for (int v = 0; v < convex.num_vertices(); ++v) {
    const Point2& x = convex.point(v);
    const auto along = [&](const Point2& end, const Point2& unit) {
      const double dx = end[0] - x[0], dy = end[1] - x[1];
      return dx * unit[0] + dy * unit[1] <= kAside * (std::abs(dx) + std::abs(dy));
    };
    for (int k = 0; k < DiscBracket::kCorners; ++k) {
      const double angle = 2 * M_PI * (k + turn) / DiscBracket::kCorners;
      const Point2 unit = {std::cos(angle), std::sin(angle)};
      if (!convex.is_point() &&
          !(along(convex.point(convex.next(v)), unit) && along(convex.point(convex.previous(v)), unit)))
        continue;
      points.push_back({x[0] + reach * unit[0], x[1] + reach * unit[1]});
    }
  }
  const Expected<ConvexPolygon> hull = ConvexPolygon::from_points(points);
  if (!hull) return hull.error();
  std::vector<Point2> ring;
  for (int v = 0; v < hull->num_vertices(); ++v) ring.push_back(hull->vertex(v));
  return Polygon::from_rings(ring);
}

}  // namespace

Expected<std::shared_ptr<const DiscBracket>> DiscBracket::of(const Polygon& p, const Polygon& q, const Dyadic& radius,
                                                             double low, double high) {
  if (!p.convex() && !q.convex()) {
    return Error{
        ErrorCode::unsupported,
        "the way out for good with a margin is answered where one polygon is convex, or straight along a direction",
        "complete"};
  }
  const Polygon& convex = q.convex() ? q : p;
  double largest = high;
  for (const Point2& x : convex.points()) largest = std::max({largest, std::abs(x[0]), std::abs(x[1])});
  // Sines and sums are rounded. Both polygons have a disc's extent along the axes.
  const double slack = 0x1p-50 * largest;
  const auto difference_with = [&](double reach, double turn) -> Expected<PolygonDifference> {
    if (!(reach > 0)) return PolygonDifference::of(p, q);
    const Expected<Polygon> swept = moved_apart(convex, reach, turn);
    if (!swept) return swept.error();
    return q.convex() ? PolygonDifference::of(p, *swept) : PolygonDifference::of(*swept, q);
  };
  Expected<PolygonDifference> inner = difference_with(low - slack, 0);
  if (!inner) return inner.error();
  Expected<PolygonDifference> outer = difference_with((high + slack) / std::cos(M_PI / kCorners) * (1 + 0x1p-48), 0.5);
  if (!outer) return outer.error();
  return std::make_shared<const DiscBracket>(DiscBracket{radius, *std::move(inner), *std::move(outer)});
}

}  // namespace pd::detail

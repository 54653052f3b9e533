#include "pd/planar/convex_depth.hpp"

#include <algorithm>
#include <cmath>

#include "numeric/floating_point_guard.hpp"
#include "planar/chain_search.hpp"
#include "planar/edge_distance.hpp"

namespace pd {

namespace {

using detail::Dyadic;
using detail::ExitEdge;

Expected<Point2> checked(const Point2& v, const char* where) {
  for (const double c : v) {
    if (!std::isfinite(c)) return Error{ErrorCode::non_finite, "two finite numbers are needed", where};
    if (std::abs(c) > 1e300) return Error{ErrorCode::out_of_range, "coordinates are limited to 1e300", where};
  }
  return v;
}

Expected<Point2> checked_direction(const Point2& d) {
  if (const auto finite = checked(d, "direction"); !finite) return finite.error();
  if (d[0] == 0 && d[1] == 0) {
    return Error{ErrorCode::zero_direction, "a direction needs a length other than zero", "direction"};
  }
  return d;
}

/// |t| |d| of a crossing, rounded down and up.
struct Rounded {
  double lower, upper;
};
Rounded time_of(const ConvexPolygon& p, const ConvexPolygon& q, const ExitEdge& exit, const Point2& y,
                const Point2& d) {
  const auto [numerator, denominator] = detail::crossing_time<Dyadic>(p, q, exit, y, d);
  const Dyadic x(d[0]), z(d[1]);
  return detail::rounded_root<Rounded>(numerator * numerator * (x * x + z * z), denominator * denominator);
}

/// The exits ahead of y and behind it, and y's class.
struct Line {
  std::optional<ExitEdge> ahead, behind;
  int side_ahead = 0, side_behind = 0;
  std::int64_t probes = 0;

  Line(const ConvexPolygon& p, const ConvexPolygon& q, const Point2& y, const Point2& d) {
    const detail::SideVertices sides(p, q, d, probes);
    ahead = detail::find_exit(p, q, y, d, sides, probes);
    if (!ahead) return;
    behind = detail::find_exit(p, q, y, {-d[0], -d[1]}, sides.turned(), probes);
    const auto side = [&](const ExitEdge& e) {
      ++probes;
      return detail::side_of_edge(e.edge, p.vertex(e.parts.vertex_p), q.vertex(e.parts.vertex_q), y);
    };
    side_ahead = side(*ahead);
    side_behind = side(*behind);
  }
  [[nodiscard]] PlanarContact contact() const {
    if (!ahead || side_ahead < 0 || side_behind < 0) return PlanarContact::separated;
    return ahead->grazes || side_ahead == 0 || side_behind == 0 ? PlanarContact::touching : PlanarContact::overlapping;
  }
};

}  // namespace

Expected<PlanarDepth> convex_directional_depth(const ConvexPolygon& p, const ConvexPolygon& q,
                                               const Point2& displacement, const Point2& direction) {
  const detail::FloatingPointGuard guard;
  if (const auto y = checked(displacement, "displacement"); !y) return y.error();
  if (const auto d = checked_direction(direction); !d) return d.error();
  const Line line(p, q, displacement, direction);
  PlanarDepth out;
  out.contact = line.contact();
  out.probes = line.probes;
  if (out.contact != PlanarContact::overlapping) return out;
  const Rounded t = time_of(p, q, *line.ahead, displacement, direction);
  out.lower = t.lower;
  out.upper = t.upper;
  out.depth = t.upper;
  out.edge = line.ahead->parts;
  out.normal = detail::unit_normal(line.ahead->edge);
  return out;
}

Expected<PlanarCrossing> convex_crossing(const ConvexPolygon& p, const ConvexPolygon& q, const Point2& displacement,
                                         const Point2& direction) {
  const detail::FloatingPointGuard guard;
  if (const auto y = checked(displacement, "displacement"); !y) return y.error();
  if (const auto d = checked_direction(direction); !d) return d.error();
  const Line line(p, q, displacement, direction);
  PlanarCrossing out;
  out.probes = line.probes;
  out.meets = line.ahead.has_value();
  if (!out.meets) return out;
  const Rounded leave = time_of(p, q, *line.ahead, displacement, direction);
  const Rounded enter = time_of(p, q, *line.behind, displacement, direction);
  // Inside the edge's line: ahead of y the end, behind it the beginning.
  out.leave_lower = line.side_ahead >= 0 ? leave.lower : -leave.upper;
  out.leave_upper = line.side_ahead >= 0 ? leave.upper : -leave.lower;
  out.enter_lower = line.side_behind >= 0 ? -enter.upper : enter.lower;
  out.enter_upper = line.side_behind >= 0 ? -enter.lower : enter.upper;
  return out;
}

Expected<PlanarContact> convex_intersection(const ConvexPolygon& p, const ConvexPolygon& q,
                                            const Point2& displacement) {
  const detail::FloatingPointGuard guard;
  if (const auto y = checked(displacement, "displacement"); !y) return y.error();
  return Line(p, q, displacement, {1, 0}).contact();
}

Expected<PlanarDepth> convex_depth(const ConvexPolygon& p, const ConvexPolygon& q, const Point2& displacement) {
  const detail::FloatingPointGuard guard;
  if (const auto y = checked(displacement, "displacement"); !y) return y.error();
  const ConvexDifference difference = convex_difference(p, q);
  PlanarDepth out;
  out.contact = PlanarContact::overlapping;
  const detail::DifferenceEdges edges(p, q, difference);
  int nearest = 0;
  for (int i = 0; i < edges.size(); ++i) {
    ++out.probes;
    const int side = edges.side(i, displacement);
    if (side < 0) return PlanarDepth{PlanarContact::separated, 0, 0, 0, {1, 0}, {}, out.probes};
    if (side == 0) out.contact = PlanarContact::touching;
    if (edges.compare(i, nearest, displacement) < 0) nearest = i;
  }
  if (out.contact == PlanarContact::overlapping) edges.fill(nearest, displacement, out);
  return out;
}

}  // namespace pd

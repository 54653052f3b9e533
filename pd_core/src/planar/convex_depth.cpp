#include "pd/planar/convex_depth.hpp"

#include <algorithm>
#include <cmath>

#include "numeric/floating_point_guard.hpp"
#include "planar/chain_search.hpp"
#include "planar/edge_distance.hpp"
#include "planar/refused_point.hpp"
#include "planar/rounded_crossing.hpp"

namespace pd {

namespace {

using detail::Dyadic;
using detail::ExitEdge;

/// |t| |d| of a crossing, rounded down and up.
struct Rounded {
  double lower, upper;
};
Rounded time_of(const ConvexPolygon& p, const ConvexPolygon& q, const ExitEdge& exit, const Point2& y,
                const Point2& d) {
  const detail::PolygonEdge& e = exit.edge;
  const detail::Span ray{{y, {0, 0}}, {{0, 0}, d}, {}};
  const detail::Span edge{{p.vertex(exit.parts.vertex_p), q.vertex(exit.parts.vertex_q)},
                          e.sign > 0 ? detail::PlaneDirection{*e.from, *e.to} : detail::PlaneDirection{*e.to, *e.from},
                          {}};
  if (const auto r = detail::rounded_crossing(ray, d, edge)) return {r->lower, r->upper};
  const auto [numerator, denominator] = detail::crossing_time<Dyadic>(p, q, exit, y, d);
  const Dyadic x(d[0]), z(d[1]);
  return detail::rounded_root<Rounded>(numerator * numerator * (x * x + z * z), denominator * denominator);
}

/// The exits of a line from R ahead of y and behind it, and y's class. What is behind is looked for when it matters.
class Line {
 public:
  Line(const ConvexPolygon& p, const ConvexPolygon& q, const Point2& y, const Point2& d)
      : p_(p), q_(q), y_(y), d_(d), ahead_(exit_along(d, false)) {
    if (ahead_) side_ahead_ = side(*ahead_);
  }
  [[nodiscard]] const std::optional<ExitEdge>& ahead() const { return ahead_; }
  [[nodiscard]] int side_ahead() const { return side_ahead_; }
  /// Requires an exit ahead: then there is one behind.
  [[nodiscard]] const ExitEdge& behind() {
    if (!behind_) {
      behind_ = exit_along({-d_[0], -d_[1]}, true);
      side_behind_ = side(*behind_);
    }
    return *behind_;
  }
  [[nodiscard]] int side_behind() {
    (void)behind();
    return side_behind_;
  }
  [[nodiscard]] std::int64_t probes() const { return probes_; }

  [[nodiscard]] PlanarContact contact() {
    if (!ahead_ || side_ahead_ < 0) return PlanarContact::separated;
    if (!ahead_->grazes && ahead_of_chords()) {
      return side_ahead_ == 0 ? PlanarContact::touching : PlanarContact::overlapping;
    }
    if (side_behind() < 0) return PlanarContact::separated;
    return ahead_->grazes || side_ahead_ == 0 || side_behind_ == 0 ? PlanarContact::touching
                                                                   : PlanarContact::overlapping;
  }

 private:
  int side(const ExitEdge& e) {
    ++probes_;
    return detail::side_of_edge(e.edge, p_.vertex(e.parts.vertex_p), q_.vertex(e.parts.vertex_q), y_);
  }
  std::optional<ExitEdge> exit_along(const Point2& d, bool turned) {
    if (auto exit = detail::find_exit_by_tables(p_, q_, y_, d, probes_)) return exit;
    if (!sides_) sides_.emplace(p_, q_, d_, probes_);
    return find_exit(p_, q_, y_, d, turned ? sides_->turned() : *sides_, probes_);
  }
  [[nodiscard]] detail::SumPoint point(const detail::VertexOfDifference& v) const {
    return {p_.vertex(v.p), q_.vertex(v.q)};
  }
  /// Does y lie beyond a chord of R that the line crosses? R lies between there and the exit.
  bool ahead_of_chords() {
    const auto ahead_of = [&](const detail::VertexOfDifference& right, const detail::VertexOfDifference& left) {
      ++probes_;
      return detail::exact_sign([&]<class N>() {
               const detail::SumPoint r = point(right);
               return cross(detail::from_to<N>(r, point(left)), detail::from_to<N>(r, {y_, {0, 0}}));
             }) < 0;
    };
    const ExitEdge& e = *ahead_;
    if (ahead_of(e.right, e.left)) return true;
    ++probes_;
    const int side = detail::offset_along(p_.vertex(e.back.p), q_.vertex(e.back.q), y_, {-d_[1], d_[0]}).sign;
    return side != 0 && (side > 0 ? ahead_of(e.right, e.back) : ahead_of(e.back, e.left));
  }

  const ConvexPolygon& p_;
  const ConvexPolygon& q_;
  const Point2 &y_, &d_;
  std::int64_t probes_ = 0;
  std::optional<detail::SideVertices> sides_;
  std::optional<ExitEdge> ahead_, behind_;
  int side_ahead_ = 0, side_behind_ = 0;
};

}  // namespace

Expected<PlanarDepth> convex_directional_depth(const ConvexPolygon& p, const ConvexPolygon& q,
                                               const Point2& displacement, const Point2& direction) {
  const detail::FloatingPointGuard guard;
  if (auto refused = detail::refused_point(displacement, "displacement")) return *std::move(refused);
  if (auto refused = detail::refused_direction(direction, "direction")) return *std::move(refused);
  Line line(p, q, displacement, direction);
  PlanarDepth out;
  out.contact = line.contact();
  out.probes = line.probes();
  if (out.contact != PlanarContact::overlapping) return out;
  const Rounded t = time_of(p, q, *line.ahead(), displacement, direction);
  out.lower = t.lower;
  out.upper = t.upper;
  out.depth = t.upper;
  out.edge = line.ahead()->parts;
  out.normal = detail::unit_normal(line.ahead()->edge);
  return out;
}

Expected<PlanarCrossing> convex_crossing(const ConvexPolygon& p, const ConvexPolygon& q, const Point2& displacement,
                                         const Point2& direction) {
  const detail::FloatingPointGuard guard;
  if (auto refused = detail::refused_point(displacement, "displacement")) return *std::move(refused);
  if (auto refused = detail::refused_direction(direction, "direction")) return *std::move(refused);
  Line line(p, q, displacement, direction);
  PlanarCrossing out;
  out.meets = line.ahead().has_value();
  if (out.meets) (void)line.behind();
  out.probes = line.probes();
  if (!out.meets) return out;
  const Rounded leave = time_of(p, q, *line.ahead(), displacement, direction);
  const Rounded enter = time_of(p, q, line.behind(), displacement, direction);
  // Inside the edge's line: ahead of y the end, behind it the beginning.
  out.leave_lower = line.side_ahead() >= 0 ? leave.lower : -leave.upper;
  out.leave_upper = line.side_ahead() >= 0 ? leave.upper : -leave.lower;
  out.enter_lower = line.side_behind() >= 0 ? -enter.upper : enter.lower;
  out.enter_upper = line.side_behind() >= 0 ? -enter.lower : enter.upper;
  return out;
}

Expected<PlanarContact> convex_intersection(const ConvexPolygon& p, const ConvexPolygon& q,
                                            const Point2& displacement) {
  const detail::FloatingPointGuard guard;
  if (auto refused = detail::refused_point(displacement, "displacement")) return *std::move(refused);
  const Point2 across = {1, 0};
  return Line(p, q, displacement, across).contact();
}

Expected<PlanarDepth> convex_depth(const ConvexPolygon& p, const ConvexPolygon& q, const Point2& displacement) {
  const detail::FloatingPointGuard guard;
  if (auto refused = detail::refused_point(displacement, "displacement")) return *std::move(refused);
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

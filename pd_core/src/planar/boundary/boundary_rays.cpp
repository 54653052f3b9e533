// Rays over the boundary of R: its first point ahead, and the class of a placement by the side from which it is met.
#include <array>
#include <cmath>
#include <limits>

#include "numeric/at.hpp"
#include "planar/boundary/boundary_query.hpp"
#include "planar/boundary/edge_ranges.hpp"
#include "planar/boundary/ray_search.hpp"

namespace pd::detail {

namespace {

/// d x (point - y), and what it errs by: the point is within 2^-51 `size`; four times the rounding of the differences
/// and products is left as air. What overflows is not certain.
struct RaySide {
  double value, air;
  RaySide(const RoundedRay& ray, const Point2& x, double size)
      : value(ray.d[0] * (x[1] - ray.y[1]) - ray.d[1] * (x[0] - ray.y[0])),
        air(0x1p-49 * ray.speed * (size + ray.reach) + 0x1p-1060) {}
  /// 1 left of the ray's line for certain, -1 right, 0 open.
  [[nodiscard]] int sign() const { return value > air ? 1 : (value < -air ? -1 : 0); }
};

/// Bounds of a parameter along the ray; open without them.
struct Bounds {
  double low = -std::numeric_limits<double>::infinity(), high = std::numeric_limits<double>::infinity();
};

/// Of the parameter at which the ray crosses the edge from a to b, which lie on different sides for certain.
///
/// The crossing parts the edge as |value of a| : |value of b|, and the parameter as well. The values err by `air`, so
/// does d . (point - y), so that the share errs by 2 air / sum at most and the parameter times d . d by less than what
/// is taken here. Left open where the sum is not much more than air.
Bounds bound_crossing(const RoundedRay& ray, const Point2& a, const Point2& b, const RaySide& at_a,
                      const RaySide& at_b) {
  const double sum = std::abs(at_a.value) + std::abs(at_b.value);
  if (!(sum >= 4 * at_a.air)) return {};
  const double from = ray.d[0] * (a[0] - ray.y[0]) + ray.d[1] * (a[1] - ray.y[1]);
  const double to = ray.d[0] * (b[0] - ray.y[0]) + ray.d[1] * (b[1] - ray.y[1]);
  const double along = from + std::abs(at_a.value) / sum * (to - from);
  const double error = at_a.air * (4 + 3 * std::abs(to - from) / sum);
  const double low = (along - error) * ray.per_square, high = (along + error) * ray.per_square;
  const double rounding = 0x1p-49 * (std::abs(low) + std::abs(high)) + 0x1p-1060;
  if (!std::isfinite(low - rounding) || !std::isfinite(high + rounding)) return {};
  return {low - rounding, high + rounding};
}

/// Do both ends of a span lie on one side of the ray's line for certain?
bool beside_line(const RoundedRay& ray, const Span& e) {
  const auto side = [&](const SumPoint& x) {
    const double size = std::max(std::abs(x.p[0]) + std::abs(x.q[0]), std::abs(x.p[1]) + std::abs(x.q[1]));
    return RaySide(ray, {x.p[0] - x.q[0], x.p[1] - x.q[1]}, size).sign();
  };
  return side(e.s) * side(e.z) > 0;
}

}  // namespace

/// Meets the boundary (loop 0 alone) along the search's ray, nearest boxes first ([D] section 4.3; the ears of Theorem
/// 4.5 are the boxes of arcs, shot through by halving).
void BoundaryQuery::search_ray(RaySearch& search, const Point2& d, bool outer_only) const {
  const RoundedRay ray(search.ray().s.p, d);
  search.boxes += ray_tree_.visit_places(ray, search.limit(), [&](std::size_t place) {
    const EdgeEnds& ends = ends_[place];
    const std::int32_t i = ends.stretch;
    if (outer_only && boundary_.stretches()[at(i)].loop != 0) return;
    if (ends.edge == EdgeEnds::kArc) {
      const Stretch& s = boundary_.stretches()[at(i)];
      const auto enter = [&](const Box2& box) { return std::isfinite(enter_ray(box, ray.y, ray.d, search.limit())); };
      visit_edges(boundary_, boundary_.candidate(s), SumBoundary::first_edge(s), SumBoundary::last_edge(s) + 1, enter,
                  [&](int e) {
                    const EdgePart part = boundary_.part(s, e);
                    if (!beside_line(ray, part.span)) search.meet(i, e, part);
                  });
      return;
    }
    const RaySide at_a(ray, ends.a, ends.size), at_b(ray, ends.b, ends.size);
    const int a = at_a.sign(), b = at_b.sign();
    if (a * b > 0) return;
    if (a * b == 0 || ends.edge == EdgeEnds::kOpen) {
      const Stretch& s = boundary_.stretches()[at(i)];
      const int e = SumBoundary::first_edge(s);
      return search.meet(i, e, boundary_.part(s, e));
    }
    const Bounds bounds = bound_crossing(ray, ends.a, ends.b, at_a, at_b);
    if (bounds.high < 0 || bounds.low > search.limit()) return;
    const Place crossing{Place::Kind::line, search.ray().s, search.ray().d};
    search.offer({{i, ends.edge, crossing}, true, true, b > 0, bounds.low, bounds.high});
  });
}

std::optional<BoundaryPoint> BoundaryQuery::first_on_ray(const Point2& y, const Point2& d, bool outer_only) const {
  RaySearch search(boundary_, y, d);
  search_ray(search, d, outer_only);
  if (!search.best()) return std::nullopt;
  return search.best()->point;
}

std::optional<PlanarContact> BoundaryQuery::contact_by_ray(const Point2& y, const Point2& d,
                                                           std::optional<BoundaryPoint>& hit,
                                                           std::int64_t* boxes) const {
  RaySearch search(boundary_, y, d);
  search_ray(search, d, false);
  if (boxes != nullptr) *boxes += search.boxes;
  if (!search.best()) return PlanarContact::separated;  // the ray goes to infinity, and y is not on the boundary
  const RayHit& best = *search.best();
  hit = best.point;
  if (!search.unique() || !best.crossing || search.sign(best) == 0) return std::nullopt;
  if (best.certain) return best.leaves ? PlanarContact::overlapping : PlanarContact::separated;
  const EdgePart part = boundary_.part(boundary_.stretches()[at(best.point.stretch)], best.point.edge);
  if (compare_places(part.span, part.from, best.point.at) >= 0) return std::nullopt;
  if (compare_places(part.span, best.point.at, part.to) >= 0) return std::nullopt;
  return cross_sign(part.span.d, search.ray().d) < 0 ? PlanarContact::overlapping : PlanarContact::separated;
}

PlanarContact BoundaryQuery::contact_and_hit(const Point2& y, const Point2& d, std::optional<BoundaryPoint>& touched,
                                             std::optional<BoundaryPoint>& hit, std::int64_t* boxes) const {
  if (const auto found = contact_by_ray(y, d, hit, boxes)) return *found;
  return contact_by_sums(y, &touched);
}

PlanarContact BoundaryQuery::contact(const Point2& y, std::optional<BoundaryPoint>* touched) const {
  std::optional<BoundaryPoint> hit;
  if (const auto found = contact_by_ray(y, {64, 7}, hit)) return *found;
  return contact_by_sums(y, touched);
}

bool BoundaryQuery::in_unbounded_face(const Point2& y) const {
  if (touch(y, true)) return true;
  // The first stretch that a ray meets borders the face of y, unless the ray runs into a point where loops meet.
  constexpr std::array<int, 12> kSlopes = {1, 7, -3, 11, -5, 2, 13, -17, 23, -29, 31, -37};
  for (const int slope : kSlopes) {
    const Point2 d = {64.0, static_cast<double>(slope)};
    RaySearch search(boundary_, y, d);
    search_ray(search, d, false);
    if (!search.best()) return true;
    if (search.unique()) return boundary_.stretches()[at(search.best()->point.stretch)].loop == 0;
  }
  // Every ray ran into a common point of stretches: decided by the last of them all the same.
  return !first_on_ray(y, {64.0, 1.0}, false).has_value();
}

}  // namespace pd::detail

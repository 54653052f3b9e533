// Polygons swept by discs: R swept by a disc of the radius r of both together. A placement belongs to it if its
// distance from R is less than r; the distance is exact, and what it changes by is never more than the way between
// placements.
#include <algorithm>
#include <cmath>
#include <memory>
#include <queue>

#include "numeric/length.hpp"
#include "numeric/root_sum.hpp"
#include "pd/planar/polygon_depth.hpp"
#include "planar/difference_state.hpp"
#include "planar/polygon_answer.hpp"
#include "planar/refused_point.hpp"

namespace pd {

namespace {

using detail::BoundaryPoint;
using detail::Dyadic;

constexpr double kBracket = 1e-6;   // of a depth that is searched for
constexpr int kMostBoxes = 20'000;  // some 0.2 s
constexpr int kMostSteps = 2'000;   // along a ray
constexpr double kAhead = 0x1p-40;  // a point meant to be on the boundary is tried so far beyond it
constexpr double kAir = 0x1p-48;    // more than the roundings of a point and of a length
constexpr double kLargestMargin = 1e300;

Point2 sum(const Point2& a, const Point2& b, double s) { return {a[0] + s * b[0], a[1] + s * b[1]}; }
double length_up(const Point2& a, const Point2& b) { return detail::length(b[0] - a[0], b[1] - a[1]) * (1 + 0x1p-50); }

/// The distance of a placement from R, negative inside.
struct Distance {
  double low = 0, high = 0;
  bool inside = false;
  Point2 outward = {0, 0};      ///< the unit vector in which it grows
  detail::ExactVector nearest;  ///< from the placement to R's nearest boundary point
  std::optional<BoundaryPoint> at;
};

}  // namespace

/// Works in the plane of the query, in which P and Q may stand in each other's place.
class SweptDifference {
 public:
  SweptDifference(const PolygonDifference::State& state, const PlanarMargins& margins)
      : s_(state), margins_(margins), radius_(Dyadic(margins.p) + Dyadic(margins.q)) {
    const double rounded = margins.p + margins.q;
    const int off = (radius_ - Dyadic(rounded)).sign();
    low_ = off < 0 ? std::nextafter(rounded, 0) : rounded;
    high_ = off > 0 ? std::nextafter(rounded, HUGE_VAL) : rounded;
    detail::Box2 q;
    for (const Point2& x : s_.q.points()) q.add(x);
    for (const Point2& x : s_.p.points()) {
      box_.add(Point2{x[0] - q.high[0], x[1] - q.high[1]});
      box_.add(Point2{x[0] - q.low[0], x[1] - q.low[1]});
    }
    box_ = box_.widened();
  }

  [[nodiscard]] bool convex() const { return s_.p.convex() && s_.q.convex(); }
  [[nodiscard]] bool one_convex() const { return s_.p.convex() || s_.q.convex(); }

  /// Class, feature and normal, and for convex polygons the depth; else its lower bound alone.
  [[nodiscard]] PolygonDepth bounded(const Point2& y) const {
    PolygonDepth answer;
    const Distance d = distance(y);
    const auto& v = d.nearest;
    const Dyadic squared = v.x * v.x + v.y * v.y, w = v.w * v.w;
    const int reach = d.inside ? 1 : (radius_ * radius_ * w - squared).sign();
    if (reach < 0) return answer;
    answer.contact = reach == 0 ? PlanarContact::touching : PlanarContact::overlapping;
    answer.normal = d.outward;
    answer.feature = feature(d);
    if (reach == 0) return turned(answer);
    const detail::RootSum depth(radius_, d.inside ? 1 : -1, squared, w);
    answer.lower = depth.round_down();
    answer.upper = answer.depth = depth.round_up(answer.lower);
    answer.translation = sum({0, 0}, answer.normal, answer.depth);
    return turned(answer);
  }

  /// The nearest placement at a distance of r or more from R, given a lower bound of the way to it.
  void search(const Point2& y, PolygonDepth& answer) const {
    best_ = outside_box(y);
    upper_ = length_up(y, best_);
    (void)offer(y, sum(y, s_.turned(answer.normal), answer.upper * (1 + kAhead)));
    double lower = answer.lower;
    if (upper_ * (1 - 2 * kAhead) > lower) lower = std::max(lower, search_boxes(y));
    answer.lower = std::min(lower, upper_);
    answer.upper = answer.depth = upper_;
    answer.translation = s_.turned({best_[0] - y[0], best_[1] - y[1]});
    const double size = detail::length(answer.translation[0], answer.translation[1]);
    if (size > 0) answer.normal = {answer.translation[0] / size, answer.translation[1] / size};
    answer.feature = feature(distance(best_));
  }

  /// The box around R swept does not hold y, which therefore is free to leave for good.
  [[nodiscard]] bool beside_box(const Point2& y) const {
    const double reach = high_ + air(y, high_);
    return y[0] < box_.low[0] - reach || y[1] < box_.low[1] - reach || y[0] > box_.high[0] + reach ||
           y[1] > box_.high[1] + reach;
  }

  /// The polygons around R swept by the disc, in the plane of the query.
  [[nodiscard]] Expected<std::shared_ptr<const detail::DiscBracket>> disc() const {
    std::shared_ptr<const detail::DiscBracket> kept = std::atomic_load(&s_.disc);
    if (kept && kept->radius == radius_) return kept;
    auto made = detail::DiscBracket::of(s_.p, s_.q, radius_, low_, high_);
    if (made) std::atomic_store(&s_.disc, *made);
    if (!made && made.error().code == ErrorCode::out_of_range) {
      return Error{ErrorCode::out_of_range, "the swept polygons reach beyond 1e300",
                   margins_.p > margins_.q ? "p.margin" : "q.margin"};
    }
    return made;
  }

  /// The ways out of the two polygons around R swept, as one answer.
  void bracket(const Point2& y, const PolygonDepth& inner, const PolygonDepth& outer, PolygonDepth& answer) const {
    answer.lower = std::min(inner.lower, outer.upper);
    answer.upper = answer.depth = outer.upper;
    answer.translation = s_.turned(outer.translation);
    if (outer.upper == 0) return;
    answer.normal = s_.turned(outer.normal);
    answer.feature = feature(distance(sum(y, outer.translation, 1)));
  }

  /// Forward to the first exit: no placement within r - distance of one can be outside.
  void first_exit(const Point2& y, const Point2& unit, PolygonDepth& answer) const {
    const double far = beyond(y, unit);
    double t = 0;
    for (int i = 0; i < kMostSteps; ++i) {
      const double gap = low_ - distance(sum(y, unit, t)).high - air(y, t);
      if (gap > kAhead * (t + high_)) {
        t += gap;
        continue;
      }
      for (const double ahead : {0x1p-38, 0x1p-34, 0x1p-28}) {
        const double next = t + ahead * (t + high_);
        if (is_outside(y, unit, next)) return finish(y, unit, {t, next}, answer);
      }
      t += std::max(gap, 0.0);
      if (gap <= 0) break;
    }
    // It grazes: some placement outside bounds the exit from above.
    for (int k = 1; k < 64; ++k) {
      const double next = t + (far - t) * k * k / (64.0 * 64.0);
      if (is_outside(y, unit, next)) return finish(y, unit, {t, next}, answer);
    }
    finish(y, unit, {t, far}, answer);
  }

  /// Backward from beyond R to the last exit.
  void last_exit(const Point2& y, const Point2& unit, PolygonDepth& answer) const {
    double t = beyond(y, unit);
    for (int i = 0; i < kMostSteps && t > 0; ++i) {
      const double gap = distance(sum(y, unit, t)).low - high_ - air(y, t);
      if (gap > kAhead * (t + high_)) {
        t -= gap;
        continue;
      }
      for (const double behind : {0x1p-38, 0x1p-34, 0x1p-28}) {
        const double before = t - behind * (t + high_);
        if (before < 0) return finish(y, unit, {0, t}, answer);
        if (distance(sum(y, unit, before)).high + air(y, before) < low_) {
          return finish(y, unit, {before, t}, answer);
        }
      }
      t -= kAhead * (t + high_);
      if (gap <= 0) return finish(y, unit, {0, t + 2 * kAhead * (t + high_)}, answer);
    }
    if (t > 0) finish(y, unit, {0, t}, answer);
  }

 private:
  [[nodiscard]] Distance distance(const Point2& z) const {
    Distance d;
    std::optional<BoundaryPoint> touched;
    PolygonDepth way;
    if (s_.p.is_point()) {  // both are
      const detail::SumPoint x{s_.p.point(0), s_.q.point(0)};
      d.nearest = detail::difference(detail::point_at<Dyadic>({x, {}, x}, {}), z);
    } else {
      const PlanarContact contact = s_.query.contact(z, &touched);
      d.inside = contact == PlanarContact::overlapping;
      d.at = touched ? touched : s_.query.nearest(z, false);
      d.nearest = detail::difference(detail::point_at<Dyadic>(s_.query.span_of(*d.at), d.at->at), z);
    }
    detail::fill(way, d.nearest, !d.inside);
    if (way.upper == 0 && d.at) detail::fill_touching(way, s_.query.span_of(*d.at), false);
    if (way.upper == 0 && !d.at) way.normal = {1, 0};
    d.outward = way.normal;
    d.low = d.inside ? -way.upper : way.lower;
    d.high = d.inside ? -way.lower : way.upper;
    return d;
  }

  [[nodiscard]] std::optional<PlanarFeature> feature(const Distance& d) const {
    if (d.at) return detail::feature_of(s_.boundary, s_.p, s_.q, *d.at, s_.swapped);
    return PlanarFeature{s_.p.caller_id(0), s_.q.caller_id(0)};
  }

  [[nodiscard]] PolygonDepth turned(PolygonDepth answer) const {
    answer.normal = s_.turned(answer.normal);
    answer.translation = s_.turned(answer.translation);
    return answer;
  }

  /// Beside the box around R, a hair more than r away.
  [[nodiscard]] Point2 outside_box(const Point2& y) const {
    Point2 best = y;
    double least = HUGE_VAL;
    for (const std::size_t k : {std::size_t{0}, std::size_t{1}}) {
      const double reach = high_ + kAir * (std::abs(box_.low[k]) + std::abs(box_.high[k]) + high_);
      for (const double at : {box_.low[k] - reach, box_.high[k] + reach}) {
        if (std::abs(at - y[k]) >= least) continue;
        least = std::abs(at - y[k]);
        best = y;
        best[k] = at;
      }
    }
    return best;
  }

  /// Takes z if it is nearer than the best one and certainly outside.
  bool offer(const Point2& y, const Point2& z) const {
    const double way = length_up(y, z);
    if (!(way < upper_) || !(distance(z).low >= high_)) return false;
    upper_ = way;
    best_ = z;
    return true;
  }

  struct Box {
    double low;  ///< no placement in it is nearer
    Point2 middle;
    double half;
    bool operator<(const Box& b) const { return low > b.low; }  // the nearest one first
  };

  /// Boxes around y, the nearest first, until the nearest one that may hold a placement outside is as far as the best
  /// such placement. @return a bound of the way to all of them.
  [[nodiscard]] double search_boxes(const Point2& y) const {
    std::priority_queue<Box> open;
    open.push({0, y, upper_});
    for (int i = 0; i < kMostBoxes && !open.empty(); ++i) {
      const Box box = open.top();
      if (box.low >= upper_ * (1 - kBracket)) break;
      open.pop();
      const Distance d = distance(box.middle);
      const double across = box.half * 1.4142135623730953;
      if (d.high + across + kAir * (std::abs(d.high) + across) < low_) continue;
      if (!offer(y, box.middle) && !d.inside && d.high > 0) {
        (void)offer(y, sum(box.middle, d.outward, high_ * (1 + kAhead) - d.low));
      }
      for (const double x : {-0.5, 0.5}) {
        for (const double z : {-0.5, 0.5}) {
          const Point2 middle = {box.middle[0] + x * box.half, box.middle[1] + z * box.half};
          const double half = 0.5 * box.half;
          const double dx = std::max(0.0, std::abs(middle[0] - y[0]) - half);
          const double dy = std::max(0.0, std::abs(middle[1] - y[1]) - half);
          const double size = std::abs(y[0]) + std::abs(y[1]) + box.half;
          const double low = std::max(box.low, detail::length(dx, dy) * (1 - 0x1p-50) - 0x1p-50 * size);
          if (low < upper_ * (1 - kBracket)) open.push({low, middle, half * (1 + 0x1p-40)});
        }
      }
    }
    return open.empty() ? upper_ * (1 - kBracket) : std::min(open.top().low, upper_ * (1 - kBracket));
  }

  [[nodiscard]] double air(const Point2& y, double t) const {
    return kAir * (std::abs(y[0]) + std::abs(y[1]) + t) + 0x1p-1040;
  }
  [[nodiscard]] bool is_outside(const Point2& y, const Point2& unit, double t) const {
    return distance(sum(y, unit, t)).low - air(y, t) >= high_;
  }
  /// A parameter from which on the ray is outside for certain.
  [[nodiscard]] double beyond(const Point2& y, const Point2& unit) const {
    double far = HUGE_VAL;
    for (const std::size_t k : {std::size_t{0}, std::size_t{1}}) {
      if (std::abs(unit[k]) < 0.5) continue;
      const double reach = (unit[k] > 0 ? box_.high[k] - y[k] : y[k] - box_.low[k]) + 2 * high_;
      far = std::min(far, std::max(0.0, reach / std::abs(unit[k])) * (1 + 0x1p-40) + air(y, std::abs(reach)));
    }
    return far;
  }

  struct Exit {
    double lower, upper;
  };
  void finish(const Point2& y, const Point2& unit, const Exit& exit, PolygonDepth& answer) const {
    answer.lower = std::max(0.0, exit.lower);
    answer.upper = answer.depth = exit.upper;
    answer.normal = s_.turned(unit);
    answer.translation = sum({0, 0}, answer.normal, exit.upper);
    answer.feature = feature(distance(sum(y, unit, exit.upper)));
  }

  const PolygonDifference::State& s_;
  PlanarMargins margins_;
  Dyadic radius_;
  double low_, high_;  ///< of the radius
  detail::Box2 box_;   ///< around R
  mutable Point2 best_ = {0, 0};
  mutable double upper_ = HUGE_VAL;
};

namespace {

std::optional<Error> check_margins(const PlanarMargins& margins) {
  for (const auto& [margin, name] : {std::pair{margins.p, "p.margin"}, std::pair{margins.q, "q.margin"}}) {
    if (!std::isfinite(margin)) return Error{ErrorCode::non_finite, "a margin must be a finite number", name};
    if (margin < 0) return Error{ErrorCode::bad_value, "a margin must not be negative", name};
    if (margin > kLargestMargin) return Error{ErrorCode::out_of_range, "a margin must be at most 1e300", name};
  }
  return std::nullopt;
}

}  // namespace

Expected<PolygonDepth> PolygonDifference::swept_depth(const Point2& placement, const PlanarMargins& margins,
                                                      Leave leave) const {
  if (auto error = check_margins(margins)) return *std::move(error);
  if (auto error = detail::refused_point(placement, "placement")) return *std::move(error);
  const SweptDifference swept(*state_, margins);
  const Point2 y = state_->turned(placement);
  PolygonDepth answer = swept.bounded(y);
  if (swept.convex()) return answer;
  if (leave == Leave::first_exit) {
    if (answer.contact == PlanarContact::overlapping) swept.search(y, answer);
    return answer;
  }
  if (swept.one_convex() && swept.beside_box(y)) return answer;
  const auto disc = swept.disc();
  if (!disc) return disc.error();
  const auto way_out = [&](const PolygonDifference& r) {
    return leave == Leave::straight ? r.straight_escape_depth(y) : r.escape_depth(y);
  };
  swept.bracket(y, way_out((*disc)->inner), way_out((*disc)->outer), answer);
  return answer;
}

Expected<PolygonDepth> PolygonDifference::swept_depth_along(const Point2& placement, const Point2& direction,
                                                            const PlanarMargins& margins, Leave leave) const {
  if (auto error = check_margins(margins)) return *std::move(error);
  if (auto error = detail::refused_point(placement, "placement")) return *std::move(error);
  if (auto error = detail::refused_direction(direction, "direction")) return *std::move(error);
  const SweptDifference swept(*state_, margins);
  const Point2 y = state_->turned(placement);
  PolygonDepth answer = swept.bounded(y);
  answer.depth = answer.lower = answer.upper = 0;
  answer.translation = {0, 0};
  const Point2 ahead = detail::raised(direction);
  const double size = detail::length(ahead[0], ahead[1]);
  const Point2 unit = state_->turned({ahead[0] / size, ahead[1] / size});
  if (leave == Leave::escape && !swept.convex()) {
    const auto disc = swept.disc();
    if (!disc) return disc.error();
    swept.bracket(y, (*disc)->inner.depth_along(y, unit, leave), (*disc)->outer.depth_along(y, unit, leave), answer);
  } else if (leave == Leave::straight) {
    swept.last_exit(y, unit, answer);
  } else if (answer.contact == PlanarContact::overlapping) {
    swept.first_exit(y, unit, answer);
  }
  return answer;
}

}  // namespace pd

#include "planar/boundary/boundary_query.hpp"

#include <cmath>

#include "numeric/at.hpp"
#include "planar/boundary/edge_ranges.hpp"

namespace pd::detail {

namespace {

std::vector<Box2> boxes_of(const SumBoundary& boundary, const std::vector<Stretch>& stretches) {
  std::vector<Box2> boxes;
  boxes.reserve(stretches.size());
  for (const Stretch& s : stretches) boxes.push_back(boundary.box(s));
  return boxes;
}

Box2 sum_box(const ConvexSum& sum) {
  Box2 p, box;
  for (int a = 0; a < sum.num_corners(); ++a) p.add(sum.corner(a));
  const Box2 q = sum.chain().box(0, sum.chain().size());
  box.add(Point2{p.low[0] - q.high[0], p.low[1] - q.high[1]});
  box.add(Point2{p.high[0] - q.low[0], p.high[1] - q.low[1]});
  return box.widened();
}

}  // namespace

/// In the tree of rays an edge stands by its ends, an arc by its box.
void BoundaryQuery::add_ray_items() {
  std::vector<TurnedBoxes::Item> items;
  items.reserve(boundary_.stretches().size());
  std::vector<EdgeEnds> all;
  all.reserve(boundary_.stretches().size());
  for (const Stretch& s : boundary_.stretches()) {
    const auto index = static_cast<std::int32_t>(all.size());
    const int first = SumBoundary::first_edge(s);
    if (first != SumBoundary::last_edge(s)) {
      const Box2 box = boundary_.box(s);
      const double size =
          std::max({std::abs(box.low[0]), std::abs(box.low[1]), std::abs(box.high[0]), std::abs(box.high[1])});
      items.push_back({{box.low, Point2{box.low[0], box.high[1]}, Point2{box.high[0], box.low[1]}, box.high}, size});
      all.push_back({{}, {}, 0, index, EdgeEnds::kArc});
      continue;
    }
    const Span e = boundary_.edge(boundary_.candidate(s), first);
    EdgeEnds ends{{}, {}, 0, index, first};
    const auto whole_edge = [&](const SumPoint& x, Point2& rounded) {
      for (std::size_t k = 0; k < 2; ++k) {
        rounded[k] = x.p[k] - x.q[k];
        ends.size = std::max(ends.size, std::abs(x.p[k]) + std::abs(x.q[k]));
      }
    };
    whole_edge(e.s, ends.a);
    whole_edge(e.z, ends.b);
    const EdgePart part = boundary_.part(s, first);
    for (const auto& [place, rounded] : {std::pair{&part.from, &ends.a}, std::pair{&part.to, &ends.b}}) {
      if (place->kind == Place::Kind::start || place->kind == Place::Kind::end) continue;
      const auto x = point_at<Estimate>(e, *place);
      const double w = std::abs(x.w.value) - x.w.error;
      const Point2 middle = {x.x.value / x.w.value, x.y.value / x.w.value};
      const auto bound = [&](double rounding, double value) {
        return (rounding + std::abs(value) * x.w.error) / w + 0x1p-52 * std::abs(value);
      };
      const double error_x = bound(x.x.error, middle[0]), error_y = bound(x.y.error, middle[1]);
      const double error = std::max(error_x, error_y);
      // Crossings at small angles err by more than others; the size says by how much, so that they are good all the
      // same.
      if (w > 0 && error_x <= 0x1p-24 * ends.size && error_y <= 0x1p-24 * ends.size) {  // both: one may be NaN
        *rounded = middle;
        ends.size = std::max(ends.size, 0x1p52 * error);
      } else {
        ends.edge = EdgeEnds::kOpen;
      }
    }
    items.push_back({{ends.a, ends.a, ends.b, ends.b}, ends.size});
    all.push_back(ends);
  }
  ray_tree_ = TurnedBoxes(items);
  ends_.reserve(all.size());
  for (const std::int32_t i : ray_tree_.order()) ends_.push_back(all[at(i)]);
}

BoundaryQuery::BoundaryQuery(const SumBoundary& boundary)
    : boundary_(boundary),
      stretch_tree_(boxes_of(boundary, boundary.stretches())),
      slot_tree_(boxes_of(boundary, boundary.slots())) {
  std::vector<Box2> boxes;
  boxes.reserve(boundary.sums().size());
  for (const ConvexSum& sum : boundary.sums()) boxes.push_back(sum_box(sum));
  sum_tree_ = BoxTree(std::move(boxes));
  add_ray_items();
}

Span BoundaryQuery::span_of(const BoundaryPoint& x) const {
  return boundary_.edge(boundary_.candidate(boundary_.stretches()[at(x.stretch)]), x.edge);
}

std::optional<BoundaryPoint> BoundaryQuery::touch(const Point2& y, bool outer_only) const {
  Box2 here;
  here.add(y);
  const SumPoint x = point(y);
  std::optional<BoundaryPoint> found;
  const auto enter = [&](const Box2& box) { return !found && box.meets(here); };
  stretch_tree_.visit(enter, [&](std::int32_t i) {
    const Stretch& s = boundary_.stretches()[at(i)];
    if (outer_only && s.loop != 0) return;
    visit_edges(
        boundary_, boundary_.candidate(s), SumBoundary::first_edge(s), SumBoundary::last_edge(s) + 1, enter,
        [&](int e) {
          const EdgePart part = boundary_.part(s, e);
          if (side_of(part.span.s, part.span.d, x) != 0) return;
          const Place place{Place::Kind::point, x, {}};
          if (compare_places(part.span, part.from, place) <= 0 && compare_places(part.span, place, part.to) <= 0) {
            found = BoundaryPoint{i, e, place};
          }
        });
  });
  return found;
}

PlanarContact BoundaryQuery::contact_by_sums(const Point2& y, std::optional<BoundaryPoint>* touched) const {
  Box2 here;
  here.add(y);
  const SumPoint x = point(y);
  bool inside = false, closed = false;
  sum_tree_.visit([&](const Box2& box) { return !inside && box.meets(here); },
                  [&](std::int32_t i) {
                    if (inside) return;
                    const ConvexSum& sum = boundary_.sums()[at(i)];
                    inside = sum.locate(x).inside;
                    closed = closed || inside || sum.contains(x);
                  });
  if (inside) return PlanarContact::overlapping;
  if (!closed) return PlanarContact::separated;
  const auto found = touch(y, false);
  if (touched != nullptr) *touched = found;
  // In the closure of R but not on its boundary: in a slot, which is no way out.
  return found ? PlanarContact::touching : PlanarContact::overlapping;
}

bool BoundaryQuery::is_seat(const Point2& y) const {
  Box2 here;
  here.add(y);
  const SumPoint x = point(y);
  bool inside = false;
  sum_tree_.visit([&](const Box2& box) { return !inside && box.meets(here); },
                  [&](std::int32_t i) { inside = inside || boundary_.sums()[at(i)].locate(x).inside; });
  return !inside;
}

std::optional<Place> BoundaryQuery::last_exit(const Point2& y, const Point2& d) const {
  const Span ray{point(y), {{0, 0}, d}, {}};
  std::optional<Place> best;
  const auto offer = [&](const Place& place) {
    if (compare_places(ray, place, {}) <= 0) return;
    if (!best || compare_places(ray, place, *best) > 0) best = place;
  };
  const auto enter = [&](const Box2& box) {
    return std::isfinite(enter_ray(box, y, d, std::numeric_limits<double>::infinity()));
  };
  sum_tree_.visit(enter, [&](std::int32_t i) {
    const auto cover = boundary_.sums()[at(i)].cover_of_line(ray);
    if (cover && cover->kind == ConvexSum::Cover::Kind::inside) offer(cover->to);
  });
  slot_tree_.visit(enter, [&](std::int32_t i) {
    const Stretch& s = boundary_.slots()[at(i)];
    for (int e = SumBoundary::first_edge(s); e <= SumBoundary::last_edge(s); ++e) {
      const EdgePart part = boundary_.part(s, e);
      if (cross_sign(part.span.d, ray.d) != 0 || side_of(part.span.s, part.span.d, ray.s) != 0) continue;
      for (const Place& end : {part.from, part.to}) {
        if (end.kind == Place::Kind::start || end.kind == Place::Kind::end) {
          offer({Place::Kind::point, end.kind == Place::Kind::start ? part.span.s : part.span.z, {}});
        } else {
          offer(end);
        }
      }
    }
  });
  return best;
}

struct BoundaryQuery::NearestSearch {
  const SumBoundary& boundary;
  SumPoint y;
  double limit = std::numeric_limits<double>::infinity();  ///< a bound of the best squared distance
  struct Found {
    BoundaryPoint point;
    Span span;
    double low;  ///< a bound of its squared distance
  };
  std::vector<Found> found = {};

  /// Squared distance of y to a place, as a fraction.
  template <class N>
  [[nodiscard]] static Fraction<N> squared(const Span& span, const Place& at, const SumPoint& y) {
    const Homogeneous<N> x = point_at<N>(span, at);
    const N dx = x.x - N(y.p[0]) * x.w, dy = x.y - N(y.p[1]) * x.w;
    return {dx * dx + dy * dy, x.w * x.w};
  }
  /// The same for the foot of the perpendicular: cross^2 / |d|^2.
  template <class N>
  [[nodiscard]] static Fraction<N> squared_to_line(const Span& span, const SumPoint& y) {
    const Vector2<N> d = vector<N>(span.d);
    const N c = cross(d, from_to<N>(span.s, y));
    return {c * c, dot(d, d)};
  }

  void offer(std::int32_t index, int edge, const EdgePart& part) {
    const Place foot{Place::Kind::point, y, {}};  // its fraction along the edge is that of the foot
    Found f{{index, edge, foot}, part.span, 0};
    const bool on_part = compare_places(part.span, part.from, foot) < 0 && compare_places(part.span, foot, part.to) < 0;
    if (!on_part) f.point.at = compare_places(part.span, foot, part.from) <= 0 ? part.from : part.to;
    const auto e = on_part ? squared_to_line<Estimate>(part.span, y) : squared<Estimate>(part.span, f.point.at, y);
    const double w_low = e.denominator.value - e.denominator.error, w_high = e.denominator.value + e.denominator.error;
    f.low = std::max(0.0, (e.numerator.value - e.numerator.error) / w_high * (1 - 0x1p-50));
    if (!(f.low >= 0)) f.low = 0;
    if (f.low > limit) return;
    found.push_back(f);
    if (w_low > 0) {
      const double high = (e.numerator.value + e.numerator.error) / w_low * (1 + 0x1p-50);
      if (high < limit) limit = high;
    }
  }
};

std::optional<BoundaryPoint> BoundaryQuery::nearest(const Point2& y, bool outer_only) const {
  NearestSearch search{boundary_, point(y)};
  const auto enter = [&](const Box2& box) { return box.distance_squared(y) * (1 - 0x1p-40) <= search.limit; };
  const auto first = [&](const Box2& box) { return box.distance_squared(y); };
  stretch_tree_.visit(enter, first, [&](std::int32_t i) {
    const Stretch& s = boundary_.stretches()[at(i)];
    if (outer_only && s.loop != 0) return;
    visit_edges(boundary_, boundary_.candidate(s), SumBoundary::first_edge(s), SumBoundary::last_edge(s) + 1, enter,
                [&](int e) { search.offer(i, e, boundary_.part(s, e)); });
  });
  std::optional<NearestSearch::Found> best;
  Fraction<Dyadic> best_squared;
  Homogeneous<Dyadic> best_point;
  for (const auto& f : search.found) {
    if (f.low > search.limit) continue;
    const Fraction<Dyadic> squared = f.point.at.kind == Place::Kind::point && same(f.point.at.point, search.y)
                                         ? NearestSearch::squared_to_line<Dyadic>(f.span, search.y)
                                         : NearestSearch::squared<Dyadic>(f.span, f.point.at, search.y);
    const Homogeneous<Dyadic> x = point_at<Dyadic>(f.span, f.point.at);
    if (best) {
      int order = (squared.numerator * best_squared.denominator - best_squared.numerator * squared.denominator).sign();
      const int w = x.w.sign() * best_point.w.sign();
      if (order == 0) order = w * (x.x * best_point.w - best_point.x * x.w).sign();
      if (order == 0) order = w * (x.y * best_point.w - best_point.y * x.w).sign();
      if (order >= 0) continue;
    }
    best = f;
    best_squared = squared;
    best_point = x;
  }
  if (!best) return std::nullopt;
  return best->point;
}

}  // namespace pd::detail

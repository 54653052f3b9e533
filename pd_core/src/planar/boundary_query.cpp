#include "planar/boundary_query.hpp"

#include <array>
#include <cmath>

namespace pd::detail {

namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

std::vector<Box2> boxes_of(const SumBoundary& boundary, const std::vector<Stretch>& stretches) {
  std::vector<Box2> boxes;
  boxes.reserve(stretches.size());
  for (const Stretch& s : stretches) boxes.push_back(boundary.box(s));
  return boxes;
}

Box2 sum_box(const ConvexSum& sum) {
  Box2 p, box;
  for (int a = 0; a < 3; ++a) p.add(sum.corner(a));
  const Box2 q = sum.chain().box(0, sum.chain().size());
  box.add(Point2{p.low[0] - q.high[0], p.low[1] - q.high[1]});
  box.add(Point2{p.high[0] - q.low[0], p.high[1] - q.low[1]});
  return box.widened();
}

/// Calls visit(edge) for the edges [begin, end) of a candidate that lie in boxes with enter(box), halving the range.
template <class Enter, class Visit>
void visit_edges(const SumBoundary& boundary, const Candidate& c, int begin, int end, const Enter& enter,
                 const Visit& visit) {
  if (!enter(boundary.box(c, begin, end))) return;
  if (end - begin == 1) return visit(begin);
  const int middle = (begin + end) / 2;
  visit_edges(boundary, c, begin, middle, enter, visit);
  visit_edges(boundary, c, middle, end, enter, visit);
}

/// Does the box meet the ray from y along d at a parameter in [0, limit]? Returns a number not above the first one
/// there, or infinity.
double enter_ray(const Box2& box, const Point2& y, const Point2& d, double limit) {
  double low = 0, high = limit;
  for (std::size_t k = 0; k < 2; ++k) {
    if (d[k] == 0) {
      if (y[k] < box.low[k] || y[k] > box.high[k]) return std::numeric_limits<double>::infinity();
      continue;
    }
    double a = (box.low[k] - y[k]) / d[k], b = (box.high[k] - y[k]) / d[k];
    if (a > b) std::swap(a, b);
    // A few roundings of the difference and of the quotient.
    const double air = 0x1p-48 * std::max(std::abs(a), std::abs(b)) + 0x1p-48 * std::abs(y[k] / d[k]);
    low = std::max(low, a - air);
    high = std::min(high, b + air);
  }
  return low <= high ? low : std::numeric_limits<double>::infinity();
}

/// Do both ends of a span lie on one side of the line through y along d for certain? In doubles: four times the
/// rounding of the differences and products is left as air. What overflows is not certain.
bool beside_line(const Span& e, const Point2& y, const Point2& d) {
  const auto side = [&](const SumPoint& x) {
    const double px = (x.p[0] - x.q[0]) - y[0], py = (x.p[1] - x.q[1]) - y[1];
    const double size_x = std::abs(x.p[0]) + std::abs(x.q[0]) + std::abs(y[0]);
    const double size_y = std::abs(x.p[1]) + std::abs(x.q[1]) + std::abs(y[1]);
    const double value = d[0] * py - d[1] * px;
    const double air = 0x1p-49 * (std::abs(d[0]) * size_y + std::abs(d[1]) * size_x) + 0x1p-1060;
    return value > air ? 1 : (value < -air ? -1 : 0);
  };
  return side(e.s) * side(e.z) > 0;
}

}  // namespace

BoundaryQuery::BoundaryQuery(const SumBoundary& boundary)
    : boundary_(boundary),
      stretch_tree_(boxes_of(boundary, boundary.stretches())),
      slot_tree_(boxes_of(boundary, boundary.slots())) {
  std::vector<Box2> boxes;
  boxes.reserve(boundary.sums().size());
  for (const ConvexSum& sum : boundary.sums()) boxes.push_back(sum_box(sum));
  sum_tree_ = BoxTree(std::move(boxes));
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

/// A meeting of the ray with an edge part: at a place on the edge, at a place along the ray.
struct BoundaryQuery::Hit {
  BoundaryPoint point;
  Span span;
  bool crossing;  ///< of the ray with the edge's line; otherwise a point of an edge that lies along the ray
  template <class N>
  [[nodiscard]] Fraction<N> along(const Span& ray) const {
    if (crossing) {
      return fraction<N>(ray, Place{Place::Kind::line, span.s, span.d});
    }
    const Homogeneous<N> x = point_at<N>(span, point.at);
    const Vector2<N> d = vector<N>(ray.d);
    const Vector2<N> y = {N(ray.s.p[0]), N(ray.s.p[1])};
    return {(x.x - y.x * x.w) * d.x + (x.y - y.y * x.w) * d.y, x.w * dot(d, d)};
  }
};

struct BoundaryQuery::RaySearch {
  const BoundaryQuery& query;
  Span ray;
  Point2 direction;
  std::optional<Hit> best;
  double limit = std::numeric_limits<double>::infinity();  ///< a bound of the best one's parameter
  bool unique = true;

  RaySearch(const BoundaryQuery& q, const Point2& y, const Point2& d)
      : query(q), ray{point(y), {{0, 0}, d}, {}}, direction(d) {}

  [[nodiscard]] int sign(const Hit& hit) const {
    return exact_sign([&]<class N>() { return hit.along<N>(ray).numerator; }) *
           exact_sign([&]<class N>() { return hit.along<N>(ray).denominator; });
  }
  [[nodiscard]] int compare(const Hit& a, const Hit& b) const {
    const auto evaluate = [&]<class N>() {
      const Fraction<N> f = a.along<N>(ray), g = b.along<N>(ray);
      return std::array<N, 3>{f.numerator * g.denominator - g.numerator * f.denominator, f.denominator, g.denominator};
    };
    const auto estimate = evaluate.template operator()<Estimate>();
    const int s = estimate[0].certain_sign() * estimate[1].certain_sign() * estimate[2].certain_sign();
    if (s != 0) return s;
    const auto exact = evaluate.template operator()<Dyadic>();
    return exact[0].sign() * exact[1].sign() * exact[2].sign();
  }
  void offer(const Hit& hit) {
    if (sign(hit) < 0) return;
    if (best) {
      const int order = compare(hit, *best);
      if (order == 0 && hit.point.stretch != best->point.stretch) unique = false;
      if (order >= 0) return;
    }
    unique = true;
    best = hit;
    const auto f = hit.along<Estimate>(ray);
    const double w = std::abs(f.denominator.value) - f.denominator.error;
    const double bound = (std::abs(f.numerator.value) + f.numerator.error) / w * (1 + 0x1p-40);
    if (w > 0 && std::isfinite(bound)) limit = std::min(limit, bound);
  }
  void meet(std::int32_t index, int edge, const EdgePart& part) {
    const Place crossing{Place::Kind::line, ray.s, ray.d};
    if (cross_sign(part.span.d, ray.d) != 0) {
      if (compare_places(part.span, part.from, crossing) <= 0 && compare_places(part.span, crossing, part.to) <= 0) {
        offer({{index, edge, crossing}, part.span, true});
      }
      return;
    }
    if (side_of(part.span.s, part.span.d, ray.s) != 0) return;
    const Place here{Place::Kind::point, ray.s, {}};
    if (compare_places(part.span, part.from, here) <= 0 && compare_places(part.span, here, part.to) <= 0) {
      offer({{index, edge, here}, part.span, false});
    }
    offer({{index, edge, part.from}, part.span, false});
    offer({{index, edge, part.to}, part.span, false});
  }
};

/// Meets the boundary (loop 0 alone) along the search's ray, nearest boxes first.
void BoundaryQuery::search_ray(RaySearch& search, bool outer_only) const {
  const Point2 &y = search.ray.s.p, &d = search.direction;
  const auto enter = [&](const Box2& box) { return std::isfinite(enter_ray(box, y, d, search.limit)); };
  const auto first = [&](const Box2& box) { return enter_ray(box, y, d, search.limit); };
  stretch_tree_.visit(enter, first, [&](std::int32_t i) {
    const Stretch& s = boundary_.stretches()[at(i)];
    if (outer_only && s.loop != 0) return;
    visit_edges(boundary_, boundary_.candidate(s), SumBoundary::first_edge(s), SumBoundary::last_edge(s) + 1, enter,
                [&](int e) {
                  const EdgePart part = boundary_.part(s, e);
                  if (!beside_line(part.span, y, d)) search.meet(i, e, part);
                });
  });
}

std::optional<BoundaryPoint> BoundaryQuery::first_on_ray(const Point2& y, const Point2& d, bool outer_only) const {
  RaySearch search(*this, y, d);
  search_ray(search, outer_only);
  if (!search.best) return std::nullopt;
  return search.best->point;
}

std::optional<PlanarContact> BoundaryQuery::contact_by_ray(const Point2& y, const Point2& d,
                                                           std::optional<BoundaryPoint>& hit) const {
  RaySearch search(*this, y, d);
  search_ray(search, false);
  if (!search.best) return PlanarContact::separated;  // the ray goes to infinity, and y is not on the boundary
  const Hit& best = *search.best;
  hit = best.point;
  if (!search.unique || !best.crossing || search.sign(best) == 0) return std::nullopt;
  const EdgePart part = boundary_.part(boundary_.stretches()[at(best.point.stretch)], best.point.edge);
  if (compare_places(part.span, part.from, best.point.at) >= 0) return std::nullopt;
  if (compare_places(part.span, best.point.at, part.to) >= 0) return std::nullopt;
  return cross_sign(part.span.d, search.ray.d) < 0 ? PlanarContact::overlapping : PlanarContact::separated;
}

PlanarContact BoundaryQuery::contact_and_hit(const Point2& y, const Point2& d, std::optional<BoundaryPoint>& touched,
                                             std::optional<BoundaryPoint>& hit) const {
  if (const auto found = contact_by_ray(y, d, hit)) return *found;
  return contact_by_sums(y, &touched);
}

PlanarContact BoundaryQuery::contact(const Point2& y, std::optional<BoundaryPoint>* touched) const {
  std::optional<BoundaryPoint> hit;
  if (const auto found = contact_by_ray(y, {64, 7}, hit)) return *found;
  return contact_by_sums(y, touched);
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

bool BoundaryQuery::in_unbounded_face(const Point2& y) const {
  if (touch(y, true)) return true;
  // The first stretch that a ray meets borders the face of y, unless the ray runs into a point where loops meet.
  constexpr std::array<int, 12> kSlopes = {1, 7, -3, 11, -5, 2, 13, -17, 23, -29, 31, -37};
  for (const int slope : kSlopes) {
    const Point2 d = {64.0, static_cast<double>(slope)};
    RaySearch search(*this, y, d);
    search_ray(search, false);
    if (!search.best) return true;
    if (search.unique) return boundary_.stretches()[at(search.best->point.stretch)].loop == 0;
  }
  // Every ray ran into a common point of stretches: decided by the last of them all the same.
  return !first_on_ray(y, {64.0, 1.0}, false).has_value();
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

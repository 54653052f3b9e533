#include "planar/boundary/seats.hpp"

#include <algorithm>

#include "numeric/at.hpp"
#include "numeric/quotient.hpp"

namespace pd::detail {

namespace {

/// A point with w > 0.
Homogeneous<Dyadic> exact_point(const Span& span, const Place& at) {
  Homogeneous<Dyadic> x = point_at<Dyadic>(span, at);
  if (x.w.sign() < 0) x = {-x.x, -x.y, -x.w};
  return x;
}
Point2 rounded(const Homogeneous<Dyadic>& x) { return {quotient(x.x, x.w), quotient(x.y, x.w)}; }

/// The vector from s to x, times x.w.
Vector2<Dyadic> from_start(const SumPoint& s, const Homogeneous<Dyadic>& x) {
  return {x.x - (Dyadic(s.p[0]) - Dyadic(s.q[0])) * x.w, x.y - (Dyadic(s.p[1]) - Dyadic(s.q[1])) * x.w};
}
int side_of_edge(const Span& e, const Homogeneous<Dyadic>& x) {
  return cross(vector<Dyadic>(e.d), from_start(e.s, x)).sign();
}
bool lies_on(const EdgePart& part, const Homogeneous<Dyadic>& x) {
  if (side_of_edge(part.span, x) != 0) return false;
  const Vector2<Dyadic> d = vector<Dyadic>(part.span.d);
  const Dyadic along = dot(from_start(part.span.s, x), d);
  const auto order = [&](const Place& end) {  // of the end and x along the edge
    const Homogeneous<Dyadic> y = exact_point(part.span, end);
    return (dot(from_start(part.span.s, y), d) * x.w - along * y.w).sign();
  };
  return order(part.from) <= 0 && order(part.to) >= 0;
}

/// Slots on one line follow each other, in the order of the lines.
bool line_before(const EdgePart& a, const EdgePart& b) {
  const auto upward = [](const PlaneDirection& d) { return half_of(d) == 0 ? d : d.reversed(); };
  const PlaneDirection u = upward(a.span.d), v = upward(b.span.d);
  const int turn = compare_angles(u, v);
  return turn != 0 ? turn < 0 : side_of(a.span.s, u, b.span.s) > 0;
}

}  // namespace

std::vector<Position> seat_places_of(const SumBoundary& boundary, const Candidate& candidate,
                                     const CandidateCover& cover) {
  if (cover.parts.empty()) return {};
  const CoveredIntervals order(boundary, candidate);
  std::vector<CoveredIntervals::Interval> parts = cover.parts;
  parts.insert(parts.end(), cover.abutting.begin(), cover.abutting.end());
  CoveredIntervals all(boundary, candidate);
  for (const auto& part : parts) all.add(part);
  const auto rest = all.rest();
  std::vector<Position> ends = {{0, {}}, {candidate.count, {}}};
  for (const auto& part : parts) {
    ends.push_back(part.from);
    ends.push_back(part.to);
  }
  std::vector<Position> found;
  for (const Position& x : ends) {
    const auto inside = [&](const CoveredIntervals::Interval& part) {
      return order.compare(part.from, x) < 0 && order.compare(x, part.to) < 0;
    };
    const auto reaches = [&](const CoveredIntervals::Interval& part) {
      return order.compare(part.from, x) <= 0 && order.compare(x, part.to) <= 0;
    };
    const auto is_same = [&](const Position& y) { return order.compare(x, y) == 0; };
    if (std::any_of(cover.parts.begin(), cover.parts.end(), inside)) continue;
    if (std::any_of(rest.begin(), rest.end(), reaches) || std::any_of(found.begin(), found.end(), is_same)) continue;
    found.push_back(x);
  }
  return found;
}

std::vector<Point2> single_seats(const BoundaryQuery& query) {
  const SumBoundary& boundary = query.boundary();
  std::vector<Point2> seats;
  for (const SeatPlace& m : boundary.seat_places()) {
    const EdgePart place = boundary.place(m);
    const Homogeneous<Dyadic> x = exact_point(place.span, place.from);
    const Point2 near = rounded(x);
    Box2 here;
    here.add(near);
    here = here.widened();
    const auto on_any = [&](const BoxTree& tree, const std::vector<Stretch>& list) {
      bool on = false;
      const auto enter = [&](const Box2& box) { return !on && box.meets(here); };
      tree.visit(enter, [&](std::int32_t i) {
        const Stretch& s = list[at(i)];
        for (int e = SumBoundary::first_edge(s); e <= SumBoundary::last_edge(s) && !on; ++e) {
          on = lies_on(boundary.part(s, e), x);
        }
      });
      return on;
    };
    bool inside = false;
    query.sum_tree().visit([&](const Box2& box) { return !inside && box.meets(here); },
                           [&](std::int32_t i) {
                             const ConvexSum& sum = boundary.sums()[at(i)];
                             bool all = !inside;
                             for (int t = 0; t < sum.size() && all; ++t) all = side_of_edge(sum.edge(t), x) > 0;
                             inside = inside || all;
                           });
    if (inside || on_any(query.stretch_tree(), boundary.stretches())) continue;
    if (!on_any(query.slot_tree(), boundary.slots())) seats.push_back(near);
  }
  std::sort(seats.begin(), seats.end());
  seats.erase(std::unique(seats.begin(), seats.end()), seats.end());
  return seats;
}

std::vector<std::array<Point2, 2>> whole_slots(const SumBoundary& boundary) {
  std::vector<EdgePart> parts;
  for (const Stretch& s : boundary.slots()) {
    for (int e = SumBoundary::first_edge(s); e <= SumBoundary::last_edge(s); ++e) parts.push_back(boundary.part(s, e));
  }
  std::stable_sort(parts.begin(), parts.end(), line_before);
  std::vector<std::array<Point2, 2>> slots;
  for (std::size_t i = 0; i < parts.size();) {
    std::vector<std::array<Point2, 2>> on_line;
    const std::size_t first = i;
    for (; i < parts.size() && !line_before(parts[first], parts[i]); ++i) {
      const Point2 a = rounded(exact_point(parts[i].span, parts[i].from));
      const Point2 b = rounded(exact_point(parts[i].span, parts[i].to));
      on_line.push_back({std::min(a, b), std::max(a, b)});
    }
    std::sort(on_line.begin(), on_line.end());
    for (std::size_t k = 0; k < on_line.size(); ++k) {
      if (k > 0 && on_line[k][0] <= slots.back()[1]) {
        slots.back()[1] = std::max(slots.back()[1], on_line[k][1]);
      } else {
        slots.push_back(on_line[k]);
      }
    }
  }
  return slots;
}

}  // namespace pd::detail

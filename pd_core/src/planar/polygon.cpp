#include "pd/planar/polygon.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <string>

#include "pd/numeric/predicates.hpp"
#include "planar/ring_links.hpp"

namespace pd {

namespace {

constexpr double kLargest = 1e300;

std::string ring_name(int ring) { return ring < 0 ? "outer" : "holes[" + std::to_string(ring) + "]"; }
std::string edge_name(Polygon::VertexId id) { return ring_name(id.ring) + "[" + std::to_string(id.index) + "]"; }

struct CleanRing {
  std::vector<Point2> points;
  std::vector<std::int32_t> index;
};

/// Is the middle of three collinear points no longer between the others, so that the ring folds back there?
bool folds_back(const Point2& a, const Point2& b, const Point2& c) {
  const std::size_t k = a[0] != b[0] ? 0 : 1;
  return (a[k] < b[k]) == (c[k] < b[k]);
}

std::optional<Error> check_numbers(std::span<const Point2> ring, int id) {
  for (std::size_t i = 0; i < ring.size(); ++i) {
    for (const double x : ring[i]) {
      const std::string where = edge_name({id, static_cast<std::int32_t>(i)});
      if (!std::isfinite(x)) return Error{ErrorCode::non_finite, "coordinates must be finite numbers", where};
      if (std::abs(x) > kLargest) return Error{ErrorCode::out_of_range, "coordinates must be at most 1e300", where};
    }
  }
  return std::nullopt;
}

/// Without duplicates and without vertices in the middle of a straight run.
Expected<CleanRing> clean(std::span<const Point2> ring, int id) {
  CleanRing r;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    if (!r.points.empty() && r.points.back() == ring[i]) continue;
    r.points.push_back(ring[i]);
    r.index.push_back(static_cast<std::int32_t>(i));
  }
  while (r.points.size() > 1 && r.points.front() == r.points.back()) {
    r.points.pop_back();
    r.index.pop_back();
  }
  std::vector<Point2> distinct = r.points;
  std::sort(distinct.begin(), distinct.end());
  distinct.erase(std::unique(distinct.begin(), distinct.end()), distinct.end());
  if (distinct.size() < 3) {
    return Error{ErrorCode::too_few_points,
                 "a ring needs 3 distinct points at least, has " + std::to_string(distinct.size()), ring_name(id)};
  }
  if (std::all_of(distinct.begin(), distinct.end(),
                  [&](const Point2& p) { return orient2d(distinct.front(), distinct.back(), p) == 0; })) {
    return Error{ErrorCode::not_full_dimensional, "all points of the ring lie on one line; it must bound an area",
                 ring_name(id)};
  }
  const std::size_t n = r.points.size();
  CleanRing kept;
  for (std::size_t i = 0; i < n; ++i) {
    const Point2 &a = r.points[(i + n - 1) % n], &b = r.points[i], &c = r.points[(i + 1) % n];
    if (orient2d(a, b, c) != 0) {
      kept.points.push_back(b);
      kept.index.push_back(r.index[i]);
    } else if (folds_back(a, b, c)) {
      return Error{ErrorCode::bad_value,
                   "the ring folds back on itself; its edges may meet at their common vertices only",
                   edge_name({id, r.index[i]})};
    }
  }
  return kept;
}

/// Turns the ring round so that it starts at its least vertex and runs counter-clockwise there (or clockwise).
void orient_ring(CleanRing& ring, bool counter_clockwise) {
  const auto least = std::min_element(ring.points.begin(), ring.points.end()) - ring.points.begin();
  std::rotate(ring.points.begin(), ring.points.begin() + least, ring.points.end());
  std::rotate(ring.index.begin(), ring.index.begin() + least, ring.index.end());
  // The least vertex is a corner of the hull: the turn there is the ring's orientation.
  if ((orient2d(ring.points.back(), ring.points[0], ring.points[1]) > 0) != counter_clockwise) {
    std::reverse(ring.points.begin() + 1, ring.points.end());
    std::reverse(ring.index.begin() + 1, ring.index.end());
  }
}

std::string describe(detail::RingFault::Kind kind, Polygon::VertexId first,
                     const std::optional<Polygon::VertexId>& second) {
  using Kind = detail::RingFault::Kind;
  const std::string edge = edge_name(first), other = second ? edge_name(*second) : "";
  switch (kind) {
    case Kind::crossing:
      return "the edges that start at " + edge + " and " + other + " cross; rings must not cross";
    case Kind::overlapping:
      return "the edges that start at " + edge + " and " + other +
             " overlap along a segment; rings may touch in single points only";
    case Kind::touching:
    case Kind::meeting:
      return "the ring touches itself at " + edge + " and " + other + "; only different rings may share a point";
    case Kind::hole_outside:
      return ring_name(first.ring) + " lies outside the outer ring or reaches out of it";
    case Kind::hole_in_hole:
      return ring_name(first.ring) + " starts inside " + ring_name(second->ring) +
             "; holes must be apart but for single points";
    case Kind::cut_in_two:
      return "the interior is cut in two by rings that touch, of which one is " + ring_name(first.ring) +
             "; give each connected part as a polygon of its own";
  }
  return {};
}

}  // namespace

Expected<Polygon> Polygon::from_rings(std::span<const Point2> outer, std::span<const std::vector<Point2>> holes) {
  std::vector<CleanRing> rings;
  std::vector<std::int32_t> names;
  for (int h = -1; h < static_cast<int>(holes.size()); ++h) {
    const std::span<const Point2> ring = h < 0 ? outer : std::span<const Point2>(holes[static_cast<std::size_t>(h)]);
    if (auto error = check_numbers(ring, h)) return *std::move(error);
    Expected<CleanRing> cleaned = clean(ring, h);
    if (!cleaned) return cleaned.error();
    rings.push_back(std::move(cleaned).value());
    orient_ring(rings.back(), h < 0);
    names.push_back(h);
  }
  std::vector<std::size_t> order(rings.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin() + 1, order.end(), [&](std::size_t a, std::size_t b) {
    return rings[a].points[0] != rings[b].points[0] ? rings[a].points[0] < rings[b].points[0] : a < b;
  });

  Polygon r;
  std::vector<std::int32_t> ring_of;
  r.ring_start_.push_back(0);
  for (std::size_t k = 0; k < order.size(); ++k) {
    const CleanRing& ring = rings[order[k]];
    const auto begin = static_cast<std::int32_t>(r.points_.size());
    const auto size = static_cast<std::int32_t>(ring.points.size());
    for (std::int32_t i = 0; i < size; ++i) {
      r.points_.push_back(ring.points[static_cast<std::size_t>(i)]);
      r.caller_id_.push_back({names[order[k]], ring.index[static_cast<std::size_t>(i)]});
      r.next_.push_back(begin + (i + 1) % size);
      r.previous_.push_back(begin + (i + size - 1) % size);
      ring_of.push_back(static_cast<std::int32_t>(k));
    }
    r.ring_start_.push_back(begin + size);
  }
  // Named while the corners are still those that the caller gave.
  for (int v = 0; v < r.num_vertices(); ++v) {
    const int second = r.next(v), third = r.next(second);
    const std::int32_t x = r.caller_id(v).index, y = r.caller_id(second).index, z = r.caller_id(third).index;
    const bool ascending = (x < y && y < z) || (y < z && z < x) || (z < x && x < y);
    r.caller_edge_.push_back(r.caller_id(ascending ? v : second));
  }
  const detail::Rings flat{r.points_, r.next_, r.previous_, ring_of};
  detail::RingCheck check = detail::check_rings(flat);
  detail::RingLinks links;
  if (!check.fault && check.shared_points) {
    links = detail::link_touching_rings(flat, check.touches);
    check.fault = links.fault;
  }
  if (check.fault) {
    using Kind = detail::RingFault::Kind;
    const detail::RingFault& fault = *check.fault;
    const bool edges = fault.kind == Kind::crossing || fault.kind == Kind::overlapping || fault.kind == Kind::touching;
    const auto named = [&](int v) { return edges ? r.caller_edge(v) : r.caller_id(v); };
    const VertexId first = named(fault.edge);
    const auto second = fault.other_edge < 0 ? std::nullopt : std::optional(named(fault.other_edge));
    return Error{ErrorCode::bad_value, describe(fault.kind, first, second), edge_name(first)};
  }
  if (check.shared_points) r.take(std::move(links));
  r.convex_ = r.num_rings() == 1;
  for (int v = 0; v < r.num_vertices(); ++v) {
    r.turn_.push_back(static_cast<std::int8_t>(orient2d(r.point(r.previous(v)), r.point(v), r.point(r.next(v)))));
    if (r.turn_.back() < 0) r.convex_ = false;
  }
  return r;
}

Expected<Polygon> Polygon::at_point(const Point2& point) {
  if (auto error = check_numbers({&point, 1}, -1)) return *std::move(error);
  Polygon r;
  r.points_ = {point};
  r.ring_start_ = {0, 1};
  r.next_ = r.previous_ = {0};
  r.turn_ = {1};
  r.caller_id_ = r.caller_edge_ = {{-1, 0}};
  r.convex_ = true;
  return r;
}

void Polygon::take(detail::RingLinks links) {
  std::vector<VertexId> ids, edges;
  for (const std::int32_t v : links.vertex) ids.push_back(caller_id(v));
  for (const std::int32_t v : links.edge) edges.push_back(caller_edge(v));
  points_ = std::move(links.points);
  ring_start_ = std::move(links.ring_start);
  next_ = std::move(links.next);
  previous_ = std::move(links.previous);
  next_here_ = std::move(links.next_here);
  caller_id_ = std::move(ids);
  caller_edge_ = std::move(edges);
}

}  // namespace pd

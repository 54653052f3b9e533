#include "planar/ring_links.hpp"

#include <algorithm>
#include <numeric>

#include "numeric/at.hpp"
#include "pd/numeric/predicates.hpp"

namespace pd::detail {

namespace {

/// The rings' corners with one more wherever an edge is touched; `next` and `previous` along the rings.
RingLinks split_edges(const Rings& rings, std::vector<RingTouch> touches) {
  const auto n = static_cast<std::int32_t>(rings.points.size());
  const auto along = [&](const RingTouch& a, const RingTouch& b) {  // both inside the same edge
    const Point2 &x = rings.points[at(a.vertex)], &y = rings.points[at(b.vertex)];
    return before(rings.points[at(a.edge)], rings.points[at(rings.next[at(a.edge)])]) ? before(x, y) : before(y, x);
  };
  std::sort(touches.begin(), touches.end(),
            [&](const RingTouch& a, const RingTouch& b) { return a.edge != b.edge ? a.edge < b.edge : along(a, b); });
  RingLinks r;
  std::size_t touch = 0;
  for (std::int32_t v = 0; v < n; ++v) {
    if (v == 0 || rings.ring[at(v)] != rings.ring[at(v - 1)]) {
      r.ring_start.push_back(static_cast<std::int32_t>(r.points.size()));
    }
    const auto add = [&](std::int32_t vertex) {
      r.points.push_back(rings.points[at(vertex)]);
      r.vertex.push_back(vertex);
      r.edge.push_back(v);
    };
    add(v);
    for (; touch < touches.size() && touches[touch].edge == v; ++touch) add(touches[touch].vertex);
  }
  r.ring_start.push_back(static_cast<std::int32_t>(r.points.size()));
  r.next.resize(r.points.size());
  r.previous.resize(r.points.size());
  for (std::size_t ring = 0; ring + 1 < r.ring_start.size(); ++ring) {
    const std::int32_t begin = r.ring_start[ring], end = r.ring_start[ring + 1];
    for (std::int32_t v = begin; v < end; ++v) {
      r.next[at(v)] = v + 1 == end ? begin : v + 1;
      r.previous[at(r.next[at(v)])] = v;
    }
  }
  return r;
}

/// The check has seen that, counter-clockwise, each ring's way back is followed by its own way out: the part of the
/// interior behind that way out ends at the next ring's way back.
void link_corners(RingLinks& r, std::span<const std::int32_t> here) {
  std::vector<RingDirection> around;
  for (const std::int32_t v : here) {
    around.push_back({v, r.points[at(r.previous[at(v)])], false});
    around.push_back({v, r.points[at(r.next[at(v)])], true});
  }
  sort_around(r.points[at(here.front())], around);
  std::vector<std::int32_t> before_here;
  for (const RingDirection& d : around) before_here.push_back(r.previous[at(d.vertex)]);
  for (std::size_t i = 0; i < around.size(); ++i) {
    if (!around[i].out) continue;
    const std::int32_t v = around[i].vertex, arriving = before_here[(i + 1) % around.size()];
    r.next[at(arriving)] = v;
    r.previous[at(v)] = arriving;
  }
  for (std::size_t i = 0; i < here.size(); ++i) r.next_here[at(here[i])] = here[(i + 1) % here.size()];
}

/// A walk that runs counter-clockwise surrounds a part of the interior. At its least point a walk turns
/// to the left, unless it runs clockwise: then one of its corners there turns to the right.
std::optional<RingFault> find_second_part(const RingLinks& r, const Rings& rings) {
  std::vector<bool> walked(r.points.size(), false);
  int parts = 0;
  for (std::int32_t first = 0; first < static_cast<std::int32_t>(r.points.size()); ++first) {
    if (walked[at(first)]) continue;
    Point2 least = r.points[at(first)];
    bool clockwise = false;
    std::int32_t of_hole = -1;
    for (std::int32_t v = first; !walked[at(v)]; v = r.next[at(v)]) {
      walked[at(v)] = true;
      const Point2& x = r.points[at(v)];
      if (rings.ring[at(r.edge[at(v)])] != 0) of_hole = r.edge[at(v)];
      if (before(least, x)) continue;
      const bool right = orient2d(r.points[at(r.previous[at(v)])], x, r.points[at(r.next[at(v)])]) < 0;
      clockwise = right || (x == least && clockwise);
      least = x;
    }
    if (!clockwise && ++parts > 1) return RingFault{RingFault::Kind::cut_in_two, of_hole, -1};
  }
  return std::nullopt;
}

}  // namespace

RingLinks link_touching_rings(const Rings& rings, const std::vector<RingTouch>& touches) {
  RingLinks r = split_edges(rings, touches);
  r.next_here.resize(r.points.size());
  std::iota(r.next_here.begin(), r.next_here.end(), 0);
  std::vector<std::int32_t> order = r.next_here;
  std::sort(order.begin(), order.end(), [&](std::int32_t a, std::int32_t b) {
    return r.points[at(a)] != r.points[at(b)] ? before(r.points[at(a)], r.points[at(b)]) : a < b;
  });
  // The corners of one point are linked while all others still follow their rings: their neighbours' points, which are
  // all that is looked at, stay what they are.
  for (std::size_t i = 0; i < order.size();) {
    std::size_t end = i + 1;
    while (end < order.size() && r.points[at(order[end])] == r.points[at(order[i])]) ++end;
    if (end - i > 1) link_corners(r, std::span<const std::int32_t>(order).subspan(i, end - i));
    i = end;
  }
  r.fault = find_second_part(r, rings);
  return r;
}

}  // namespace pd::detail

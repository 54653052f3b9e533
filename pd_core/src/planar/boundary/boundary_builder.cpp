#include "planar/boundary/boundary_builder.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <unordered_set>
#include <utility>

#include "numeric/at.hpp"
#include "planar/boundary/convex_parts.hpp"
#include "planar/boundary/seats.hpp"

namespace pd::detail {

namespace {

double along(const Point2& direction, const Point2& p) { return direction[0] * p[0] + direction[1] * p[1]; }

/// True if no neighbour of a polygon's vertex lies to the right of the line through the vertex along d, the polygon's
/// inside being on the left.
bool is_farthest(const Polygon& polygon, int vertex, const PlaneDirection& d) {
  if (polygon.turn(vertex) < 0) return false;
  const Point2& at_vertex = polygon.point(vertex);
  return cross_sign({polygon.point(polygon.previous(vertex)), at_vertex}, d) >= 0 &&
         cross_sign(d, {at_vertex, polygon.point(polygon.next(vertex))}) >= 0;
}

/// The vertex of P at the end of the edge from a corner of a sum's part.
std::int32_t next_corner(const ConvexSum& sum, int a) {
  return sum.corners()[a + 1 == sum.num_corners() ? 0 : at(a + 1)];
}

/// Intersecting a candidate with a sum exactly takes some 16 times as long as in doubles.
constexpr std::int64_t kExactComparison = 16;

/// Sums that are tried first.
constexpr std::size_t kMostRecent = 16;

void move_to_front(std::vector<std::int32_t>& recent, std::int32_t sum) {
  std::erase(recent, sum);
  if (recent.size() == kMostRecent) recent.pop_back();
  recent.insert(recent.begin(), sum);
}

}  // namespace

void BoundaryBuilder::build_implicit() {
  triangulation_ = triangulate(p_);
  r_.p_points_ = triangulation_.points;
  r_.chains_.push_back(std::make_unique<NegatedChain>(std::vector<Point2>(q_.points().begin(), q_.points().end())));
  const NegatedChain& chain = *r_.chains_.front();
  auto& vertices = r_.chain_vertices_.emplace_back();
  for (int k = 0; k <= chain.size(); ++k) vertices.push_back(chain.index(k));
  r_.parts_ = triangles_inside(triangulation_, r_.p_points_);
  for (const ConvexPart& part : r_.parts_) r_.sums_.emplace_back(part, chain);
  for (const Point2& p : q_.points()) q_box_.add(p);
  seen_.assign(triangulation_.triangles.size(), -1);
  for (int v = 0; v < p_.num_vertices(); ++v) add_arc_candidates(v);
  // Sum after sum, so that the crossings of every two of them are counted together.
  crossings_.assign(r_.sums_.size(), 0);
  std::vector<std::int32_t> order(r_.candidates_.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](std::int32_t a, std::int32_t b) {
    return r_.candidates_[at(a)].sum < r_.candidates_[at(b)].sum;
  });
  int last = -1;
  for (const std::int32_t i : order) {
    const Candidate& candidate = r_.candidates_[at(i)];
    if (candidate.sum != std::exchange(last, candidate.sum)) next_sum();
    ArcCover cutter(
        r_, candidate,
        [&](int sum, int edge) {
          const int id = candidate_at(sum, edge);
          return id >= 0 && id < candidate.id;
        },
        r_.counts_);
    CandidateCover cover{{r_, candidate}, {}, with_seats_, {}};
    reach_of(candidate);
    flood(candidate, candidate.sum, cutter, cover);
    keep(candidate, cover);
  }
  next_sum();
  for (auto* list : {&r_.stretches_, &r_.slots_}) {
    std::stable_sort(list->begin(), list->end(),
                     [](const Stretch& a, const Stretch& b) { return a.candidate < b.candidate; });
  }
  compact();
}

/// [D] Fact 4.1, checked while the boundary is made: what one sum's displaced edges and arcs have in common with the
/// boundary of another one, counted.
void BoundaryBuilder::count_crossings(int sum, std::int64_t crossings) {
  if (crossings == 0) return;
  if (crossings_[at(sum)] == 0) crossed_.push_back(sum);
  crossings_[at(sum)] += static_cast<std::int32_t>(crossings);
  r_.counts_.crossings += crossings;
  r_.counts_.most_crossings = std::max<std::int64_t>(r_.counts_.most_crossings, crossings_[at(sum)]);
}

/// The sum at hand is done.
void BoundaryBuilder::next_sum() {
  for (const std::int32_t sum : crossed_) crossings_[at(sum)] = 0;
  crossed_.clear();
}

/// The displaced edge that starts at vertex v, and the arc at v where P is convex there. If rings touch there, the arc
/// is the first vertex's: it holds the directions in which no part of P at the point lies farther.
void BoundaryBuilder::add_arc_candidates(int v) {
  const std::int32_t owner = triangulation_.owner[at(v)];
  const ConvexSum& sum = r_.sums_[at(owner)];
  int a = 0;
  while (sum.corners()[at(a)] != v) ++a;
  const int edge = sum.edge_of_corner(a);
  r_.candidates_.push_back({owner, edge, 1, 2 * v});
  if (p_.first_here(v) != v || sum.chain().size() == 0) return;
  const ChainRange own = arc_at(sum.chain(), v);
  ChainRange common = own;
  for (int w = p_.next_here(v); w != v; w = p_.next_here(w)) {
    common = common.in_common(arc_at(sum.chain(), w), sum.chain().size());
  }
  if (common.count <= 0) return;
  // The arc's edges come just before the edge out of v.
  const int skipped = (common.first - own.first + sum.chain().size()) % sum.chain().size();
  r_.candidates_.push_back({owner, (edge - own.count + skipped + sum.size()) % sum.size(), common.count, 2 * v + 1});
}

/// -B's edges strictly between the directions of P's edges into v and out of it; none where P is not convex there.
BoundaryBuilder::ChainRange BoundaryBuilder::arc_at(const NegatedChain& chain, int v) const {
  if (p_.turn(v) <= 0) return {0, 0};
  const PlaneDirection in{p_.point(p_.previous(v)), p_.point(v)}, out{p_.point(v), p_.point(p_.next(v))};
  int after_in = chain.edges_before(in);
  if (after_in < chain.size() && compare_angles(chain.edge(after_in), in) == 0) ++after_in;
  int count = chain.edges_before(out) - after_in;
  if (compare_angles(in, out) > 0) count += chain.size();
  return {after_in % chain.size(), std::max(0, count)};
}

/// Both turn by less than 180 degrees, so that what they have in common is one range.
BoundaryBuilder::ChainRange BoundaryBuilder::ChainRange::in_common(const ChainRange& other, int size) const {
  const int ahead = (other.first - first + size) % size;
  const int from_other = std::min(count, ahead + other.count) - ahead;
  if (from_other > 0) return {other.first, from_other};
  return {first, std::min(count, ahead + other.count - size)};
}

/// The id of the candidate that an edge of a sum is a part of, or -1: it then lies inside some other sum.
int BoundaryBuilder::candidate_at(int sum_index, int edge) const {
  const ConvexSum& sum = r_.sums_[at(sum_index)];
  const ConvexSum::Parts parts = sum.parts(edge);
  const std::int32_t v = sum.corners()[at(parts.a)];
  if (parts.of_triangle) return p_.next(v) == next_corner(sum, parts.a) ? 2 * v : -1;
  const PlaneDirection d = sum.chain().edge(parts.b);
  int first = v;
  for (int w = v;;) {
    const bool between = p_.turn(w) > 0 && cross_sign({p_.point(p_.previous(w)), p_.point(w)}, d) > 0 &&
                         cross_sign(d, {p_.point(w), p_.point(p_.next(w))}) > 0;
    if (!between) return -1;
    first = std::min(first, w);
    w = p_.next_here(w);
    if (w == v) return 2 * first + 1;
  }
}

// While Q slides along the candidate, a point x of it, x + Q covers the candidate's points + Q. Measured along x, y and
// the candidate's own normal, with air for rounding: only triangles that meet this region can cut the candidate.
void BoundaryBuilder::reach_of(const Candidate& candidate) {
  const ConvexSum& sum = r_.sum(candidate);
  reach_.direction = {Point2{1, 0}, Point2{0, 1}, Point2{0, 0}};
  if (candidate.count == 1) {
    const Span e = r_.edge(candidate, 0);
    const Point2 normal = {e.d.to[1] - e.d.from[1], e.d.from[0] - e.d.to[0]};
    reach_.direction[2] = normal;
    const NegatedChain& chain = sum.chain();
    // Along the outer normal of e, -B's farthest vertex is that of the edge's own place.
    const int size = std::max(1, chain.size());
    const double one = along(normal, chain.point(chain.edges_before(e.d) % size));
    const double two = along(normal, chain.point(chain.edges_before(e.d.reversed()) % size));
    reach_.low[2] = std::min(one, two);
    reach_.high[2] = std::max(one, two);
  } else {
    reach_.low[2] = reach_.high[2] = 0;
  }
  for (std::size_t k = 0; k < 2; ++k) {
    reach_.low[k] = q_box_.low[k];
    reach_.high[k] = q_box_.high[k];
  }
  std::array<double, 3> low, high;
  low.fill(std::numeric_limits<double>::infinity());
  high.fill(-std::numeric_limits<double>::infinity());
  const auto add = [&](const SumPoint& x) {
    for (std::size_t k = 0; k < 3; ++k) {
      const double value = along(reach_.direction[k], x.p) - along(reach_.direction[k], x.q);
      low[k] = std::min(low[k], value);
      high[k] = std::max(high[k], value);
    }
  };
  if (candidate.count == 1) {
    const Span e = r_.edge(candidate, 0);
    add(e.s);
    add(e.z);
  } else {
    const Box2 box = r_.box(candidate, 0, candidate.count);
    for (std::size_t k = 0; k < 2; ++k) {
      low[k] = box.low[k];
      high[k] = box.high[k];
    }
    low[2] = high[2] = 0;
  }
  for (std::size_t k = 0; k < 3; ++k) {
    reach_.low[k] += low[k];
    reach_.high[k] += high[k];
    const Point2& d = reach_.direction[k];
    double size = 0;
    for (std::size_t c = 0; c < 2; ++c) {
      size += std::abs(d[c]) * (std::max(std::abs(q_box_.low[c]), std::abs(q_box_.high[c])) * 2 +
                                std::max(std::abs(low[k]), std::abs(high[k])) * (k < 2 ? 1 : 0));
      for (int a = 0; a < sum.num_corners(); ++a) size += std::abs(d[c]) * std::abs(sum.corner(a)[c]);
    }
    reach_.low[k] -= 0x1p-44 * size;
    reach_.high[k] += 0x1p-44 * size;
  }
}

bool BoundaryBuilder::may_meet(const Triangle& triangle) const {
  for (std::size_t k = 0; k < 3; ++k) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const std::int32_t v : triangle.vertex) {
      const double value = along(reach_.direction[k], r_.p_points_[at(v)]);
      low = std::min(low, value);
      high = std::max(high, value);
    }
    const double air = 0x1p-44 * std::max(std::abs(low), std::abs(high));
    if (low - air > reach_.high[k] || high + air < reach_.low[k]) return false;
  }
  // The triangle's own edges against the region's box.
  for (std::size_t k = 0; k < 3; ++k) {
    const Point2 &a = r_.p_points_[at(triangle.vertex[k])], &b = r_.p_points_[at(triangle.vertex[(k + 1) % 3])];
    const Point2 inner = {a[1] - b[1], b[0] - a[0]};
    double farthest = 0, size = 0;
    for (std::size_t c = 0; c < 2; ++c) {
      const double reach = inner[c] > 0 ? reach_.high[c] : reach_.low[c];
      farthest += inner[c] * (reach - a[c]);
      size += std::abs(inner[c]) * (std::abs(reach) + std::abs(a[c]));
    }
    if (farthest < -0x1p-44 * size) return false;
  }
  return true;
}

void BoundaryBuilder::flood(const Candidate& candidate, int triangle, ArcCover& cutter, CandidateCover& cover) {
  queue_.assign(1, triangle);
  seen_[at(triangle)] = candidate.id;
  for (std::size_t i = 0; i < queue_.size(); ++i) {
    const Triangle& t = triangulation_.triangles[at(queue_[i])];
    if (t.inside && queue_[i] != candidate.sum) {
      near_.push_back({index_of(candidate), queue_[i]});
      count_crossings(queue_[i], cutter.cut(queue_[i], cover));
      if (cover.covered.whole()) return;
    }
    for (const std::int32_t n : t.neighbour) {
      if (n < 0 || seen_[at(n)] == candidate.id) continue;
      seen_[at(n)] = candidate.id;
      if (may_meet(triangulation_.triangles[at(n)])) queue_.push_back(n);
    }
  }
}

std::int32_t BoundaryBuilder::index_of(const Candidate& candidate) const {
  return static_cast<std::int32_t>(&candidate - r_.candidates_.data());
}

void BoundaryBuilder::keep(const Candidate& candidate, const CandidateCover& cover) {
  const std::int32_t index = index_of(candidate);
  CoveredIntervals all = cover.covered;
  CoveredIntervals slots = cover.covered;
  for (const auto& interval : cover.abutting) {
    for (const auto& part : slots.rest_of(interval)) r_.slots_.push_back({index, part.from, part.to});
    slots.add(interval);
    all.add(interval);
  }
  const auto rest = all.rest();
  for (const auto& part : rest) r_.stretches_.push_back({index, part.from, part.to});
  if (with_seats_) {
    for (const Position& x : seat_places_of(r_, candidate, cover)) r_.seat_places_.push_back({index, x});
  }
  if (!rest.empty()) return;
  while (!near_.empty() && near_.back().candidate == index) near_.pop_back();
}

/// Drops the candidates of which nothing is left.
void BoundaryBuilder::compact() {
  std::vector<std::int32_t> number(r_.candidates_.size(), -1);
  std::vector<Candidate> kept;
  const auto keep_candidate = [&](std::int32_t& candidate) {
    std::int32_t& n = number[at(candidate)];
    if (n < 0) {
      n = static_cast<std::int32_t>(kept.size());
      kept.push_back(r_.candidates_[at(candidate)]);
    }
    candidate = n;
  };
  for (auto* list : {&r_.stretches_, &r_.slots_}) {
    for (Stretch& s : *list) keep_candidate(s.candidate);
  }
  for (SeatPlace& m : r_.seat_places_) keep_candidate(m.candidate);
  r_.candidates_ = std::move(kept);
  for (NearSum& near : near_) near.candidate = number[at(near.candidate)];
  std::sort(near_.begin(), near_.end(), [](const NearSum& a, const NearSum& b) {
    return a.candidate != b.candidate ? a.candidate < b.candidate : a.sum < b.sum;
  });
  r_.stretches_ = split_where_touched(r_, r_.stretches_, near_);
  r_.stretches_.shrink_to_fit();
  r_.counts_.sums = static_cast<std::int64_t>(r_.sums_.size());
  r_.num_loops_ = link_loops(r_, r_.stretches_, r_.counts_.reflex_points);
}

void BoundaryBuilder::build_explicit(std::int64_t max_comparisons) {
  triangulation_ = triangulate(p_, false);
  const Triangulation other = triangulate(q_, false);
  r_.p_points_ = triangulation_.points;
  r_.q_points_ = other.points;
  for (const ConvexPart& part : convex_parts(other, r_.q_points_)) {
    std::vector<Point2> points;
    for (const std::int32_t v : part.corners()) points.push_back(other.points[at(v)]);
    r_.chains_.push_back(std::make_unique<NegatedChain>(points));
    const NegatedChain& chain = *r_.chains_.back();
    auto& vertices = r_.chain_vertices_.emplace_back();
    for (int k = 0; k <= chain.size(); ++k) vertices.push_back(part.corners()[at(chain.index(k))]);
  }
  r_.parts_ = convex_parts(triangulation_, r_.p_points_);
  r_.sums_.reserve(r_.parts_.size() * r_.chains_.size());
  for (const ConvexPart& part : r_.parts_) {
    for (const auto& chain : r_.chains_) r_.sums_.emplace_back(part, *chain);
  }
  find_different_sums();
  add_edge_candidates();
  std::vector<Box2> boxes;
  for (const std::int32_t i : different_) {
    const ConvexSum& sum = r_.sums_[at(i)];
    Box2 box;
    for (int t = 0; t < sum.size(); ++t) box.add(RoughSums::rounded(sum.vertex(t)));
    boxes.push_back(box.widened());
  }
  const BoxTree tree(boxes);
  const RoughSums rough(r_.sums_);
  std::vector<std::int32_t> recent;  // sums that covered candidates just before this one: neighbours lie in the same
  for (const Candidate& candidate : r_.candidates_) {
    cut_edge_candidate(candidate, {boxes, tree, rough}, recent);
    if (comparisons_ <= max_comparisons) continue;
    r_.complete_ = false;
    r_.stretches_.clear();
    r_.slots_.clear();
    r_.candidates_.clear();
    return;
  }
  compact();
}

void BoundaryBuilder::cut_edge_candidate(const Candidate& candidate, const SumSearch& search,
                                         std::vector<std::int32_t>& recent) {
  const Span e = r_.edge(candidate, 0);
  const Point2 start = RoughSums::rounded(e.s), end = RoughSums::rounded(e.z);
  Box2 box;
  box.add(start);
  box.add(end);
  box = box.widened();
  bool whole = false;
  rough_union_.clear();
  const auto look_at = [&](std::int32_t sum) {
    RoughCover share;
    if (whole || sum == candidate.sum) return;
    ++comparisons_;
    if (!search.rough.cover(sum, start, end, share)) return;
    if (share.whole()) {
      whole = true;
      needed_.assign(1, sum);
      return;
    }
    rough_union_.add(share);
    // Looked at whenever the number of shares has doubled, so that it costs little.
    const std::size_t count = rough_union_.size();
    if (count >= 8 && (count & (count - 1)) == 0) whole = rough_union_.whole(needed_);
  };
  for (std::size_t i = 0; i < recent.size() && !whole; ++i) look_at(recent[i]);
  if (!whole && rough_union_.size() > 1) whole = rough_union_.whole(needed_);
  const std::vector<std::int32_t> tried = recent;
  // Sums with their middle near the candidate's are most likely to cover it.
  const Point2 middle = {0.5 * (start[0] + end[0]), 0.5 * (start[1] + end[1])};
  search.tree.visit([&](const Box2& b) { return !whole && b.meets(box); },
                    [&](const Box2& b) { return b.middle_distance_squared(middle); },
                    [&](std::int32_t place) {
                      if (!search.boxes[at(place)].meets(box)) return;
                      const std::int32_t sum = different_[at(place)];
                      if (std::find(tried.begin(), tried.end(), sum) == tried.end()) look_at(sum);
                    });
  if (whole || rough_union_.whole(needed_)) {
    for (const std::int32_t sum : needed_) move_to_front(recent, sum);
    return;
  }

  ArcCover cutter(
      r_, candidate, [&](int sum, int) { return sum < candidate.sum; }, r_.counts_);
  CandidateCover cover{{r_, candidate}, {}, with_seats_, {}};
  for (const std::int32_t sum : needed_) {
    if (cover.covered.whole()) break;
    near_.push_back({index_of(candidate), sum});
    cutter.cut(sum, cover);
    comparisons_ += kExactComparison;
  }
  keep(candidate, cover);
}

/// Lists the sums without those that equal an earlier sum. On a lattice most do: the teeth of two combs that are k
/// teeth apart all make one sum. The edges of a sum that is left out coincide with those of the earlier sum, which
/// would cover them.
void BoundaryBuilder::find_different_sums() {
  std::map<std::array<double, 7>, std::int32_t> first;  // by the number of edges and three rounded corners
  for (std::int32_t i = 0; i < static_cast<std::int32_t>(r_.sums_.size()); ++i) {
    const ConvexSum& sum = r_.sums_[at(i)];
    std::array<double, 7> key{static_cast<double>(sum.size())};
    for (int k = 0; k < 3; ++k) {
      const Point2 corner = RoughSums::rounded(sum.vertex(k * sum.size() / 3));
      key[at(2 * k + 1)] = corner[0];
      key[at(2 * k + 2)] = corner[1];
    }
    const auto [found, inserted] = first.try_emplace(key, i);
    const auto equals = [&](const ConvexSum& other) {
      for (int t = 0; t < sum.size(); ++t) {
        if (!same(sum.vertex(t), other.vertex(t))) return false;
      }
      return true;
    };
    if (inserted || !equals(r_.sums_[at(found->second)])) different_.push_back(i);
  }
}

/// What may lie on the boundary: an edge of one polygon displaced by a convex vertex of the other one, if no edge at
/// that vertex reaches farther across the edge, or two parallel edges. Next to any other point of a sum's edge lies
/// more of the other polygon, beyond the edge: the point is inside.
///
/// An edge that several sums share is a candidate once, as the first sum's. On a lattice most edges coincide with an
/// edge of other vertices: those are compared exactly.
void BoundaryBuilder::add_edge_candidates() {
  std::unordered_set<std::uint64_t> known;
  std::map<std::array<double, 4>, Span> first_at;  // by the rounded ends
  const auto is_elsewhere = [&](const Span& e) {
    const Point2 start = RoughSums::rounded(e.s), end = RoughSums::rounded(e.z);
    const auto [found, inserted] = first_at.try_emplace({start[0], start[1], end[0], end[1]}, e);
    return inserted || !same(found->second.s, e.s) || !same(found->second.z, e.z);
  };
  const auto is_new = [&](int moving, int fixed, bool edge_of_p) {
    return known
        .insert(static_cast<std::uint64_t>(moving) << 32 | static_cast<std::uint64_t>(fixed) << 1 |
                static_cast<std::uint64_t>(edge_of_p))
        .second;
  };
  for (const std::int32_t i : different_) {
    const ConvexSum& sum = r_.sums_[at(i)];
    const auto& q_vertex = r_.chain_vertices_[at(i) % r_.chains_.size()];
    for (int t = 0; t < sum.size(); ++t) {
      const ConvexSum::Parts parts = sum.parts(t);
      const std::int32_t p_from = sum.corners()[at(parts.a)], q_from = q_vertex[at(parts.b)];
      const bool p_edge = parts.of_triangle && p_.next(p_from) == next_corner(sum, parts.a);
      const bool q_edge = parts.of_chain && q_.next(q_from) == q_vertex[at(parts.b + 1)];
      bool kept = false;
      if (parts.of_triangle && parts.of_chain) {
        kept = p_edge && q_edge;
      } else if (parts.of_triangle) {
        kept = p_edge && is_farthest(q_, q_from, sum.direction(t).reversed()) && is_new(p_from, q_from, true);
      } else {
        kept = q_edge && is_farthest(p_, p_from, sum.direction(t)) && is_new(q_from, p_from, false);
      }
      if (kept && is_elsewhere(sum.edge(t)))
        r_.candidates_.push_back({i, t, 1, static_cast<std::int32_t>(r_.candidates_.size())});
    }
  }
}

}  // namespace pd::detail

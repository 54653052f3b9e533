#include "planar/chain_search.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <utility>

#include "planar/angle_grid.hpp"

namespace pd::detail {

namespace {

/// The edges of P, or of -Q, that face along d: counter-clockwise from the vertex least along d's left normal to the
/// greatest. Their steps along that normal are positive, so that their order by angle is the order of turns.
struct Chain {
  const ConvexPolygon* polygon;
  double sign;
  int first;  ///< vertex
  int size;   ///< edges

  [[nodiscard]] int vertex(int k) const { return (first + k) % polygon->num_vertices(); }
  [[nodiscard]] PolygonEdge edge(int k) const { return edge_of(*polygon, vertex(k), sign); }
  /// How many of the chain's edges come before direction k of a grid, which is one of those between its ends.
  [[nodiscard]] int edges_before(int k, int count) const {
    const auto table = polygon->first_edges();
    const int cells = static_cast<int>(table.size()) - 1;
    const int turned = sign > 0 ? k : (k + count / 2) % count;  // -Q's edges are Q's, turned round
    const int n = polygon->num_vertices();
    const int place = table[static_cast<std::size_t>(turned) * static_cast<std::size_t>(cells / count)] - first;
    return place < 0 ? place + n : (place < n ? place : place - n);
  }
};

/// From the vertex farthest on the right of d to the one farthest on its left.
Chain facing(const ConvexPolygon& polygon, double sign, const Point2& left, int right_vertex, int left_vertex) {
  const Point2 up{sign * left[0], sign * left[1]};
  Chain chain{&polygon, sign, right_vertex, 0};
  // An edge across: its far end leads on to d's side.
  if (along(edge_of(polygon, chain.first, 1), up) == 0) chain.first = next_vertex(polygon, chain.first);
  chain.size = (left_vertex - chain.first + polygon.num_vertices()) % polygon.num_vertices();
  return chain;
}

/// What is left of a search: the wanted edge leads from R's vertex (p_low, q_low), not above the line, to (p_high,
/// q_high) above it.
struct ChainRange {
  int p_low, p_high, q_low, q_high;
};

/// Narrows a range by the directions of the two polygons' common grid, whose vertices of R their tables know. First by
/// halves, always at the same few places; then, where the boundary is nearly straight, between the heights of the two
/// ends, and by halves again where that gained little: O(log of the grid) heights.
class GridSearch {
 public:
  GridSearch(const Chain& p, const Chain& q, const Point2& y, const Point2& left, const Point2& d, std::int64_t& probes)
      : p_(p), q_(q), y_(y), left_(left), d_(d), probes_(probes) {}

  void run(ChainRange& range) {
    const std::size_t entries = std::min(p_.polygon->first_edges().size(), q_.polygon->first_edges().size());
    if (entries == 0) return;
    count_ = static_cast<int>(entries) - 1;
    // Directions that are certainly between d and -d: two cells' air for the rounding of the place of d.
    const int from = static_cast<int>(grid_place(d_, count_));
    low_ = {from + 1, range.p_low, range.q_low, height(range.p_low, range.q_low)};
    high_ = {from + count_ / 2, range.p_high, range.q_high, height(range.p_high, range.q_high)};
    bool halve = true;
    while (high_.k - low_.k > 1 && (high_.p - low_.p) + (high_.q - low_.q) > kFew) {
      const int width = high_.k - low_.k;
      if (halve || width > count_ / kHalvedCells) {
        // A multiple of a power of two: many searches look at the same entries.
        const int step = static_cast<int>(std::bit_floor(static_cast<unsigned>(std::max(1, width / 4))));
        look((low_.k + width / 2) / step * step);
        halve = false;
      } else {
        interpolate(width);
        halve = high_.k - low_.k > width / 2;
      }
    }
    range = {low_.p, high_.p, low_.q, high_.q};
  }

 private:
  static constexpr int kFew = 8;            ///< edges left to the search by slopes
  static constexpr int kHalvedCells = 256;  ///< above this part of the grid the boundary is no straight line

  struct End {
    int k;  ///< direction of the grid, counted on past its end
    int p, q;
    double height;
  };

  [[nodiscard]] double height(int i, int j) const {
    const Point2 &p = p_.polygon->vertex(p_.vertex(i)), &q = q_.polygon->vertex(q_.vertex(j));
    return (p[0] - q[0] - y_[0]) * left_[0] + (p[1] - q[1] - y_[1]) * left_[1];
  }
  void look(int k) {
    const int wrapped = k % count_;
    const int i = p_.edges_before(wrapped, count_), j = q_.edges_before(wrapped, count_);
    ++probes_;
    const int sign = offset_along(p_.polygon->vertex(p_.vertex(i)), q_.polygon->vertex(q_.vertex(j)), y_, left_);
    (sign > 0 ? high_ : low_) = {k, i, j, height(i, j)};
  }
  /// Where a straight boundary would cross the line, and there beside it by more than it is bent.
  void interpolate(int width) {
    const double part = low_.height / (low_.height - high_.height);
    const int guess = low_.k + (part > 0 ? static_cast<int>(std::min(part, 1.0) * width) : 0);
    const int k = std::clamp(guess, low_.k + 1, high_.k - 1);
    look(k);
    const int air = 2 + static_cast<int>(static_cast<double>(width) * width / count_);
    const int beside = high_.k == k ? k - air : k + air;
    if (beside > low_.k && beside < high_.k) look(beside);
  }

  const Chain& p_;
  const Chain& q_;
  const Point2 &y_, &left_, &d_;
  std::int64_t& probes_;
  int count_ = 0;
  End low_{}, high_{};
};

/// The vertices extreme in the four directions lie far apart in memory, and so do the entries of the tables that lead
/// to them. Asked for together, they arrive in the time of one.
class FetchAhead {
 public:
  void entry(const ConvexPolygon& polygon, const Point2& direction) {
    const auto table = polygon.first_edges();
    if (table.empty()) return;
    const auto cells = static_cast<std::int64_t>(table.size()) - 1;
    const std::int32_t* at = &table[static_cast<std::size_t>(grid_place({-direction[1], direction[0]}, cells))];
    __builtin_prefetch(at);
    wanted_[count_++] = {&polygon, at};
  }
  void vertices() const {
    for (std::size_t i = 0; i < count_; ++i) {
      const ConvexPolygon& polygon = *wanted_[i].polygon;
      const Point2* vertex = &polygon.points()[static_cast<std::size_t>(*wanted_[i].entry % polygon.num_vertices())];
      __builtin_prefetch(vertex);
      __builtin_prefetch(vertex + 3);  // a cell has two vertices; those beside it may be looked at
    }
  }

 private:
  struct Wanted {
    const ConvexPolygon* polygon;
    const std::int32_t* entry;
  };
  std::array<Wanted, 4> wanted_{};
  std::size_t count_ = 0;
};

}  // namespace

// -Q is least where Q is greatest.
SideVertices::SideVertices(const ConvexPolygon& p, const ConvexPolygon& q, const Point2& d, std::int64_t& probes) {
  const Point2 right{d[1], -d[0]}, left{-d[1], d[0]};
  FetchAhead fetch;
  for (const ConvexPolygon* polygon : {&p, &q}) {
    fetch.entry(*polygon, right);
    fetch.entry(*polygon, left);
  }
  fetch.vertices();
  p_right = p.extreme(right, &probes);
  p_left = p.extreme(left, &probes);
  q_right = q.extreme(right, &probes);
  q_left = q.extreme(left, &probes);
}

SideVertices SideVertices::turned() const {
  SideVertices r = *this;
  std::swap(r.p_right, r.p_left);
  std::swap(r.q_right, r.q_left);
  return r;
}

std::optional<ExitEdge> find_exit(const ConvexPolygon& p, const ConvexPolygon& q, const Point2& y, const Point2& d,
                                  const SideVertices& sides, std::int64_t& probes) {
  const Point2 left{-d[1], d[0]};
  const Chain cp = facing(p, 1, left, sides.p_right, sides.p_left);
  const Chain cq = facing(q, -1, left, sides.q_left, sides.q_right);
  probes += 2;
  // Sign of the height of R's vertex (i, j) over the line.
  const auto height = [&](int i, int j) {
    ++probes;
    return offset_along(p.vertex(cp.vertex(i)), q.vertex(cq.vertex(j)), y, left);
  };
  const int bottom = height(0, 0), top = height(cp.size, cq.size);
  if (bottom > 0 || top < 0) return std::nullopt;
  ExitEdge exit;
  exit.grazes = bottom == 0 || top == 0;
  // The wanted edge leads from a vertex not above the line to one above it (on it, where the line grazes the top); it
  // is one of P's edges [pl, pr) or of Q's [ql, qr), and what was dropped on the left comes before it in slope order.
  ChainRange range{0, cp.size, 0, cq.size};
  if (top > 0) GridSearch(cp, cq, y, left, d, probes).run(range);
  auto [pl, pr, ql, qr] = range;
  const auto is_above = [&](int i, int j) { return top == 0 ? i == cp.size && j == cq.size : height(i, j) > 0; };
  while (pl < pr && ql < qr) {
    const int i = pl + (pr - pl) / 2, j = ql + (qr - ql) / 2;
    ++probes;
    if (turn(cp.edge(i), cq.edge(j)) >= 0) {
      // P's comes first: R has passed vertex (i + 1, at most j) behind it and (at least i + 1, j) before Q's.
      is_above(i + 1, j) ? qr = j : pl = i + 1;
    } else {
      is_above(i, j + 1) ? pr = i : ql = j + 1;
    }
  }
  // One polygon's share is known: its vertex stays while the other's edges pass.
  while (pr - pl > 1 && ql == qr) {
    const int i = pl + (pr - pl) / 2;
    is_above(i, ql) ? pr = i : pl = i;
  }
  while (qr - ql > 1 && pl == pr) {
    const int j = ql + (qr - ql) / 2;
    is_above(pl, j) ? qr = j : ql = j;
  }
  const bool of_p = pl < pr;
  exit.edge = of_p ? cp.edge(pl) : cq.edge(ql);
  exit.parts.vertex_p = cp.vertex(pl);
  exit.parts.vertex_q = cq.vertex(ql);
  (of_p ? exit.parts.edge_of_p : exit.parts.edge_of_q) = of_p ? cp.vertex(pl) : cq.vertex(ql);
  // A parallel edge of the other polygon stands beside it in slope order.
  const Chain& other = of_p ? cq : cp;
  const int at = of_p ? ql : pl;
  for (const int k : {at - 1, at}) {
    if (k < 0 || k >= other.size) continue;
    ++probes;
    if (turn(exit.edge, other.edge(k)) != 0) continue;
    (of_p ? exit.parts.edge_of_q : exit.parts.edge_of_p) = other.vertex(k);
    (of_p ? exit.parts.vertex_q : exit.parts.vertex_p) = other.vertex(k);
  }
  return exit;
}

}  // namespace pd::detail

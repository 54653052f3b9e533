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

  /// 0 <= k <= size, less than all vertices.
  [[nodiscard]] int vertex(int k) const {
    const int i = first + k, n = polygon->num_vertices();
    return i < n ? i : i - n;
  }
  [[nodiscard]] PolygonEdge edge(int k) const { return edge_of(*polygon, vertex(k), sign); }
  /// Where the table has the first edge at or after direction k of a grid.
  [[nodiscard]] const std::int32_t& entry(int k, int count) const {
    const auto table = polygon->first_edges();
    const int cells = static_cast<int>(table.size()) - 1;
    // -Q's edges are Q's, turned round.
    const int turned = sign > 0 ? k : (k < count / 2 ? k + count / 2 : k - count / 2);
    return table[static_cast<std::size_t>(turned) * static_cast<std::size_t>(cells / count)];
  }
  /// How many of the chain's edges come before direction k of a grid, which is one of those between its ends.
  [[nodiscard]] int edges_before(int k, int count) const {
    const int n = polygon->num_vertices(), place = entry(k, count) - first;
    return place < 0 ? place + n : (place < n ? place : place - n);
  }
  /// The vertex at which the edges at or after direction k begin.
  [[nodiscard]] int vertex_at(int k, int count) const {
    const int i = entry(k, count);
    return i == polygon->num_vertices() ? 0 : i;
  }
};

/// The directions of the grid that both polygons' tables have; 0: one has no table.
int common_grid(const ConvexPolygon& p, const ConvexPolygon& q) {
  return static_cast<int>(std::max<std::size_t>(std::min(p.first_edges().size(), q.first_edges().size()), 1)) - 1;
}

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

constexpr int kHalvedCells = 256;  ///< above this part of the grid the boundary is no straight line

/// Narrows a range by the directions of the two polygons' common grid, whose vertices of R their tables know. First by
/// halves, always at the same few places; then, where the boundary is nearly straight, between the heights of the two
/// ends, and by halves again where that gained little: O(log of the grid) heights.
class GridSearch {
 public:
  GridSearch(const Chain& p, const Chain& q, const Point2& y, const Point2& left, int count, std::int64_t& probes)
      : p_(p), q_(q), y_(y), left_(left), count_(count), probes_(probes) {}

  /// @param low, high  directions of the grid, counted on past its end, between which the range's edges come; heights
  /// of its ends over the line.
  void run(ChainRange& range, int low, double low_height, int high, double high_height) {
    low_ = {low, range.p_low, range.q_low, low_height};
    high_ = {high, range.p_high, range.q_high, high_height};
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
  static constexpr int kFew = 8;  ///< edges left to the search by slopes

  struct End {
    int k;  ///< direction of the grid, counted on past its end
    int p, q;
    double height;
  };

  void look(int k) {
    const int wrapped = k < count_ ? k : k - count_;
    const int i = p_.edges_before(wrapped, count_), j = q_.edges_before(wrapped, count_);
    ++probes_;
    const SignedOffset height =
        offset_along(p_.polygon->vertex(p_.vertex(i)), q_.polygon->vertex(q_.vertex(j)), y_, left_);
    (height.sign > 0 ? high_ : low_) = {k, i, j, height.value};
  }
  /// Where a straight boundary would cross the line, and there beside it by more than it is bent.
  void interpolate(int width) {
    const double part = low_.height / (low_.height - high_.height);
    const int guess = low_.k + (part > 0 ? static_cast<int>(std::min(part, 1.0) * width) : 0);
    const int k = std::clamp(guess, low_.k + 1, high_.k - 1);
    const int air = 2 + static_cast<int>(static_cast<double>(width) * width / count_);
    fetch(k - air, k, k + air);
    look(k);
    const int beside = high_.k == k ? k - air : k + air;
    if (beside > low_.k && beside < high_.k) look(beside);
  }
  /// Entries and vertices of three directions, each kind asked for together: they arrive in the time of one.
  template <class... K>
  void fetch(K... k) const {
    const auto all = [&](const auto& want) { (want(std::clamp(k, low_.k, high_.k)), ...); };
    const auto entry = [&](const Chain& c, int i) -> const std::int32_t& {
      return c.entry(i < count_ ? i : i - count_, count_);
    };
    all([&](int i) { __builtin_prefetch(&entry(p_, i)), __builtin_prefetch(&entry(q_, i)); });
    all([&](int i) {
      for (const Chain* c : {&p_, &q_}) __builtin_prefetch(c->polygon->points().data() + entry(*c, i));
    });
  }

  const Chain& p_;
  const Chain& q_;
  const Point2 &y_, &left_;
  int count_;
  std::int64_t& probes_;
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

namespace {

/// The wanted edge leads from a vertex not above the line to one above it (on it, where the line grazes the top); it is
/// one of P's edges [pl, pr) or of Q's [ql, qr), and what was dropped on the left comes before it in slope order.
ExitEdge search_range(const Chain& cp, const Chain& cq, const Point2& y, const Point2& left, const ChainRange& range,
                      bool grazes_top, std::int64_t& probes) {
  auto [pl, pr, ql, qr] = range;
  const auto is_above = [&](int i, int j) {
    if (grazes_top) return i == cp.size && j == cq.size;
    ++probes;
    return offset_along(cp.polygon->vertex(cp.vertex(i)), cq.polygon->vertex(cq.vertex(j)), y, left).sign > 0;
  };
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
  ExitEdge exit;
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
  exit.right = exit.back = {cp.vertex(0), cq.vertex(0)};
  exit.left = {cp.vertex(cp.size), cq.vertex(cq.size)};
  return exit;
}

}  // namespace

std::optional<ExitEdge> find_exit(const ConvexPolygon& p, const ConvexPolygon& q, const Point2& y, const Point2& d,
                                  const SideVertices& sides, std::int64_t& probes) {
  const Point2 left{-d[1], d[0]};
  const Chain cp = facing(p, 1, left, sides.p_right, sides.p_left);
  const Chain cq = facing(q, -1, left, sides.q_left, sides.q_right);
  // Height of R's vertex (i, j) over the line.
  const auto height = [&](int i, int j) {
    return offset_along(p.vertex(cp.vertex(i)), q.vertex(cq.vertex(j)), y, left);
  };
  const SignedOffset bottom = height(0, 0), top = height(cp.size, cq.size);
  probes += 4;
  if (bottom.sign > 0 || top.sign < 0) return std::nullopt;
  ChainRange range{0, cp.size, 0, cq.size};
  if (const int count = common_grid(p, q); count != 0 && top.sign > 0) {
    const int from = static_cast<int>(grid_place(d, count));
    GridSearch(cp, cq, y, left, count, probes).run(range, from + 1, bottom.value, from + count / 2, top.value);
  }
  ExitEdge exit = search_range(cp, cq, y, left, range, top.sign == 0, probes);
  exit.grazes = bottom.sign == 0 || top.sign == 0;
  return exit;
}

std::optional<ExitEdge> find_exit_by_tables(const ConvexPolygon& p, const ConvexPolygon& q, const Point2& y,
                                            const Point2& d, std::int64_t& probes) {
  const int count = common_grid(p, q);
  if (count == 0) return std::nullopt;
  // Directions certainly between d and -d, with a cell's air for the rounding of the place of d.
  const int step = std::max(1, count / kHalvedCells), from = static_cast<int>(grid_place(d, count));
  const int low = (from + 1 + step) / step * step, high = (from + count / 2 - 1) / step * step;
  if (low >= high) return std::nullopt;
  const auto wrapped = [&](int k) { return k < count ? k : k - count; };
  const auto chain = [&](const ConvexPolygon& polygon, double sign) {
    Chain c{&polygon, sign, 0, 0};
    c.first = c.vertex_at(wrapped(low), count);
    c.size = c.edges_before(wrapped(high), count);
    return c;
  };
  const Chain cp = chain(p, 1), cq = chain(q, -1);
  const Point2 left{-d[1], d[0]};
  const auto height = [&](int i, int j) {
    return offset_along(p.vertex(cp.vertex(i)), q.vertex(cq.vertex(j)), y, left);
  };
  const SignedOffset bottom = height(0, 0), top = height(cp.size, cq.size);
  probes += 2;
  if (bottom.sign >= 0 || top.sign <= 0) return std::nullopt;
  ChainRange range{0, cp.size, 0, cq.size};
  GridSearch(cp, cq, y, left, count, probes).run(range, low, bottom.value, high, top.value);
  ExitEdge exit = search_range(cp, cq, y, left, range, false, probes);
  const int behind = wrapped(wrapped((low + high) / 2 / step * step) + count / 2);
  exit.back = {cp.vertex_at(behind, count), cq.vertex_at(behind, count)};
  return exit;
}

}  // namespace pd::detail

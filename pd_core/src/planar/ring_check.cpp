#include "planar/ring_check.hpp"

#include <algorithm>
#include <numeric>
#include <set>
#include <utility>

#include "pd/numeric/predicates.hpp"

namespace pd::detail {

namespace {

class Sweep {
 public:
  explicit Sweep(const Rings& rings)
      : rings_(rings), status_(Below{this}), place_(rings.points.size(), status_.end()) {}

  RingCheck run() {
    std::vector<std::int32_t> order(rings_.points.size());
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(),
              [&](int a, int b) { return point(a) != point(b) ? before(point(a), point(b)) : a < b; });
    for (std::size_t i = 0; i < order.size() && !check_.fault;) {
      std::size_t end = i + 1;
      while (end < order.size() && point(order[end]) == point(order[i])) ++end;
      pass(std::span<const std::int32_t>(order).subspan(i, end - i));
      i = end;
    }
    return std::move(check_);
  }

 private:
  template <class T>
  static T at(std::span<const T> list, int i) {
    return list[static_cast<std::size_t>(i)];
  }
  [[nodiscard]] const Point2& point(int v) const { return rings_.points[static_cast<std::size_t>(v)]; }
  /// Edge e runs from vertex e to the next one; its ends in the order of the sweep.
  [[nodiscard]] bool rightwards(int e) const { return before(point(e), point(at(rings_.next, e))); }
  [[nodiscard]] int left(int e) const { return rightwards(e) ? e : at(rings_.next, e); }
  [[nodiscard]] int right(int e) const { return rightwards(e) ? at(rings_.next, e) : e; }

  /// 1 where the vertex lies above the edge, 0 on its line.
  [[nodiscard]] int side(int e, int v) const { return orient2d(point(left(e)), point(right(e)), point(v)); }

  /// Order along the sweep line of edges that do not cross.
  [[nodiscard]] bool below(int e, int f) const {
    if (e == f) return false;
    const int le = left(e), lf = left(f);
    if (before(point(le), point(lf))) {
      int side = orient2d(point(le), point(right(e)), point(lf));
      if (side == 0) side = orient2d(point(le), point(right(e)), point(right(f)));
      return side != 0 ? side > 0 : e < f;
    }
    int side = le == lf ? 0 : orient2d(point(lf), point(right(f)), point(le));
    if (side == 0) side = orient2d(point(lf), point(right(f)), point(right(e)));
    return side != 0 ? side < 0 : e < f;
  }
  struct Probe {
    int vertex;
  };
  struct Below {
    using is_transparent = void;
    const Sweep* sweep;
    bool operator()(int e, int f) const { return sweep->below(e, f); }
    bool operator()(int e, Probe p) const { return sweep->side(e, p.vertex) > 0; }
    bool operator()(Probe p, int e) const { return sweep->side(e, p.vertex) < 0; }
  };
  using Status = std::set<int, Below>;

  void fail(RingFault::Kind kind, int edge, int other) {
    if (!check_.fault) check_.fault = RingFault{kind, edge, other};
  }
  [[nodiscard]] int ring(int v) const { return at(rings_.ring, v); }

  /// Do the edges cross inside both? Every other common point is a vertex, which the sweep comes to.
  void compare(int e, int f) {
    const Point2 &a = point(e), &b = point(at(rings_.next, e)), &c = point(f), &d = point(at(rings_.next, f));
    if (orient2d(a, b, c) * orient2d(a, b, d) < 0 && orient2d(c, d, a) * orient2d(c, d, b) < 0) {
      fail(RingFault::Kind::crossing, std::min(e, f), std::max(e, f));
    }
  }

  void insert(int e) {
    const auto it = status_.insert(e).first;
    place_[static_cast<std::size_t>(e)] = it;
    if (it != status_.begin()) compare(*std::prev(it), e);
    if (std::next(it) != status_.end()) compare(e, *std::next(it));
  }
  void erase(int e) {
    const auto it = place_[static_cast<std::size_t>(e)];
    if (it != status_.begin() && std::next(it) != status_.end()) compare(*std::prev(it), *std::next(it));
    status_.erase(it);
  }

  /// The lowest edge of the status through a point, or else the one above. An edge that ends there is known to be one.
  [[nodiscard]] Status::iterator lowest_at(std::span<const std::int32_t> here) const {
    for (const int x : here) {
      for (const int e : {at(rings_.previous, x), x}) {
        if (right(e) != x) continue;
        auto it = place_[static_cast<std::size_t>(e)];
        while (it != status_.begin() && side(*std::prev(it), x) == 0) --it;
        return it;
      }
    }
    return status_.lower_bound(Probe{here.front()});
  }

  /// All vertices at one point.
  void pass(std::span<const std::int32_t> here) {
    const int v = here.front();
    const auto lowest = lowest_at(here);
    const int under = lowest == status_.begin() ? -1 : *std::prev(lowest);
    std::vector<int> passing;
    for (auto it = lowest; it != status_.end() && side(*it, v) == 0; ++it) {
      if (point(right(*it)) != point(v)) passing.push_back(*it);
    }
    if (here.size() > 1 || !passing.empty() || !seen(ring(v))) look_around(here, passing, under);
    if (check_.fault) return;
    for (const int e : passing) check_.touches.push_back({e, v});
    check_.shared_points = check_.shared_points || here.size() + passing.size() > 1;

    // The edges that end at this point go out before those that begin come in.
    for (const int x : here) {
      if (right(at(rings_.previous, x)) == x) erase(at(rings_.previous, x));
      if (right(x) == x) erase(x);
    }
    for (const int x : here) {
      if (check_.fault) return;
      if (left(at(rings_.previous, x)) == x) insert(at(rings_.previous, x));
      if (left(x) == x) insert(x);
    }
  }

  /// Each ring that comes through a point parts the directions there in its left side and its right one, and all others
  /// must lie on its left. Then every direction back along a ring is followed, counter-clockwise, by that ring's own
  /// way out. A ring that the sweep has not met before must see the interior where the edge `under` has it.
  void look_around(std::span<const std::int32_t> here, const std::vector<int>& passing, int under) {
    const Point2& centre = point(here.front());
    std::vector<RingDirection> around;
    int fresh = -1;
    for (const int v : here) {
      around.push_back({v, point(at(rings_.previous, v)), false});
      around.push_back({v, point(at(rings_.next, v)), true});
      if (see(ring(v)) && (fresh < 0 || ring(fresh) == 0)) fresh = v;
    }
    for (const int e : passing) {
      around.push_back({e, point(e), false});
      around.push_back({e, point(at(rings_.next, e)), true});
    }
    for (std::size_t i = 0; i < around.size(); i += 2) {
      for (std::size_t j = 0; j < i; j += 2) {
        const int a = around[j].vertex, b = around[i].vertex;
        if (ring(a) != ring(b)) continue;
        return fail(passing.empty() ? RingFault::Kind::meeting : RingFault::Kind::touching, std::min(a, b),
                    std::max(a, b));
      }
    }
    sort_around(centre, around);
    for (std::size_t i = 0; i < around.size(); ++i) {
      const RingDirection &a = around[i], &b = around[(i + 1) % around.size()];
      if (around.size() > 2 && orient2d(centre, a.to, b.to) == 0 && before(centre, a.to) == before(centre, b.to)) {
        return fail(RingFault::Kind::overlapping, edge_of(a, passing), edge_of(b, passing));
      }
    }
    for (std::size_t i = 0; i < around.size(); ++i) {
      const RingDirection &a = around[i], &b = around[(i + 1) % around.size()];
      if (!a.out && b.vertex != a.vertex) return fail_beside(a.vertex, b.vertex, around);
    }
    const bool interior_below = !around.front().out;
    if (fresh < 0 || interior_below == (under >= 0 && rightwards(under))) return;
    const bool in_hole = ring(fresh) != 0 && under >= 0 && ring(under) != 0;
    fail(in_hole ? RingFault::Kind::hole_in_hole : RingFault::Kind::hole_outside, fresh, under);
  }

  /// The ring of vertex b goes through the right side of the ring of vertex a.
  void fail_beside(int a, int b, const std::vector<RingDirection>& around) {
    int beside = 0;
    for (std::size_t i = 0; i < around.size(); ++i) {
      if (around[i].vertex != a || around[i].out) continue;
      for (std::size_t k = i + 1; around[k % around.size()].vertex != a; ++k) {
        beside += around[k % around.size()].vertex == b ? 1 : 0;
      }
    }
    if (beside == 1) return fail(RingFault::Kind::crossing, std::min(a, b), std::max(a, b));
    if (ring(a) == 0) return fail(RingFault::Kind::hole_outside, b, a);
    fail(ring(b) == 0 ? RingFault::Kind::hole_outside : RingFault::Kind::hole_in_hole, ring(b) == 0 ? a : b,
         ring(b) == 0 ? b : a);
  }

  /// The edge along a direction, by its first vertex.
  [[nodiscard]] int edge_of(const RingDirection& d, const std::vector<int>& passing) const {
    if (d.out || std::find(passing.begin(), passing.end(), d.vertex) != passing.end()) return d.vertex;
    return at(rings_.previous, d.vertex);
  }

  [[nodiscard]] bool seen(int ring) const {
    return static_cast<std::size_t>(ring) < ring_seen_.size() && ring_seen_[static_cast<std::size_t>(ring)];
  }
  /// @return true the first time.
  bool see(int ring) {
    if (ring_seen_.size() <= static_cast<std::size_t>(ring)) ring_seen_.resize(static_cast<std::size_t>(ring) + 1);
    if (ring_seen_[static_cast<std::size_t>(ring)]) return false;
    return ring_seen_[static_cast<std::size_t>(ring)] = true;
  }

  const Rings& rings_;
  Status status_;
  std::vector<Status::iterator> place_;
  std::vector<bool> ring_seen_;
  RingCheck check_;
};

}  // namespace

RingCheck check_rings(const Rings& rings) { return Sweep(rings).run(); }

void sort_around(const Point2& centre, std::vector<RingDirection>& directions) {
  std::stable_sort(directions.begin(), directions.end(), [&](const RingDirection& a, const RingDirection& b) {
    const bool a_left = before(a.to, centre), b_left = before(b.to, centre);
    return a_left != b_left ? b_left : orient2d(centre, a.to, b.to) > 0;
  });
}

}  // namespace pd::detail

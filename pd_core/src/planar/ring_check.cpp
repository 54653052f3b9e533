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

  std::optional<RingFault> run() {
    std::vector<std::int32_t> order(rings_.points.size());
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(), [&](int a, int b) { return before(point(a), point(b)); });
    std::vector<bool> ring_seen;
    for (std::size_t i = 0; i < order.size() && !fault_; ++i) {
      const int v = order[i];
      if (i > 0 && point(order[i - 1]) == point(v)) {
        fault_ = RingFault{RingFault::Kind::meeting, v, order[i - 1]};
        break;
      }
      const auto ring = static_cast<std::size_t>(at(rings_.ring, v));
      if (ring_seen.size() <= ring) ring_seen.resize(ring + 1);
      const bool first_of_ring = !ring_seen[ring];
      ring_seen[ring] = true;
      pass(v, first_of_ring);
    }
    return fault_;
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
  struct Below {
    const Sweep* sweep;
    bool operator()(int e, int f) const { return sweep->below(e, f); }
  };
  using Status = std::set<int, Below>;

  static bool in_box(const Point2& a, const Point2& b, const Point2& p) {
    for (std::size_t k = 0; k < 2; ++k) {
      if (p[k] < std::min(a[k], b[k]) || p[k] > std::max(a[k], b[k])) return false;
    }
    return true;
  }

  /// Do the closed edges share a point other than the vertex that neighbours have in common?
  void compare(int e, int f) {
    if (fault_) return;
    const int e2 = at(rings_.next, e), f2 = at(rings_.next, f);
    if (e2 == f || f2 == e) return;  // neighbours meet in one vertex: folds are refused before
    const Point2 &a = point(e), &b = point(e2), &c = point(f), &d = point(f2);
    const int c_side = orient2d(a, b, c), d_side = orient2d(a, b, d);
    const int a_side = orient2d(c, d, a), b_side = orient2d(c, d, b);
    if (c_side * d_side < 0 && a_side * b_side < 0) {
      fault_ = RingFault{RingFault::Kind::crossing, std::min(e, f), std::max(e, f)};
    } else if ((c_side == 0 && in_box(a, b, c)) || (d_side == 0 && in_box(a, b, d)) ||
               (a_side == 0 && in_box(c, d, a)) || (b_side == 0 && in_box(c, d, b))) {
      fault_ = RingFault{RingFault::Kind::touching, std::min(e, f), std::max(e, f)};
    }
  }

  Status::iterator insert(int e) {
    const auto [it, fresh] = status_.insert(e);
    place_[static_cast<std::size_t>(e)] = it;
    if (it != status_.begin()) compare(*std::prev(it), e);
    if (std::next(it) != status_.end()) compare(e, *std::next(it));
    return it;
  }
  void erase(int e) {
    const auto it = place_[static_cast<std::size_t>(e)];
    if (it != status_.begin() && std::next(it) != status_.end()) compare(*std::prev(it), *std::next(it));
    status_.erase(it);
  }

  /// The first vertex of a hole must see the interior of the polygon below it.
  void place_ring(int v, Status::iterator lowest) {
    const int ring = at(rings_.ring, v);
    if (lowest == status_.begin()) {
      if (ring != 0) fault_ = RingFault{RingFault::Kind::hole_outside, v, -1};
      return;
    }
    const int under = *std::prev(lowest);
    if (ring == 0 || rightwards(under)) return;  // an outer ring in a hole: the hole came first and was refused
    const bool of_hole = at(rings_.ring, under) != 0;
    fault_ = RingFault{of_hole ? RingFault::Kind::hole_in_hole : RingFault::Kind::hole_outside, v, under};
  }

  void pass(int v, bool first_of_ring) {
    const int in = at(rings_.previous, v), out = v;
    // Where v has an edge on its left, what ends goes out before what begins comes in.
    if (right(in) == v) erase(in);
    if (right(out) == v) erase(out);
    if (fault_) return;
    if (left(in) == v) insert(in);
    if (left(out) == v && !fault_) insert(out);
    if (first_of_ring && !fault_) {
      const auto a = place_[static_cast<std::size_t>(in)], b = place_[static_cast<std::size_t>(out)];
      place_ring(v, below(*a, *b) ? a : b);
    }
  }

  const Rings& rings_;
  Status status_;
  std::vector<Status::iterator> place_;
  std::optional<RingFault> fault_;
};

}  // namespace

std::optional<RingFault> find_ring_fault(const Rings& rings) { return Sweep(rings).run(); }

}  // namespace pd::detail

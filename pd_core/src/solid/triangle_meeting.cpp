#include "solid/triangle_meeting.hpp"

#include <algorithm>
#include <utility>

#include "solid/winding.hpp"

namespace pd::detail {

namespace {

using Signs = std::array<int, 3>;

std::size_t next(std::size_t k) { return (k + 1) % 3; }
std::size_t next_but_one(std::size_t k) { return (k + 2) % 3; }

bool all_of_one_sign(const Signs& s) {
  return (s[0] > 0 && s[1] > 0 && s[2] > 0) || (s[0] < 0 && s[1] < 0 && s[2] < 0);
}
bool has_both_signs(const Signs& s) {
  const auto [least, most] = std::minmax({s[0], s[1], s[2]});
  return least < 0 && most > 0;
}

int turn_of(const PosedSolids& solids, int axis, const PosedTriangle& t) {
  return solids.orient2d(axis, t[0], t[1], t[2]);
}

/// True if an edge of the first triangle has the second one beyond it, in the shadow.
bool separates(const PosedSolids& solids, int axis, const PosedTriangle& s, const PosedTriangle& t) {
  const int turn = turn_of(solids, axis, s);
  for (std::size_t k = 0; k < 3; ++k) {
    if (std::all_of(t.begin(), t.end(),
                    [&](const PosedPoint& x) { return turn * solids.orient2d(axis, s[k], s[next(k)], x) <= 0; })) {
      return true;
    }
  }
  return false;
}

/// True if the shadows of two triangles of one plane have an area in common.
bool share_shadow(const PosedSolids& solids, int axis, const PosedTriangle& s, const PosedTriangle& t) {
  return !separates(solids, axis, s, t) && !separates(solids, axis, t, s);
}

/// A triangle with the signs of its corners about the other's plane.
struct Side {
  Body body;
  std::int32_t triangle;
  PosedTriangle corners;
  Signs signs;
};

class MeetingTest {
 public:
  MeetingTest(const PosedSolids& solids, std::int32_t a, std::int32_t b)
      : solids_(solids),
        a_{Body::a, a, solids.corners(Body::a, a), {}},
        b_{Body::b, b, solids.corners(Body::b, b), {}} {}

  Meeting run() {
    if (boxes_apart()) return Meeting::apart;
    for (std::size_t k = 0; k < 3; ++k) a_.signs[k] = solids_.orient3d(b_.corners, a_.corners[k]);
    if (all_of_one_sign(a_.signs)) return Meeting::apart;
    for (std::size_t k = 0; k < 3; ++k) b_.signs[k] = solids_.orient3d(a_.corners, b_.corners[k]);
    if (all_of_one_sign(b_.signs)) return Meeting::apart;
    const bool coplanar = a_.signs == Signs{0, 0, 0};
    if (!meet(coplanar)) return Meeting::apart;
    if (coplanar) {
      meeting_ = Meeting::touch;
      if (in_one_plane()) return Meeting::overlap;
    } else {
      meeting_ = Meeting::touch;
      if (has_both_signs(a_.signs) && has_both_signs(b_.signs) && cross_inside()) return Meeting::overlap;
      if (edge_runs_through(a_, b_) || edge_runs_through(b_, a_)) return Meeting::overlap;
    }
    return edges_run_along() ? Meeting::overlap : meeting_;
  }

 private:
  [[nodiscard]] bool boxes_apart() const {
    const double slack = 2 * solids_.error();
    for (int k = 0; k < 3; ++k) {
      const auto [low_a, high_a] = std::minmax({a_.corners[0].x[k], a_.corners[1].x[k], a_.corners[2].x[k]});
      const auto [low_b, high_b] = std::minmax({b_.corners[0].x[k], b_.corners[1].x[k], b_.corners[2].x[k]});
      if (low_a - high_b > slack || low_b - high_a > slack) return true;
    }
    return false;
  }

  // ---- closed triangles ------------------------------------------------------------------------------------------

  [[nodiscard]] bool meet(bool coplanar) const {
    for (std::size_t k = 0; k < 3; ++k) {
      if (edge_meets(a_, k, b_, coplanar) || edge_meets(b_, k, a_, coplanar)) return true;
    }
    return false;
  }

  /// A closed edge and a closed triangle.
  [[nodiscard]] bool edge_meets(const Side& s, std::size_t k, const Side& t, bool coplanar) const {
    const PosedPoint &p = s.corners[k], &q = s.corners[next(k)];
    const int above_p = s.signs[k], above_q = s.signs[next(k)];
    if (above_p * above_q > 0) return false;
    if (coplanar || (above_p == 0 && above_q == 0)) return flat_edge_meets(p, q, t.corners);
    bool left = false, right = false;
    for (std::size_t i = 0; i < 3; ++i) {
      const int side = solids_.orient3d(p, q, t.corners[i], t.corners[next(i)]);
      left = left || side > 0;
      right = right || side < 0;
    }
    return !(left && right);
  }

  [[nodiscard]] bool between(const PosedPoint& x, const PosedPoint& p, const PosedPoint& q) const {
    for (int k = 0; k < 3; ++k) {
      if (solids_.compare(k, x, p) * solids_.compare(k, x, q) > 0) return false;
    }
    return true;
  }

  [[nodiscard]] bool flat_edge_meets(const PosedPoint& p, const PosedPoint& q, const PosedTriangle& t) const {
    if (holds_in_plane(solids_, t, p)) return true;
    const int axis = shadow_axis(solids_, t);
    for (std::size_t k = 0; k < 3; ++k) {
      const PosedPoint &u = t[k], &v = t[next(k)];
      const int pu = solids_.orient2d(axis, p, q, u), pv = solids_.orient2d(axis, p, q, v);
      const int up = solids_.orient2d(axis, u, v, p), uq = solids_.orient2d(axis, u, v, q);
      if (pu * pv < 0 && up * uq < 0) return true;
      if (pu == 0 && between(u, p, q)) return true;
      if (pv == 0 && between(v, p, q)) return true;
      if (up == 0 && between(p, u, v)) return true;
      if (uq == 0 && between(q, u, v)) return true;
    }
    return false;
  }

  // ---- open triangles that cross ---------------------------------------------------------------------------------

  /// The corner that alone lies on its side of the other's plane first, that side being the upper one.
  struct Crossing {
    std::array<const PosedPoint*, 3> corners;
    bool turned;  ///< the alone corner lies below
  };
  static Crossing alone_first(const Side& s) {
    for (std::size_t k = 0; k < 3; ++k) {
      const int here = s.signs[k];
      if (here == 0) continue;
      const int m = here * s.signs[next(k)], n = here * s.signs[next_but_one(k)];
      if (m <= 0 && n <= 0) {
        return {{&s.corners[k], &s.corners[next(k)], &s.corners[next_but_one(k)]}, here < 0};
      }
    }
    return {{&s.corners[0], &s.corners[1], &s.corners[2]}, false};
  }

  /// The planes' common line meets each open triangle in an open interval; the two have a point in common (after
  /// Guigue, Devillers, "Fast and robust triangle-triangle overlap test using orientation predicates", 2003).
  [[nodiscard]] bool cross_inside() const {
    Crossing p = alone_first(a_), q = alone_first(b_);
    // Each is so turned round that the other's alone corner lies above it.
    if (q.turned) std::swap(p.corners[1], p.corners[2]);
    if (p.turned) std::swap(q.corners[1], q.corners[2]);
    return solids_.orient3d(*p.corners[0], *p.corners[1], *q.corners[0], *q.corners[1]) < 0 &&
           solids_.orient3d(*p.corners[0], *p.corners[2], *q.corners[2], *q.corners[0]) < 0;
  }

  // ---- edges and planes ------------------------------------------------------------------------------------------

  [[nodiscard]] PosedPoint beyond(const Side& s, std::size_t k) const {
    const MeshSolid& solid = solids_.solid(s.body);
    const MeshSolid::Triangle& here = solid.triangle(s.triangle);
    const MeshSolid::Triangle& there = solid.triangle(here.neighbours[k]);
    const std::int32_t p = here.vertices[k], q = here.vertices[next(k)];
    const auto apex =
        std::find_if(there.vertices.begin(), there.vertices.end(), [&](std::int32_t v) { return v != p && v != q; });
    return solids_.point(s.body, *apex);
  }

  /// An edge of `s` runs in the plane of `t`, through the open triangle: does the wedge at the edge hold points below
  /// the triangle?
  bool edge_runs_through(const Side& s, const Side& t) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (s.signs[k] != 0 || s.signs[next(k)] != 0) continue;
      const PosedPoint &p = s.corners[k], &q = s.corners[next(k)];
      if (!runs_through(p, q, t.corners)) continue;
      if (s.signs[next_but_one(k)] < 0) return true;
      const PosedPoint apex = beyond(s, k);
      if (solids_.orient3d(t.corners, apex) < 0) return true;
      // Both faces rise from the plane: below it lies the solid where the wedge is reflex, and else the outside.
      if (solids_.orient3d(s.corners, apex) > 0) return true;
      meeting_ = Meeting::arc;
    }
    return false;
  }

  /// An open edge and an open triangle of one plane have points in common: no line through an edge of either separates
  /// them.
  [[nodiscard]] bool runs_through(const PosedPoint& p, const PosedPoint& q, const PosedTriangle& t) const {
    const int axis = shadow_axis(solids_, t);
    const int turn = solids_.orient2d(axis, t[0], t[1], t[2]);
    bool left = false, right = false;
    for (std::size_t k = 0; k < 3; ++k) {
      if (turn * solids_.orient2d(axis, t[k], t[next(k)], p) <= 0 &&
          turn * solids_.orient2d(axis, t[k], t[next(k)], q) <= 0) {
        return false;
      }
      const int side = solids_.orient2d(axis, p, q, t[k]);
      left = left || side > 0;
      right = right || side < 0;
    }
    return left && right;
  }

  /// Triangles of one plane: where they have an area in common, both solids lie on one side of it, or on opposite ones.
  bool in_one_plane() {
    const int axis = shadow_axis(solids_, a_.corners);
    const int turn_a = turn_of(solids_, axis, a_.corners), turn_b = turn_of(solids_, axis, b_.corners);
    if (!share_shadow(solids_, axis, a_.corners, b_.corners)) return false;
    if (turn_a == turn_b) return true;
    meeting_ = Meeting::arc;
    return false;
  }

  // ---- edges that run along each other ---------------------------------------------------------------------------

  [[nodiscard]] bool collinear(const PosedPoint& p, const PosedPoint& q, const PosedPoint& x) const {
    for (int axis = 0; axis < 3; ++axis) {
      if (solids_.orient2d(axis, p, q, x) != 0) return false;
    }
    return true;
  }

  bool edges_run_along() {
    for (std::size_t i = 0; i < 3; ++i) {
      if (a_.signs[i] != 0 || a_.signs[next(i)] != 0) continue;
      for (std::size_t j = 0; j < 3; ++j) {
        if (b_.signs[j] != 0 || b_.signs[next(j)] != 0) continue;
        if (along(i, j) && wedges_meet(i, j)) return true;
      }
    }
    return false;
  }

  /// Two open edges of one line have a segment in common.
  bool along(std::size_t i, std::size_t j) {
    const PosedPoint &p = a_.corners[i], &q = a_.corners[next(i)], &u = b_.corners[j], &v = b_.corners[next(j)];
    if (!collinear(p, q, u) || !collinear(p, q, v)) return false;
    int axis = 0;
    while (solids_.compare(axis, p, q) == 0) ++axis;
    const int forward = solids_.compare(axis, q, p);
    same_way_ = solids_.compare(axis, v, u) == forward;
    const PosedPoint &first = same_way_ ? u : v, &last = same_way_ ? v : u;
    return forward * solids_.compare(axis, q, first) > 0 && forward * solids_.compare(axis, last, p) > 0;
  }

  /// Seen along A's edge, a solid fills the open arc of directions that runs counter-clockwise from the face behind the
  /// edge to the face in which the edge runs forward. Two open arcs meet exactly when one begins in the other.
  bool wedges_meet(std::size_t i, std::size_t j) {
    const PosedPoint &p = a_.corners[i], &q = a_.corners[next(i)];
    const PosedPoint from_a = beyond(a_, i), to_a = a_.corners[next_but_one(i)];
    PosedPoint from_b = beyond(b_, j), to_b = b_.corners[next_but_one(j)];
    if (!same_way_) std::swap(from_b, to_b);
    if (begins_in(p, q, from_b, from_a, to_a) || begins_in(p, q, from_a, from_b, to_b)) return true;
    meeting_ = Meeting::arc;
    return false;
  }

  /// True if the direction of x lies in the arc that begins with that of `from` and runs up to, without it, that of
  /// `to`, counter-clockwise about the line from p to q.
  [[nodiscard]] bool begins_in(const PosedPoint& p, const PosedPoint& q, const PosedPoint& x, const PosedPoint& from,
                               const PosedPoint& to) const {
    // The angle from `from`: 0 within [0, half turn), 1 within [half turn, full turn).
    const int at = half(p, q, from, x), end = half(p, q, from, to);
    if (at == 0) return true;
    if (at != end) return at < end;
    return solids_.orient3d(p, q, x, to) > 0;
  }
  /// 0: the same direction; 1: less than half a turn ahead; 2: opposite; 3: more than half a turn ahead.
  [[nodiscard]] int half(const PosedPoint& p, const PosedPoint& q, const PosedPoint& from, const PosedPoint& x) const {
    const int side = solids_.orient3d(p, q, from, x);
    if (side != 0) return side > 0 ? 1 : 3;
    for (int axis = 0; axis < 3; ++axis) {
      const int turn = solids_.orient2d(axis, p, q, from);
      if (turn != 0) return solids_.orient2d(axis, p, q, x) == turn ? 0 : 2;
    }
    return 0;
  }

  const PosedSolids& solids_;
  Side a_, b_;
  Meeting meeting_ = Meeting::apart;
  bool same_way_ = true;
};

}  // namespace

bool share_area(const PosedSolids& solids, const PosedTriangle& s, const PosedTriangle& t) {
  const bool one_plane =
      std::all_of(t.begin(), t.end(), [&](const PosedPoint& x) { return solids.orient3d(s, x) == 0; });
  return one_plane && share_shadow(solids, shadow_axis(solids, s), s, t);
}

Meeting meeting_of(const PosedSolids& solids, std::int32_t triangle_a, std::int32_t triangle_b) {
  return MeetingTest(solids, triangle_a, triangle_b).run();
}

}  // namespace pd::detail

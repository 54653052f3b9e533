// A seat is a place where two solids fit exactly: they touch, and no open set of directions lets A leave.
//
// The small translations of A that let the two overlap form a cone, since all lengths scale. Its boundary lies in
// planes through zero: a vertex moves in the plane of a face on which it lies, and an edge that meets another moves in
// the plane that both span. So the planes cut the directions into sectors that are free or forbidden as a whole, and
// one small translation of each tells, by its exact class. "Small" is less than the distance of every vertex and edge
// of one solid from the features of the other that it does not meet: a plane of other features begins no nearer.
//
// Most directions are told by single contacts. Where faces lie on each other, where a vertex lies inside a face, and
// where edges cross, A may only move to its own side of the contact's plane.
#include <algorithm>
#include <cmath>
#include <vector>

#include "numeric/floating_point_guard.hpp"
#include "pd/solid/solid_depth.hpp"
#include "solid/direction_sector.hpp"
#include "solid/posed_solids.hpp"
#include "solid/solid_contact.hpp"
#include "solid/triangle_meeting.hpp"
#include "solid/winding.hpp"

namespace pd {

namespace {

using detail::Body;
using detail::Dyadic;
using detail::Dyadic3;
using detail::PosedPoint;
using detail::PosedSolids;
using detail::PosedTriangle;

/// Inside lengths, of bodies of size 1. Features that are nearer than the first and do not meet are too near to tell.
constexpr double kNear = 0x1p-20, kFar = 0x1p-12;
constexpr std::int64_t kMostSectors = 4096;

struct Edge {
  const PosedPoint& p;
  const PosedPoint& q;
};
Edge edge(const PosedTriangle& t, std::size_t k) { return {t[k], t[(k + 1) % 3]}; }

double distance(const PosedPoint& x, const PosedPoint& y) { return (x.x - y.x).norm(); }

double distance(const PosedPoint& x, const Edge& e) {
  const Vec3 u = e.q.x - e.p.x, w = x.x - e.p.x;
  const double along = std::clamp(u.dot(w) / u.squaredNorm(), 0.0, 1.0);
  return (w - along * u).norm();
}

/// Between a point and the open triangle if there is a foot in it; edges are asked elsewhere.
double distance(const PosedPoint& x, const PosedTriangle& t) {
  const Vec3 u = t[1].x - t[0].x, v = t[2].x - t[0].x, w = x.x - t[0].x;
  const Vec3 n = u.cross(v);
  const double area = n.squaredNorm(), s = w.cross(v).dot(n), r = u.cross(w).dot(n);
  return s > 0 && r > 0 && s + r < area ? std::abs(n.dot(w)) / std::sqrt(area) : HUGE_VAL;
}

/// Between two open edges if their common perpendicular meets both; ends are asked elsewhere.
double distance(const Edge& e, const Edge& f) {
  const Vec3 u = e.q.x - e.p.x, v = f.q.x - f.p.x, w = f.p.x - e.p.x;
  const Vec3 n = u.cross(v);
  const double area = n.squaredNorm(), s = w.cross(v).dot(n), r = w.cross(u).dot(n);
  return s >= 0 && s <= area && r >= 0 && r <= area && area > 0 ? std::abs(n.dot(w)) / std::sqrt(area) : HUGE_VAL;
}

enum class EdgesMeet : std::uint8_t { no, at_an_end, inside };

/// Two edges of different lines.
EdgesMeet meet(const PosedSolids& solids, const Edge& e, const Edge& f) {
  if (solids.orient3d(e.p, e.q, f.p, f.q) != 0) return EdgesMeet::no;
  for (int axis = 0; axis < 3; ++axis) {
    const int fp = solids.orient2d(axis, e.p, e.q, f.p), fq = solids.orient2d(axis, e.p, e.q, f.q);
    if (fp == 0 && fq == 0) continue;  // a shadow without an area, or one line
    const int ep = solids.orient2d(axis, f.p, f.q, e.p), eq = solids.orient2d(axis, f.p, f.q, e.q);
    if (fp * fq < 0 && ep * eq < 0) return EdgesMeet::inside;
    return fp * fq <= 0 && ep * eq <= 0 ? EdgesMeet::at_an_end : EdgesMeet::no;
  }
  return EdgesMeet::no;
}

bool same(const PosedSolids& solids, const PosedPoint& x, const PosedPoint& y) {
  return solids.compare(0, x, y) == 0 && solids.compare(1, x, y) == 0 && solids.compare(2, x, y) == 0;
}

bool lies_on(const PosedSolids& solids, const PosedPoint& x, const Edge& e) {
  for (int k = 0; k < 3; ++k) {
    if (solids.orient2d(k, e.p, e.q, x) != 0 || solids.compare(k, x, e.p) * solids.compare(k, x, e.q) > 0) return false;
  }
  return true;
}

bool lies_inside(const PosedSolids& solids, const PosedTriangle& t, const PosedPoint& x) {
  const int axis = detail::shadow_axis(solids, t), turn = solids.orient2d(axis, t[0], t[1], t[2]);
  return turn == solids.orient2d(axis, t[0], t[1], x) && turn == solids.orient2d(axis, t[1], t[2], x) &&
         turn == solids.orient2d(axis, t[2], t[0], x);
}

class SeatSearch {
 public:
  SeatSearch(const PosedSolid& a, const PosedSolid& b)
      : a_(a), b_(b), solids_(*a.solid, a.pose, *b.solid, b.pose), sectors_(detail::DirectionSector::octants()) {}

  Expected<bool> run() {
    if (contact_of(solids_).contact != ContactClass::touching) return false;
    visit(0, 0);
    if (sectors_.empty()) return true;
    if (is_unclear_) {
      return Error{
          ErrorCode::limit_exceeded,
          "vertices and edges of the two bodies that do not meet are nearer than a millionth of their size, so "
          "that it cannot be told if A fits exactly",
          ""};
    }
    for (const detail::DirectionSector& sector : sectors_) {
      if (has_way_out(sector, 0, nullptr)) return false;
    }
    if (is_unclear_ || tested_ > kMostSectors) {
      return Error{ErrorCode::limit_exceeded,
                   "it cannot be told if A fits exactly: more than 4,096 sectors of directions, or one too thin", ""};
    }
    return true;
  }

 private:
  // ---- pairs of triangles that are near each other
  // -------------------------------------------------------------------

  [[nodiscard]] const TriangleNode& node(Body body, std::int32_t at) const {
    return solids_.solid(body).nodes()[static_cast<std::size_t>(at)];
  }

  void visit(std::int32_t at_a, std::int32_t at_b) {
    if (sectors_.empty()) return;
    const TriangleNode &a = node(Body::a, at_a), &b = node(Body::b, at_b);
    const detail::TriangleBox box_a = solids_.box(Body::a, a), box_b = solids_.box(Body::b, b);
    if ((box_b.low - box_a.high).cwiseMax(box_a.low - box_b.high).maxCoeff() > small_) return;
    if (a.is_leaf() && b.is_leaf()) {
      for (std::int32_t s = a.first; s < a.last; ++s) {
        for (std::int32_t t = b.first; t < b.last; ++t) look_at(s, t);
      }
    } else if (!a.is_leaf() &&
               (b.is_leaf() || (box_a.high - box_a.low).maxCoeff() >= (box_b.high - box_b.low).maxCoeff())) {
      visit(a.left, at_b);
      visit(a.right, at_b);
    } else {
      visit(at_a, b.left);
      visit(at_a, b.right);
    }
  }

  void look_at(std::int32_t s, std::int32_t t) {
    const PosedTriangle a = solids_.corners(Body::a, s), b = solids_.corners(Body::b, t);
    if (detail::share_area(solids_, a, b)) keep_side(normal_of(b));
    for (std::size_t i = 0; i < 3; ++i) {
      look_at(a[i], b, 1);
      look_at(b[i], a, -1);
      for (std::size_t j = 0; j < 3; ++j) {
        (void)told(distance(a[i], b[j]), [&] { return same(solids_, a[i], b[j]); });
        (void)told(distance(a[i], edge(b, j)), [&] { return lies_on(solids_, a[i], edge(b, j)); });
        (void)told(distance(b[i], edge(a, j)), [&] { return lies_on(solids_, b[i], edge(a, j)); });
        look_at(a, i, b, j);
      }
    }
  }

  /// A vertex of one solid and a triangle of the other. @param away  1: the vertex is A's, else -1
  void look_at(const PosedPoint& x, const PosedTriangle& t, double away) {
    const auto meets = [&] { return solids_.orient3d(t, x) == 0 && holds_in_plane(solids_, t, x); };
    double gap = distance(x, t);
    for (std::size_t k = 0; k < 3; ++k) gap = std::min(gap, distance(x, edge(t, k)));
    if (!told(gap, meets)) return;
    const Dyadic3 normal = normal_of(t) * Dyadic(away);
    lies_inside(solids_, t, x) ? keep_side(normal) : add_plane(normal);
  }

  void look_at(const PosedTriangle& a, std::size_t i, const PosedTriangle& b, std::size_t j) {
    const Edge e = edge(a, i), f = edge(b, j);
    double gap = distance(e, f);
    for (const PosedPoint* end : {&e.p, &e.q}) gap = std::min(gap, distance(*end, f));
    for (const PosedPoint* end : {&f.p, &f.q}) gap = std::min(gap, distance(*end, e));
    if (gap > kNear) {
      small_ = std::min(small_, 0.25 * gap);
      return;
    }
    const EdgesMeet found = meet(solids_, e, f);
    // Edges of one plane that do not meet are as far from each other as an end of one is from the other.
    if (found == EdgesMeet::no) {
      is_unclear_ = is_unclear_ || solids_.orient3d(e.p, e.q, f.p, f.q) != 0;
      return;
    }
    const Dyadic3 u = solids_.exact_way(e.p, e.q), v = solids_.exact_way(f.p, f.q);
    const Dyadic3 normal = cross(u, v);
    // Both solids are convex along edges that cross, so that the plane of the edges separates the two there.
    const int side_a = dot(normal, solids_.exact_way(e.p, a[(i + 2) % 3])).sign();
    const int side_b = dot(normal, solids_.exact_way(f.p, b[(j + 2) % 3])).sign();
    if (found == EdgesMeet::inside && side_a != side_b) {
      keep_side(normal * Dyadic(side_a > 0 || side_b < 0 ? 1.0 : -1.0));
    } else {
      add_plane(normal);
    }
  }

  /// Tells if two features meet. Those that do not bound the way that is small.
  template <class Meets>
  bool told(double gap, const Meets& meets) {
    if (gap > kNear) {
      small_ = std::min(small_, 0.25 * gap);
      return false;
    }
    if (meets()) return true;
    is_unclear_ = true;
    return false;
  }

  [[nodiscard]] Dyadic3 normal_of(const PosedTriangle& t) const {
    return cross(solids_.exact_way(t[0], t[1]), solids_.exact_way(t[0], t[2]));
  }

  // ---- directions --------------------------------------------------------------------------------------------------

  /// A can only move to the side of the normal, or along the plane.
  void keep_side(const Dyadic3& normal) {
    if (!add_if_new(sides_, normal, true)) return;
    std::erase_if(sectors_, [&](detail::DirectionSector& sector) { return !sector.cut(normal); });
  }

  void add_plane(const Dyadic3& normal) { (void)add_if_new(planes_, normal, false); }

  struct Plane {
    Dyadic3 normal;
    Vec3 unit;
  };
  /// Adds a plane to the list, and tells if it was not there. @param one_way  the opposite normal is another plane
  static bool add_if_new(std::vector<Plane>& list, const Dyadic3& normal, bool one_way) {
    const Vec3 unit = detail::rounded_unit(normal);
    for (const Plane& plane : list) {
      const double share = plane.unit.dot(unit);
      if ((one_way ? share : std::abs(share)) < 1 - 0x1p-40) continue;
      const Dyadic3 turn = cross(plane.normal, normal);
      if (turn.x.sign() == 0 && turn.y.sign() == 0 && turn.z.sign() == 0) return false;
    }
    list.push_back({normal, unit});
    return true;
  }

  /// @param forbidden  a direction that is known to be, if the sector holds one
  bool has_way_out(const detail::DirectionSector& sector, std::size_t first_plane, const Dyadic3* forbidden) {
    if (is_unclear_ || tested_ > kMostSectors) return false;
    Dyadic3 tried;
    if (forbidden == nullptr) {
      const Vec3 way = small_way(sector);
      tried = detail::to_dyadic(way);
      if (!sector.holds(tried)) {
        is_unclear_ = true;
        return false;
      }
      ++tested_;
      const PosedSolids moved(*a_.solid, a_.pose, *b_.solid, b_.pose, way);
      if (contact_of(moved).contact == ContactClass::separated) return true;
      forbidden = &tried;
    }
    const auto crossed = std::find_if(planes_.begin() + static_cast<std::ptrdiff_t>(first_plane), planes_.end(),
                                      [&](const Plane& plane) { return sector.is_crossed_by(plane.normal); });
    if (crossed == planes_.end()) return false;
    const int side = dot(crossed->normal, *forbidden).sign();
    for (const int half : {1, -1}) {
      detail::DirectionSector part = sector;
      (void)part.cut(crossed->normal * Dyadic(static_cast<double>(half)));
      const auto next = static_cast<std::size_t>(crossed - planes_.begin()) + 1;
      if (has_way_out(part, next, half == side ? forbidden : nullptr)) return true;
    }
    return false;
  }

  /// A translation in the sector, in outside lengths, if doubles hold one.
  [[nodiscard]] Vec3 small_way(const detail::DirectionSector& sector) const {
    Vec3 way = 0.5 * small_ * sector.middle().normalized();
    for (double& x : way) x = std::ldexp(x, solids_.scale_exponent());
    return way;
  }

  const PosedSolid &a_, &b_;
  PosedSolids solids_;
  std::vector<detail::DirectionSector> sectors_;  ///< that single contacts leave open
  std::vector<Plane> sides_;                      ///< by which sectors were cut
  std::vector<Plane> planes_;                     ///< at which a sector may end
  double small_ = kFar;
  bool is_unclear_ = false;
  std::int64_t tested_ = 0;
};

}  // namespace

Expected<bool> is_seat(const PosedSolid& a, const PosedSolid& b) {
  const detail::FloatingPointGuard guard;
  return SeatSearch(a, b).run();
}

}  // namespace pd

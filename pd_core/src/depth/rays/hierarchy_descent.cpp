#include "depth/rays/hierarchy_descent.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <span>

#include "depth/difference/exact_support.hpp"
#include "depth/rays/far_portal.hpp"
#include "structure/exact_climb.hpp"
#include "structure/hierarchy/plane_descent.hpp"

namespace pd::detail {

namespace {

/// A vertex and its neighbours: what stands in for a body beyond a plane.
struct Cap {
  std::array<std::int32_t, PolyhedralHierarchy::kMaxDegree + 1> vertices{};
  std::size_t count = 0;

  void add(std::int32_t v) { vertices[count++] = v; }
  [[nodiscard]] std::span<const std::int32_t> all() const { return std::span(vertices).first(count); }

  static Cap of(const PolyhedralHierarchy& hierarchy, int vertex) {
    Cap cap;
    cap.add(vertex);
    for (const PolyhedralHierarchy::Star& s : hierarchy.star(vertex)) cap.add(s.neighbour);
    return cap;
  }
  static Cap whole(const ConvexPolytope& body) {
    Cap cap;
    for (int v = 0; v < body.num_vertices(); ++v) cap.add(v);
    return cap;
  }
  /// Inner hierarchies end at a tetrahedron: a planar graph has a vertex of degree 5 or less.
  static Cap coarsest(const PolyhedralHierarchy& hierarchy) {
    Cap cap;
    for (const std::int32_t v : hierarchy.coarsest()) cap.add(v);
    return cap;
  }
};

class Descent {
 public:
  Descent(const DirectionSigns& ray, const DescentSide& a, const DescentSide& b)
      : ray_(ray), pair_(ray.pair()), portal_(ray), sides_{a, b} {
    const auto levels = [](const DescentSide& s) { return s.hierarchy ? s.hierarchy->levels().size() : 0; };
    outer_ = levels(a) <= levels(b) ? 0 : 1;
  }

  HierarchyDescentResult run() {
    const bool bounded = sides_[static_cast<std::size_t>(outer_)].hierarchy == nullptr;
    Cap cap = bounded ? Cap::whole(body(outer_)) : Cap::coarsest(hierarchy(outer_));
    for (;;) {
      descend_inner(cap);
      if (bounded) break;
      const std::optional<int> next = beyond_on_outer();
      if (!next) break;
      cap = Cap::of(hierarchy(outer_), *next);
      ++result_.caps;
    }
    if (sides_[0].finest == 0 && sides_[1].finest == 0) certify();
    if (!portal_.has_far_corner()) {
      result_.corners = {portal_.corner(0), portal_.corner(1), portal_.corner(2)};
      result_.crosses = crosses_interior();
    }
    result_.steps += portal_.signs_asked();
    return result_;
  }

 private:
  [[nodiscard]] const PolyhedralHierarchy& hierarchy(int side) const {
    return *sides_[static_cast<std::size_t>(side)].hierarchy;
  }
  [[nodiscard]] const ConvexPolytope& body(int side) const { return side == 0 ? pair_.a() : pair_.b(); }
  [[nodiscard]] int finest(int side) const { return sides_[static_cast<std::size_t>(side)].finest; }
  static std::int32_t vertex_of(const VertexPair& p, int side) { return side == 0 ? p.a : p.b; }
  [[nodiscard]] static VertexPair pair_of(int side, std::int32_t mine, std::int32_t other) {
    return side == 0 ? VertexPair{mine, other} : VertexPair{other, mine};
  }
  /// Sign of the step between two vertices of one body, as P sees it.
  int rises(const PortalPlane& plane, int side, int from, int to) {
    return side == 0 ? -portal_.sign(plane, PairVector::edge_a(from, to))
                     : portal_.sign(plane, PairVector::edge_b(from, to));
  }
  /// The plane's outward direction in the frame of a body, and towards where it is extreme there.
  [[nodiscard]] Vec3 local(const PortalPlane& plane, int side) const {
    const Vec3& n = plane.rounded.vector;
    return side == 0 ? Vec3(-(pair_.pose_a().rotation().transpose() * n))
                     : Vec3(pair_.pose_b().rotation().transpose() * n);
  }

  std::int32_t extreme(const PortalPlane& plane, int side, std::span<const std::int32_t> list) {
    const ConvexPolytope& vertices = body(side);
    const Vec3 direction = local(plane, side);
    // Twice the error of a value: that of the direction, of its rotation and of the product.
    const double margin =
        4 * vertices.max_abs_coordinate() * (4 * plane.rounded.error + 0x1p-46 * plane.rounded.vector.cwiseAbs().sum());
    std::array<double, PolyhedralHierarchy::kMaxDegree + 1> values{};
    std::size_t best = 0;
    for (std::size_t i = 0; i < list.size(); ++i) {
      values[i] = vertices.vertex(list[i]).dot(direction);
      if (values[i] > values[best]) best = i;
    }
    result_.steps += static_cast<std::int64_t>(list.size());
    const double most = values[best];
    for (std::size_t i = 0; i < list.size(); ++i) {
      if (i == best || values[i] < most - margin) continue;
      if (rises(plane, side, list[best], list[i]) > 0) best = i;
    }
    return list[best];
  }

  /// Pushes the portal outwards until its plane supports the difference of the two lists.
  void push(std::span<const std::int32_t> a, std::span<const std::int32_t> b) {
    for (;;) {
      const PortalPlane plane = portal_.plane();
      const VertexPair s{extreme(plane, 0, a), extreme(plane, 1, b)};
      if (!portal_.beyond(plane, s)) return;
      portal_.replace(s);
    }
  }
  void push(const Cap& outer, const Cap& inner) {
    outer_ == 0 ? push(outer.all(), inner.all()) : push(inner.all(), outer.all());
  }

  /// [D] Corollary 5.5: the cap of one body against all of the other, coarsest level first.
  void descend_inner(const Cap& cap) {
    const int inner = 1 - outer_;
    const PolyhedralHierarchy& h = hierarchy(inner);
    // The portal's own vertices, too: what comes in must push it outwards even where rounding hides a level's best.
    Cap coarsest = Cap::coarsest(h);
    for (std::size_t i = 0; i < 3; ++i) {
      if (!portal_.is_far(i)) coarsest.add(vertex_of(portal_.corner(i), inner));
    }
    push(cap, coarsest);
    int start = -1;
    for (;;) {
      const PortalPlane plane = portal_.plane();
      const std::int32_t opposite = extreme(plane, outer_, cap.all());
      const Vec3 direction = local(plane, inner);
      PlaneDescent levels = start < 0 ? PlaneDescent(h, direction) : PlaneDescent(h, direction, start);
      bool found = false;
      while (!found && levels.next(finest(inner))) {
        found = portal_.beyond(plane, pair_of(inner, levels.vertex(), opposite));
      }
      result_.steps += levels.evaluations();
      if (!found) return;
      start = levels.vertex();
      ++result_.caps;
      push(cap, Cap::of(h, start));
    }
  }

  /// The next finer level's vertex of the outer body beyond the plane.
  std::optional<int> beyond_on_outer() {
    const PolyhedralHierarchy& h = hierarchy(outer_);
    // Every corner's vertex is extreme; the one that came last knows most.
    int v = -1;
    for (std::size_t i = 0; i < 3; ++i) {
      if (portal_.is_far(i)) continue;
      const std::int32_t w = vertex_of(portal_.corner(i), outer_);
      if (v < 0 || h.last_level(w) < h.last_level(v)) v = w;
    }
    const PortalPlane plane = portal_.plane();
    PlaneDescent levels(h, local(plane, outer_), v);
    std::optional<int> found;
    while (!found && levels.next(finest(outer_))) {
      if (rises(plane, outer_, v, levels.vertex()) > 0) found = levels.vertex();
    }
    result_.steps += levels.evaluations();
    return found;
  }

  /// The plane supports P when no edge from a corner's vertices rises above it.
  void certify() {
    for (;;) {
      const PortalPlane plane = portal_.plane();
      std::size_t real = 0;
      while (portal_.is_far(real)) ++real;
      VertexPair s = portal_.corner(real);
      for (const int side : {0, 1}) {
        std::int32_t& v = side == 0 ? s.a : s.b;
        v = climb_exactly(body(side), v, [&](int from, int to) {
          ++result_.certificate;
          return rises(plane, side, from, to);
        });
      }
      if (!portal_.beyond(plane, s)) return;
      portal_.replace(s);
      ++result_.repairs;
    }
  }

  /// The extreme vertex of the finest level that counts, up to rounding.
  int level_extreme(const PortalPlane& plane, int side) {
    if (sides_[static_cast<std::size_t>(side)].hierarchy == nullptr) {
      return extreme(plane, side, Cap::whole(body(side)).all());
    }
    PlaneDescent levels(hierarchy(side), local(plane, side));
    while (levels.next(finest(side))) {
    }
    result_.steps += levels.evaluations();
    return levels.vertex();
  }

  /// The plane through a corner x and the direction, and through a point of P: outwards is to the right of x -> y.
  [[nodiscard]] PortalPlane plane_along_line(std::size_t x, const VertexPair& y) const {
    const VertexPair& from = portal_.corner(x);
    PortalPlane plane;
    plane.kind = PortalPlane::Kind::parallel;
    plane.w = PairVector::difference(y.a, y.b, from.a, from.b);
    plane.rounded = rounded_cross(ray_.scaled(), 0, pair_.approximate(plane.w), pair_.vector_error());
    plane.corner = x;
    return plane;
  }
  /// The point of P farthest beyond such a plane; nothing where none lies strictly beyond it.
  std::optional<VertexPair> beyond_line(const PortalPlane& plane) {
    VertexPair s = portal_.corner(plane.corner);
    for (const int side : {0, 1}) {
      std::int32_t& v = side == 0 ? s.a : s.b;
      v = level_extreme(plane, side);
      if (finest(side) > 0) continue;
      v = climb_exactly(body(side), v, [&](int from, int to) {
        ++result_.certificate;
        return rises(plane, side, from, to);
      });
    }
    const VertexPair& x = portal_.corner(plane.corner);
    if (portal_.sign(plane, PairVector::difference(x.a, x.b, s.a, s.b)) <= 0) return std::nullopt;
    return s;
  }
  [[nodiscard]] static PairVector point(const VertexPair& p) { return PairVector::point(p.a, p.b); }

  [[nodiscard]] bool on_line(std::size_t corner) const {
    const Dyadic3 c = cross(pair_.exact(point(portal_.corner(corner))), ray_.exact());
    return c.x.sign() == 0 && c.y.sign() == 0 && c.z.sign() == 0;
  }
  /// The line runs through a corner x: seen along it, points of P are followed to the right round x, from one of them
  /// on, until nothing lies on the right of one (P lies on one side of the line) or they have come round it. Each is a
  /// corner of P's shadow further round than the last, by less than half a turn, so that the shadow's corners bound the
  /// steps.
  bool surrounds(std::size_t x, const VertexPair& first) {
    VertexPair last = first;
    for (;;) {
      const std::optional<VertexPair> next = beyond_line(plane_along_line(x, last));
      if (!next) return false;
      if (ray_.turn(point(first), point(*next)) > 0) return true;
      last = *next;
    }
  }

  /// Where the line runs through a side or a corner of the portal, P must lie all round it.
  bool crosses_interior() {
    for (std::size_t i = 0; i < 3; ++i) {
      const VertexPair &x = portal_.corner(i), &y = portal_.corner((i + 1) % 3);
      if (ray_.turn(point(x), point(y)) != 0) continue;
      for (const std::size_t corner : {i, (i + 1) % 3}) {
        if (!on_line(corner)) continue;
        std::size_t other = (corner + 1) % 3;
        if (on_line(other)) other = (corner + 2) % 3;
        return surrounds(corner, portal_.corner(other));
      }
      if (!beyond_line(plane_along_line(i, y))) return false;
    }
    return true;
  }

  const DirectionSigns& ray_;
  const PosedPair& pair_;
  FarPortal portal_;
  std::array<DescentSide, 2> sides_;
  int outer_ = 0;
  HierarchyDescentResult result_;
};

}  // namespace

std::optional<Error> refuse_hierarchy(const PolyhedralHierarchy* hierarchy, const ConvexPolytope& body,
                                      const char* where) {
  if (hierarchy == nullptr) return Error{ErrorCode::bad_value, "a hierarchy is needed for each of the bodies", where};
  if (hierarchy->kind() != HierarchyKind::inner) {
    return Error{ErrorCode::unsupported, "rays descend inner hierarchies; this one is an outer one", where};
  }
  const ConvexPolytope& own = hierarchy->polytope();
  if (own.same_storage(body)) return std::nullopt;
  bool equal = own.num_vertices() == body.num_vertices();
  for (int v = 0; equal && v < body.num_vertices(); ++v) equal = own.vertex(v) == body.vertex(v);
  if (equal) return std::nullopt;
  return Error{ErrorCode::bad_value, "this is the hierarchy of another body", where};
}

HierarchyDescentResult descend_hierarchies(const DirectionSigns& ray, const DescentSide& a, const DescentSide& b) {
  return Descent(ray, a, b).run();
}

}  // namespace pd::detail

#include "depth/rays/portal.hpp"

#include <algorithm>
#include <utility>

#include "depth/difference/exact_support.hpp"

namespace pd::detail {

namespace {

PairVector point(const VertexPair& id) { return PairVector::point(id.a, id.b); }
PairVector step(const VertexPair& from, const VertexPair& to) {
  return PairVector::difference(from.a, from.b, to.a, to.b);
}

/// Whether the step between two points of P that share a vertex of one body is this edge of the other, either way.
bool is_edge(const PairVector& step, const PairVector& edge) {
  const auto same = [](std::int32_t to, std::int32_t from, std::int32_t x, std::int32_t y) {
    return (to == x && from == y) || (to == y && from == x);
  };
  if (edge.a_to >= 0) return step.b_to == step.b_from && same(step.a_to, step.a_from, edge.a_to, edge.a_from);
  return step.a_to == step.a_from && same(step.b_to, step.b_from, edge.b_to, edge.b_from);
}

bool same_point(const VertexPair& x, const VertexPair& y) { return x.a == y.a && x.b == y.b; }

class PortalSearch {
 public:
  PortalSearch(const DirectionSigns& ray, const PortalHierarchies& hierarchies)
      : ray_(ray),
        pair_(ray.pair()),
        hierarchies_(hierarchies),
        coarse_(hierarchies.a == nullptr && std::max(pair_.a().num_vertices(), pair_.b().num_vertices()) > kLarge) {}

  /// Nothing where the line does not meet the interior of P.
  std::optional<Portal> run() {
    Portal portal;
    if (!enclose(portal.corners)) return std::nullopt;
    push_outwards(portal.corners);
    portal.support_calls = support_calls_;
    return portal;
  }

  /// `find_inside_portal`.
  std::optional<Portal> run_inside(const Vec3& direction, PortalEnds& ends) {
    Portal portal;
    PortalCorners& v = portal.corners;
    if (!start_at(ends, v)) return std::nullopt;
    bool behind = ends.known && is_behind(ends.back);
    ends.known = false;
    const PortalCorners first = v;
    if (!behind) behind = keep_if_behind(first, ends.back);
    push_outwards(v, [&] {
      ends.push(v);
      return false;
    });
    // Of P the line leaves at t > 0: the plane supports P.
    if (ray_.turn(step(v[0], v[1]), step(v[0], v[2])) <= 0 || offset_sign(v) <= 0) return std::nullopt;
    if (!behind) {
      const DirectionSigns backwards(pair_, -direction);
      PortalSearch search(backwards, hierarchies_);
      PortalCorners w = {first[0], first[2], first[1]};
      search.push_outwards(w, [&] { return keep_if_behind({w[0], w[2], w[1]}, ends.back); });
      support_calls_ += search.support_calls_;
      if (!is_behind(ends.back)) return std::nullopt;
    }
    ends.known = true;
    portal.support_calls = support_calls_;
    return portal;
  }

 private:
  /// The last of the portals that the line crosses still, or a new one. Those after it are dropped.
  bool start_at(PortalEnds& ends, PortalCorners& v) {
    if (!ends.known) ends.count = 0;
    while (ends.count > 0) {
      coarse_ = false;  // what is left to do is fine
      v = ends.portals[static_cast<std::size_t>(--ends.count)];
      if (crosses(v)) return true;
    }
    return enclose(v) && crosses(v);
  }
  /// Whether the line itself crosses the inside of the triangle, seen counter-clockwise against it.
  bool crosses(const PortalCorners& v) const {
    for (std::size_t i = 0; i < 3; ++i) {
      if (ray_.turn(point(v[i]), point(v[(i + 1) % 3])) <= 0) return false;
    }
    return true;
  }
  /// Sign of <v[0], normal>: on which side of the plane the origin lies, 1 for behind it.
  int offset_sign(const PortalCorners& v) const {
    return pair_.sign_determinant(point(v[0]), step(v[0], v[1]), step(v[0], v[2]));
  }
  bool is_behind(const PortalCorners& v) const { return crosses(v) && offset_sign(v) < 0; }
  bool keep_if_behind(const PortalCorners& v, PortalCorners& back) const {
    back = v;
    return is_behind(v);
  }

  /// A vertex of P that is extreme up to rounding, where hierarchies tell; else the one at hand.
  VertexPair start(const Vec3& direction, const VertexPair& near) const {
    if (hierarchies_.a == nullptr) return near;
    return {hierarchies_.a->support(-(pair_.pose_a().rotation().transpose() * direction)),
            hierarchies_.b->support(pair_.pose_b().rotation().transpose() * direction)};
  }

  /// A vertex of P that serves(), or the extreme one. Of large bodies one that a look into their tables finds is tried
  /// first: far from the boundary it serves as well, and no climb through memory is made.
  template <class Sign, class Serves>
  VertexPair support(const RoundedDirection& direction, const VertexPair& near, bool coarse, Sign&& sign,
                     Serves&& serves) {
    const Vec3& n = direction.vector;
    if (coarse) {
      const VertexPair s{coarse_support_vertex(pair_.a(), -(pair_.pose_a().rotation().transpose() * n)),
                         coarse_support_vertex(pair_.b(), pair_.pose_b().rotation().transpose() * n)};
      if (s.a >= 0 && s.b >= 0 && serves(s)) return s;
    }
    ++support_calls_;
    return support_exactly(pair_, direction, start(n, near), sign);
  }

  /// In the direction d x w, or against it: <edge, d x w> = det(w, edge, d). One with that sign serves where the
  /// search is coarse.
  VertexPair support_across(const PairVector& w, int sign, bool coarse) {
    const RoundedDirection direction =
        rounded_cross(sign * ray_.scaled(), 0, pair_.approximate(w), pair_.vector_error());
    return support(
        direction, {-1, -1}, coarse, [&](const PairVector& edge) { return sign * ray_.turn(w, edge); },
        [&](const VertexPair& s) { return sign * ray_.turn(w, point(s)) > 0; });
  }

  /// A triangle of vertices of P that the line crosses. In the projection along d this is the planar portal search from
  /// v[0] through the origin: v[1] to its left, v[2] to its right, and the side between them moves outwards.
  /// False when some support shows the projection of P on one side of the origin.
  bool enclose(PortalCorners& v) {
    int least = 0;
    ray_.scaled().cwiseAbs().minCoeff(&least);
    const DirectionSigns sideways(pair_, ray_.scaled().cross(Vec3::Unit(least)));  // two coordinates of d, exactly
    v[0] = support(
        {sideways.scaled(), 0}, {-1, -1}, coarse_, [&](const PairVector& edge) { return sideways.along(edge); },
        [&](const VertexPair& s) { return sideways.along(point(s)) > 0; });
    const PairVector first = PairVector::point(v[0].a, v[0].b);
    if (sideways.along(first) <= 0) return false;
    v[1] = support_across(first, 1, coarse_);
    v[2] = support_across(first, -1, coarse_);
    if (ray_.turn(first, point(v[1])) <= 0 || ray_.turn(first, point(v[2])) >= 0) return false;
    while (ray_.side(v[1], v[2]) < 0) {
      const PairVector across = step(v[1], v[2]);
      const VertexPair s = support_across(across, -1, coarse_);
      if (ray_.turn(across, point(s)) >= 0) return false;
      (ray_.side(v[0], s) > 0 ? v[1] : v[2]) = s;
    }
    // On the side itself the moved line passes inside, the line perhaps along the boundary.
    if (ray_.turn(point(v[1]), point(v[2])) == 0) {
      const PairVector across = step(v[1], v[2]);
      if (ray_.turn(across, point(support_across(across, -1, false))) >= 0) return false;
    }
    return true;
  }

  /// The support s in the normal of the triangle projects to one side of each of the three half-lines from the origin
  /// through the corners' projections; the line crosses the triangle over the side where the sign turns from - to +.
  /// `enough` may end it earlier.
  template <class Enough>
  void push_outwards(PortalCorners& v, Enough&& enough) {
    bool coarse = coarse_;
    while (!enough()) {
      const PairVector u = step(v[0], v[1]), w = step(v[0], v[2]);
      const double error = pair_.vector_error();
      const RoundedDirection normal = rounded_cross(pair_.approximate(u), error, pair_.approximate(w), error);
      // The triangle's own sides lie in its plane: no arithmetic is spent on those zeros.
      const PairVector third = step(v[1], v[2]);
      const auto beyond = [&](const VertexPair& s) {
        if (same_point(s, v[0]) || same_point(s, v[1]) || same_point(s, v[2])) return false;
        return pair_.sign_determinant(step(v[0], s), u, w) > 0;
      };
      const VertexPair s = support(
          normal, v[2], coarse,
          [&](const PairVector& edge) {
            if (is_edge(u, edge) || is_edge(w, edge) || is_edge(third, edge)) return 0;
            return pair_.sign_determinant(edge, u, w);
          },
          [&](const VertexPair& tabled) { return coarse = beyond(tabled); });
      if (!coarse && !beyond(s)) return;
      const std::array<int, 3> side{ray_.side(v[0], s), ray_.side(v[1], s), ray_.side(v[2], s)};
      for (std::size_t i = 0; i < 3; ++i) {
        if (side[i] < 0 && side[(i + 1) % 3] > 0) {
          v[(i + 2) % 3] = s;
          break;
        }
      }
    }
  }

  void push_outwards(PortalCorners& v) {
    push_outwards(v, [] { return false; });
  }

  /// Above this many vertices a climb costs several times a look into the table.
  static constexpr int kLarge = 1 << 15;

  const DirectionSigns& ray_;
  const PosedPair& pair_;
  const PortalHierarchies& hierarchies_;
  bool coarse_;  ///< vertices that are only nearly extreme are tried first
  std::int64_t support_calls_ = 0;
};

}  // namespace

Portal find_portal(const DirectionSigns& ray, const PortalHierarchies& hierarchies) {
  return *PortalSearch(ray, hierarchies).run();
}

std::optional<Portal> find_inside_portal(const DirectionSigns& ray, const Vec3& direction, PortalEnds& ends) {
  return PortalSearch(ray, {}).run_inside(direction, ends);
}

std::optional<Portal> find_line_portal(const DirectionSigns& ray) { return PortalSearch(ray, {}).run(); }

}  // namespace pd::detail

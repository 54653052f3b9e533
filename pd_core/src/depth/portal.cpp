#include "depth/portal.hpp"

#include <utility>

#include "depth/posed_support.hpp"

namespace pd::detail {

namespace {

PairVector step(const PairId& from, const PairId& to) { return PairVector::difference(from.a, from.b, to.a, to.b); }

class PortalSearch {
 public:
  explicit PortalSearch(const RaySigns& ray) : ray_(ray), pair_(ray.pair()) {}

  Portal run() {
    Portal portal;
    enclose(portal.corners);
    push_outwards(portal.corners);
    portal.support_calls = support_calls_;
    return portal;
  }

 private:
  /// In the direction d x w, or against it: <edge, d x w> = det(w, edge, d).
  PairId support_across(const PairVector& w, int sign) {
    ++support_calls_;
    const Vec3 direction = sign * ray_.scaled().cross(pair_.approximate(w));
    return support_exactly(pair_, direction, [&](const PairVector& edge) { return sign * ray_.turn(w, edge); });
  }

  /// A triangle of vertices of P that the line crosses. In the projection along d this is the planar portal search from
  /// v[0] through the origin: v[1] to its left, v[2] to its right, and the side between them moves outwards.
  void enclose(std::array<PairId, 3>& v) {
    int least = 0;
    ray_.scaled().cwiseAbs().minCoeff(&least);
    const RaySigns sideways(pair_, ray_.scaled().cross(Vec3::Unit(least)));  // two coordinates of d, exactly
    v[0] = support_exactly(pair_, sideways.scaled(), [&](const PairVector& edge) { return sideways.along(edge); });
    ++support_calls_;
    const PairVector first = PairVector::point(v[0].a, v[0].b);
    v[1] = support_across(first, 1);
    v[2] = support_across(first, -1);
    while (ray_.side(v[1], v[2]) < 0) {
      const PairId s = support_across(step(v[1], v[2]), -1);
      (ray_.side(v[0], s) > 0 ? v[1] : v[2]) = s;
    }
  }

  /// The support s in the normal of the triangle projects to one side of each of the three half-lines from the origin
  /// through the corners' projections; the line crosses the triangle over the side where the sign turns from - to +.
  void push_outwards(std::array<PairId, 3>& v) {
    for (;;) {
      const PairVector u = step(v[0], v[1]), w = step(v[0], v[2]);
      ++support_calls_;
      const PairId s = support_exactly(pair_, pair_.approximate(u).cross(pair_.approximate(w)),
                                       [&](const PairVector& edge) { return pair_.sign_determinant(edge, u, w); });
      if (pair_.sign_determinant(step(v[0], s), u, w) <= 0) return;
      const std::array<int, 3> side{ray_.side(v[0], s), ray_.side(v[1], s), ray_.side(v[2], s)};
      for (std::size_t i = 0; i < 3; ++i) {
        if (side[i] < 0 && side[(i + 1) % 3] > 0) {
          v[(i + 2) % 3] = s;
          break;
        }
      }
    }
  }

  const RaySigns& ray_;
  const PosedPair& pair_;
  std::int64_t support_calls_ = 0;
};

}  // namespace

Portal find_portal(const RaySigns& ray) { return PortalSearch(ray).run(); }

}  // namespace pd::detail

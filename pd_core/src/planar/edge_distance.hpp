/// @file
/// Distances from a point to the lines along the edges of R = P + (-Q): compared exactly, rounded exactly.
#pragma once

#include <cmath>

#include "numeric/double_double.hpp"
#include "numeric/root_sum.hpp"
#include "pd/planar/convex_depth.hpp"
#include "planar/convex_signs.hpp"

namespace pd::detail {

/// sqrt(numerator / denominator) rounded down and up.
template <class Interval>
Interval rounded_root(const Dyadic& numerator, const Dyadic& denominator) {
  if (numerator.sign() == 0) return {0, 0};
  const RootSum exact(Dyadic(0.0), 1, numerator, denominator);
  const double lower = exact.round_down();
  return {lower, exact.round_up(lower)};
}

/// The right normal of an edge, scaled to length 1 (within 4 ulp).
inline Point2 unit_normal(const PolygonEdge& e) {
  const DoubleDouble x = two_sum((*e.to)[0], -(*e.from)[0]), y = two_sum((*e.to)[1], -(*e.from)[1]);
  const double size = std::max(std::abs(x.hi), std::abs(y.hi));
  if (size < 0x1p400 && size > 0x1p-400) {  // no product overflows, and what underflows does not matter
    const DoubleDouble length = sqrt(x * x + y * y);
    return {e.sign * to_double(y / length) + 0.0, -e.sign * to_double(x / length) + 0.0};
  }
  const auto v = vector_of<Dyadic>(e);
  const Vec3DD n = unit_double_double({v[1], -v[0], Dyadic(0.0)});
  return {to_double(n.x), to_double(n.y)};
}

class DifferenceEdges {
 public:
  DifferenceEdges(const ConvexPolygon& p, const ConvexPolygon& q, const ConvexDifference& difference)
      : p_(p), q_(q), difference_(difference) {}

  [[nodiscard]] int size() const { return static_cast<int>(difference_.corners.size()); }
  [[nodiscard]] const ConvexDifference::Corner& corner(int i) const {
    return difference_.corners[static_cast<std::size_t>(i)];
  }
  [[nodiscard]] PolygonEdge edge(int i) const {
    const auto& c = corner(i);
    return c.edge_of_p ? edge_of(p_, c.p, 1) : edge_of(q_, c.q, -1);
  }
  /// 1: y strictly on the inner side of edge i's line.
  [[nodiscard]] int side(int i, const Point2& y) const {
    return side_of_edge(edge(i), p_.vertex(corner(i).p), q_.vertex(corner(i).q), y);
  }
  /// Sign of distance i - distance j. Requires y on the inner side of both or on them.
  [[nodiscard]] int compare(int i, int j, const Point2& y) const {
    if (i == j) return 0;
    return exact_sign([&]<class N>() {
      const auto [di, li] = squared<N>(i, y);
      const auto [dj, lj] = squared<N>(j, y);
      return di * lj - dj * li;
    });
  }
  /// Distance from y, within about 1e-15 of the coordinates' size.
  [[nodiscard]] double distance(int i, const Point2& y) const {
    const auto u = vector_of<double>(edge(i));
    const auto x = offset_of<double>(p_.vertex(corner(i).p), q_.vertex(corner(i).q), y);
    return (x[0] * u[1] - x[1] * u[0]) / std::sqrt(u[0] * u[0] + u[1] * u[1]);
  }

  void fill(int i, const Point2& y, PlanarDepth& out) const {
    struct Rounded {
      double lower, upper;
    };
    const auto [numerator, denominator] = squared<Dyadic>(i, y);
    const Rounded root = rounded_root<Rounded>(numerator, denominator);
    out.lower = root.lower;
    out.depth = out.upper = root.upper;
    out.normal = unit_normal(edge(i));
    const auto& c = corner(i);
    out.edge = {c.edge_of_p ? c.p : -1, c.edge_of_q ? c.q : -1, c.p, c.q};
  }

 private:
  /// Squared distance times squared length of the edge's vector, and that length.
  template <class N>
  [[nodiscard]] std::array<N, 2> squared(int i, const Point2& y) const {
    const auto u = vector_of<N>(edge(i));
    const auto x = offset_of<N>(p_.vertex(corner(i).p), q_.vertex(corner(i).q), y);
    const N area = x[0] * u[1] - x[1] * u[0];
    return {area * area, u[0] * u[0] + u[1] * u[1]};
  }

  const ConvexPolygon& p_;
  const ConvexPolygon& q_;
  const ConvexDifference& difference_;
};

}  // namespace pd::detail

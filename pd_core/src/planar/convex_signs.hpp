/// @file
/// Signs on the edges and vertices of two convex polygons, exact on the stored numbers.
#pragma once

#include <array>
#include <cmath>

#include "numeric/estimate.hpp"
#include "pd/planar/convex_polygon.hpp"

namespace pd::detail {

inline int next_vertex(const ConvexPolygon& p, int i) { return i + 1 == p.num_vertices() ? 0 : i + 1; }
inline int previous_vertex(const ConvexPolygon& p, int i) { return i == 0 ? p.num_vertices() - 1 : i - 1; }

/// An edge of P from vertex i, or of -Q.
struct PolygonEdge {
  const Point2* from;
  const Point2* to;
  double sign = 1;  ///< -1: of -Q
};
inline PolygonEdge edge_of(const ConvexPolygon& p, int i, double sign) {
  return {&p.vertex(i), &p.vertex(next_vertex(p, i)), sign};
}

template <class N>
std::array<N, 2> vector_of(const PolygonEdge& e) {
  const N s(e.sign);
  return {s * (N((*e.to)[0]) - N((*e.from)[0])), s * (N((*e.to)[1]) - N((*e.from)[1]))};
}

/// Sign of value where it lies beyond the rounding of products of `size`, their factors rounded a few times; else 0.
inline int settled_sign(double value, double size) {
  const double air = 0x1p-48 * size + 0x1p-1060;
  return value > air ? 1 : (value < -air ? -1 : 0);
}
inline Point2 rounded_vector(const PolygonEdge& e) {
  return {e.sign * ((*e.to)[0] - (*e.from)[0]), e.sign * ((*e.to)[1] - (*e.from)[1])};
}

/// Sign of the turn from one edge to another.
inline int turn(const PolygonEdge& e, const PolygonEdge& f) {
  const Point2 a = rounded_vector(e), b = rounded_vector(f);
  const double one = a[0] * b[1], two = a[1] * b[0];
  if (const int sign = settled_sign(one - two, std::abs(one) + std::abs(two)); sign != 0) return sign;
  return exact_sign([&]<class N>() {
    const auto u = vector_of<N>(e), v = vector_of<N>(f);
    return u[0] * v[1] - u[1] * v[0];
  });
}
/// Sign of <edge, d>.
inline int along(const PolygonEdge& e, const Point2& d) {
  return exact_sign([&]<class N>() {
    const auto u = vector_of<N>(e);
    return u[0] * N(d[0]) + u[1] * N(d[1]);
  });
}

/// p - q - y.
template <class N>
std::array<N, 2> offset_of(const Point2& p, const Point2& q, const Point2& y) {
  return {N(p[0]) - N(q[0]) - N(y[0]), N(p[1]) - N(q[1]) - N(y[1])};
}
/// <p - q - y, d>, rounded, and its exact sign.
struct SignedOffset {
  double value;
  int sign;
};
inline SignedOffset offset_along(const Point2& p, const Point2& q, const Point2& y, const Point2& d) {
  double value = 0, size = 0;
  for (std::size_t k = 0; k < 2; ++k) {
    value += (p[k] - q[k] - y[k]) * d[k];
    size += (std::abs(p[k]) + std::abs(q[k]) + std::abs(y[k])) * std::abs(d[k]);
  }
  if (const int sign = settled_sign(value, size); sign != 0) return {value, sign};
  return {value, exact_sign([&]<class N>() {
            const auto x = offset_of<N>(p, q, y);
            return x[0] * N(d[0]) + x[1] * N(d[1]);
          })};
}
/// Side of the line along an edge through p - q on which y lies: 1 left, that is inside.
inline int side_of_edge(const PolygonEdge& e, const Point2& p, const Point2& q, const Point2& y) {
  return exact_sign([&]<class N>() {
    const auto u = vector_of<N>(e);
    const auto x = offset_of<N>(p, q, y);
    return x[0] * u[1] - x[1] * u[0];
  });
}

/// 0 for directions at an angle in (-90, 90] degrees, 1 for the others: a polygon's edges from its lexicographically
/// least vertex on come in the order of (half, turn).
inline int half_of(const PolygonEdge& e) {
  for (std::size_t k = 0; k < 2; ++k) {
    const double a = (*e.from)[k], b = (*e.to)[k];
    if (a != b) return (b > a) == (e.sign > 0) ? 0 : 1;
  }
  return 1;
}

}  // namespace pd::detail

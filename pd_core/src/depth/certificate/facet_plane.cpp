#include "depth/certificate/facet_plane.hpp"

#include <cmath>
#include <cstdint>

#include "numeric/fused_products.hpp"
#include "numeric/unit_roundoff.hpp"

namespace pd::detail {

namespace {

/// What a facet's plane is made of: its vectors' and its normal's 1-norms (n = u x v), the square of |n|, and n and
/// <p, n> over |n|.
struct PlaneParts {
  double of_u, of_v, of_p, of_n;
  double squared;
  FourDoubleDoubles over_length;
};

template <class P>
PD_INLINE double norm1(const DoubleDoubleLanesBy<P>& v) {
  return std::abs(v.hi[0]) + std::abs(v.hi[1]) + std::abs(v.hi[2]);
}

/// Of the first three lanes.
template <class P>
PD_INLINE DoubleDouble sum(const DoubleDoubleLanesBy<P>& v) {
  return DoubleDouble{v.hi[0], v.lo[0]} + DoubleDouble{v.hi[1], v.lo[1]} + DoubleDouble{v.hi[2], v.lo[2]};
}

template <class P>
PD_INLINE void measure_plane(const TurnedSum (&sums)[3], PlaneParts& out) {
  DoubleDoubleLanesBy<P> turned[3], n, products;
  for (int i = 0; i < 3; ++i) add_up(turned[i], sums[i]);
  const auto& [u, v, p] = turned;
  cross(n, u, v);
  out.of_u = norm1(u);
  out.of_v = norm1(v);
  out.of_p = norm1(p);
  out.of_n = norm1(n);
  multiply(products, n, n);
  const DoubleDouble squared = sum(products);
  multiply(products, p, n);
  const DoubleDouble offset = sum(products);
  out.squared = squared.hi;
  n.hi[3] = offset.hi;
  n.lo[3] = offset.lo;
  spread(products, root<P>(squared));
  divide(n, n, products);
  store(out.over_length, n);
}

/// Where the facet's edges lie in the coordinate plane across axis k, exactly, and the point's height over it is exact:
/// sets the plane. No other sign than the normal's need be known.
bool set_axis(const PosedPair& pair, const FacetOfDifference& facet, int k, double sign, FacetPlane& plane) {
  DoubleDouble u, v, p;
  if (!pair.exact_coordinate(facet.u, k, u) || u.hi != 0) return false;
  if (!pair.exact_coordinate(facet.v, k, v) || v.hi != 0) return false;
  if (!pair.exact_coordinate(facet.point(), k, p)) return false;
  plane = plane_across_axis(k, sign, p);
  return true;
}

/// Aligned boxes, and ones turned about an axis, before anything is measured.
enum class Alignment : std::uint8_t { none, found, open };
Alignment align_with_axis(const PosedPair& pair, const FacetOfDifference& facet, FacetPlane& plane) {
  const Vec3 u = pair.approximate(facet.u), v = pair.approximate(facet.v);
  const double e = pair.vector_error();
  for (int k = 0; k < 3; ++k) {
    // What is zero is computed as no more than its error.
    if (std::abs(u[k]) > e || std::abs(v[k]) > e) continue;
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    const double normal = u[i] * v[j] - u[j] * v[i];
    // The errors of the factors, of two products and of a difference.
    const double su = std::abs(u[i]) + std::abs(u[j]) + 2 * e, sv = std::abs(v[i]) + std::abs(v[j]) + 2 * e;
    const double error = (e * (su + sv) + 4 * kUnitRoundoff * su * sv) * (1 + 16 * kUnitRoundoff) + 0x1p-900;
    if (!(std::abs(normal) > error)) return Alignment::open;
    return set_axis(pair, facet, k, normal > 0 ? 1 : -1, plane) ? Alignment::found : Alignment::open;
  }
  return Alignment::none;
}

/// The same once the normal is measured.
void snap_to_axis(const PosedPair& pair, const FacetOfDifference& facet, FacetPlane& plane) {
  const double unit[3] = {plane.unit.x.hi, plane.unit.y.hi, plane.unit.z.hi};
  for (int k = 0; k < 3; ++k) {
    if (!(std::abs(unit[k]) > 0.5)) continue;
    set_axis(pair, facet, k, unit[k] > 0 ? 1 : -1, plane);
    return;
  }
}

}  // namespace

FacetPlane plane_across_axis(int axis, double sign, const DoubleDouble& coordinate) {
  FacetPlane plane;
  plane.unit = {{axis == 0 ? sign : 0, 0}, {axis == 1 ? sign : 0, 0}, {axis == 2 ? sign : 0, 0}};
  plane.distance = sign > 0 ? coordinate : -coordinate;
  plane.distance_error = 0;
  plane.axis = axis;
  return plane;
}

bool set_axis_plane(const PosedPair& pair, const PairVector& point, int axis, FacetPlane& plane) {
  DoubleDouble height;
  if (!pair.exact_coordinate(point, axis, height) || height.hi == 0) return false;
  plane = plane_across_axis(axis, height.hi > 0 ? 1 : -1, height);
  return true;
}

FacetPlane measure_facet(const PosedPair& pair, const FacetOfDifference& facet) {
  FacetPlane plane;
  const bool may_align = pair.doubles_rotate() || pair.has_an_own_coordinate();
  const Alignment aligned = may_align ? align_with_axis(pair, facet, plane) : Alignment::none;
  if (aligned == Alignment::found) return plane;
  const TurnedSum sums[3] = {pair.turned(facet.u), pair.turned(facet.v), pair.turned(facet.point())};
  PlaneParts found;
  with_products([&](auto products) __attribute__((always_inline)) { measure_plane<decltype(products)>(sums, found); });
  const double e = pair.vector_error_dd();
  const double su = found.of_u, sv = found.of_v, sp = found.of_p, sn = found.of_n;
  // Each coordinate of n: the errors of its two factors, then of two products and a difference.
  const double normal_error = (e * (su + sv + 2 * e) + 8 * kUdd * su * sv) * (1 + 16 * kUnitRoundoff) + 0x1p-900;
  const double length = std::sqrt(found.squared);
  if (!(length > 4 * normal_error)) return plane;
  plane.unit = vector_of(found.over_length);
  plane.distance = found.over_length[3];
  // distance = N / |n|: dN / |n| + |distance| d|n| / |n|, both over the least possible |n|; the operations' own
  // rounding last. A coordinate of the unit normal likewise, with |unit| <= 1. Largest error / bound that
  // `bound_ratios` found: 0.001 of either; the bound of the points that they are made of has most of it in hand.
  const double least = length * (1 - 8 * kUnitRoundoff) - 2 * normal_error;
  const double product = sp * normal_error + sn * e + 3 * e * normal_error + 16 * kUdd * sp * sn;
  const double magnitude = std::abs(to_double(plane.distance));
  plane.distance_error =
      ((product + 2 * normal_error * magnitude) / least + 64 * kUdd * magnitude) * (1 + 32 * kUnitRoundoff) + 0x1p-900;
  plane.unit_error = (3 * normal_error / least + 64 * kUdd) * (1 + 16 * kUnitRoundoff);
  if (aligned == Alignment::open) snap_to_axis(pair, facet, plane);
  return plane;
}

SquaredFacetDistance squared_distance(const PosedPair& pair, const FacetOfDifference& facet) {
  const Dyadic3 n = cross(pair.exact(facet.u), pair.exact(facet.v));
  const Dyadic offset = dot(pair.exact(facet.point()), n);
  return {offset * offset, dot(n, n)};
}

}  // namespace pd::detail

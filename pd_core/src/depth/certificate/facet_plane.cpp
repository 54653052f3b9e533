#include "depth/certificate/facet_plane.hpp"

#include <cmath>

#include "numeric/instruction_sets.hpp"
#include "numeric/unit_roundoff.hpp"

namespace pd::detail {

namespace {

double norm1(const FourDoubleDoubles& v) { return std::abs(v.hi[0]) + std::abs(v.hi[1]) + std::abs(v.hi[2]); }
DoubleDouble sum(const FourDoubleDoubles& v) { return v[0] + v[1] + v[2]; }

struct PlaneProducts {
  FourDoubleDoubles normal;          ///< n = u x v
  FourDoubleDoubles normal_squares;  ///< of its coordinates
  FourDoubleDoubles point_products;  ///< p_k n_k
};

PD_CLONES void plane_products(const FourDoubleDoubles& u, const FourDoubleDoubles& v, const FourDoubleDoubles& p,
                              PlaneProducts& out) {
  DoubleDoubleLanes left, right, normal, products;
  load(left, u);
  load(right, v);
  cross(normal, left, right);
  store(out.normal, normal);
  multiply(products, normal, normal);
  store(out.normal_squares, products);
  load(left, p);
  multiply(products, left, normal);
  store(out.point_products, products);
}

PD_CLONES void divide_all(const FourDoubleDoubles& numbers, const DoubleDouble& by, FourDoubleDoubles& out) {
  DoubleDoubleLanes numerators, divisor, quotients;
  load(numerators, numbers);
  spread(divisor, by);
  divide(quotients, numerators, divisor);
  store(out, quotients);
}

/// Aligned boxes: where the edges lie in a coordinate plane, exactly, and the point's height over it is exact. No other
/// sign than the normal's need be known.
void snap_to_axis(const PosedPair& pair, const FacetOfDifference& facet, FacetPlane& plane) {
  const DoubleDouble unit[3] = {plane.unit.x, plane.unit.y, plane.unit.z};
  for (int k = 0; k < 3; ++k) {
    if (!(std::abs(unit[k].hi) > 0.5)) continue;
    DoubleDouble u, v, p;
    if (!pair.exact_coordinate(facet.u, k, u) || u.hi != 0) return;
    if (!pair.exact_coordinate(facet.v, k, v) || v.hi != 0) return;
    if (!pair.exact_coordinate(facet.point(), k, p)) return;
    const double sign = unit[k].hi > 0 ? 1 : -1;
    plane.unit = {{k == 0 ? sign : 0, 0}, {k == 1 ? sign : 0, 0}, {k == 2 ? sign : 0, 0}};
    plane.distance = sign > 0 ? p : -p;
    plane.unit_error = plane.distance_error = 0;
    plane.axis = k;
    return;
  }
}

}  // namespace

FacetPlane measure_facet(const PosedPair& pair, const FacetOfDifference& facet) {
  FacetPlane plane;
  FourDoubleDoubles u, v, p;
  pair.approximate_dd(facet.u, u);
  pair.approximate_dd(facet.v, v);
  pair.approximate_dd(facet.point(), p);
  PlaneProducts found;
  plane_products(u, v, p, found);
  const double e = pair.vector_error_dd();
  const double su = norm1(u), sv = norm1(v), sp = norm1(p), sn = norm1(found.normal);
  // Each coordinate of n: the errors of its two factors, then of two products and a difference.
  const double normal_error = (e * (su + sv + 2 * e) + 8 * kUdd * su * sv) * (1 + 16 * kUnitRoundoff) + 0x1p-900;
  const DoubleDouble squared = sum(found.normal_squares);
  const double length = std::sqrt(squared.hi);
  if (!(length > 4 * normal_error)) return plane;
  const DoubleDouble offset = sum(found.point_products);
  found.normal.hi[3] = offset.hi;
  found.normal.lo[3] = offset.lo;
  FourDoubleDoubles quotients;
  divide_all(found.normal, sqrt(squared), quotients);
  plane.unit = vector_of(quotients);
  plane.distance = quotients[3];
  // distance = N / |n|: dN / |n| + |distance| d|n| / |n|, both over the least possible |n|; the operations' own
  // rounding last. A coordinate of the unit normal likewise, with |unit| <= 1. Largest error / bound that
  // `bound_ratios` found: 0.001 of either; the bound of the points that they are made of has most of it in hand.
  const double least = length * (1 - 8 * kUnitRoundoff) - 2 * normal_error;
  const double product = sp * normal_error + sn * e + 3 * e * normal_error + 16 * kUdd * sp * sn;
  const double magnitude = std::abs(to_double(plane.distance));
  plane.distance_error =
      ((product + 2 * normal_error * magnitude) / least + 64 * kUdd * magnitude) * (1 + 32 * kUnitRoundoff) + 0x1p-900;
  plane.unit_error = (3 * normal_error / least + 64 * kUdd) * (1 + 16 * kUnitRoundoff);
  if (pair.doubles_rotate()) snap_to_axis(pair, facet, plane);
  return plane;
}

SquaredFacetDistance squared_distance(const PosedPair& pair, const FacetOfDifference& facet) {
  const Dyadic3 n = cross(pair.exact(facet.u), pair.exact(facet.v));
  const Dyadic offset = dot(pair.exact(facet.point()), n);
  return {offset * offset, dot(n, n)};
}

}  // namespace pd::detail

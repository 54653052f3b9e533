#include "depth/certificate/facet_plane.hpp"

#include <cmath>

#include "numeric/unit_roundoff.hpp"

namespace pd::detail {

namespace {

constexpr double kUdd = 0x1p-104;  ///< relative error unit of double-double operations, each < 5u^2 < 2 kUdd

double norm1(const Vec3DD& v) { return std::abs(v.x.hi) + std::abs(v.y.hi) + std::abs(v.z.hi); }

}  // namespace

FacetPlane measure_facet(const PosedPair& pair, const FacetOfDifference& facet) {
  FacetPlane plane;
  const Vec3DD u = pair.approximate_dd(facet.u), v = pair.approximate_dd(facet.v);
  const Vec3DD p = pair.approximate_dd(facet.point());
  const Vec3DD n = cross(u, v);
  const double e = pair.vector_error_dd();
  const double su = norm1(u), sv = norm1(v), sp = norm1(p), sn = norm1(n);
  // Each coordinate of n: the errors of its two factors, then of two products and a difference.
  const double normal_error = (e * (su + sv + 2 * e) + 8 * kUdd * su * sv) * (1 + 16 * kUnitRoundoff) + 0x1p-900;
  const DoubleDouble squared = dot(n, n);
  const double length = std::sqrt(squared.hi);
  if (!(length > 4 * normal_error)) return plane;
  const DoubleDouble root = sqrt(squared);
  plane.unit = {n.x / root, n.y / root, n.z / root};
  plane.distance = dot(p, n) / root;
  // distance = N / |n|: dN / |n| + |distance| d|n| / |n|, both over the least possible |n|; the operations' own
  // rounding last. A coordinate of the unit normal likewise, with |unit| <= 1. Largest error / bound that
  // `bound_ratios` found: 0.001 of either; the bound of the points that they are made of has most of it in hand.
  const double least = length * (1 - 8 * kUnitRoundoff) - 2 * normal_error;
  const double product = sp * normal_error + sn * e + 3 * e * normal_error + 16 * kUdd * sp * sn;
  const double magnitude = std::abs(to_double(plane.distance));
  plane.distance_error =
      ((product + 2 * normal_error * magnitude) / least + 64 * kUdd * magnitude) * (1 + 32 * kUnitRoundoff) + 0x1p-900;
  plane.unit_error = (3 * normal_error / least + 64 * kUdd) * (1 + 16 * kUnitRoundoff);
  return plane;
}

SquaredFacetDistance squared_distance(const PosedPair& pair, const FacetOfDifference& facet) {
  const Dyadic3 n = cross(pair.exact(facet.u), pair.exact(facet.v));
  const Dyadic offset = dot(pair.exact(facet.point()), n);
  return {offset * offset, dot(n, n)};
}

}  // namespace pd::detail

/// @file
/// The facets of P = B + (-A) for two boxes: P is a zonotope with six generators, whose facets' normals are the cross
/// products of pairs of them, fifteen up to sign, and h_P(n) = <c, n> + sum |<g, n>| for every n.
///
/// Compiled for several instruction sets; every lane on its own: the same bits on each.
#pragma once

namespace pd::detail {

/// Generators (half edges) of P as arrays: three of one body, the first once more, the second once more, and room.
struct BoxGenerators {
  double x[8], y[8], z[8];
  double length[8];  ///< upper bounds
};
inline constexpr int kGeneratorsRead = 5;  ///< the rest is room: kernels read four lanes from the first or second on

struct BoxAxesErrors {
  double turn;  ///< of a distance, times the inverse sine of the generators' angle
  double sine;  ///< sines below this are rounding: such pairs are left out
};

struct NearestBoxAxis {
  double key;        ///< least of sign * square of the facets' distances
  double lower_key;  ///< the same of distances less their `turn` error
  int axis;  ///< 4 * block + lane: block 0 of A (edges lane, lane + 1), 1 of B, 2 + i of edge i of A and lane of B
  double slivers;  ///< sum over pairs left out of the shorter generator's length
};

/// The generators that heights are summed over, and the directions, parallel to them, whose products are normals.
struct BoxEdges {
  const BoxGenerators& generators;
  const BoxGenerators& directions;
};

/// The same for every axis on its own, at 4 * block + lane (lane 3 is room); infinity for pairs left out.
inline constexpr int kBoxAxisSlots = 20;
struct BoxAxisKeys {
  double key[kBoxAxisSlots];
  double lower_key[kBoxAxisSlots];
};
void box_axis_keys(const BoxEdges& a, const BoxEdges& b, const double (&c)[3], const BoxAxesErrors& errors,
                   BoxAxisKeys& out);

/// Distances of the facets' planes from the origin, `c` the centre of P. A pair of parallel generators spans none.
NearestBoxAxis nearest_box_axis(const BoxEdges& a, const BoxEdges& b, const double (&c)[3],
                                const BoxAxesErrors& errors);

}  // namespace pd::detail

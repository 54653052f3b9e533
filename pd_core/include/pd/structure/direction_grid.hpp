/// @file
/// Finite sets of directions that cover the unit sphere: every direction is within the covering radius of one of them.
///
/// A grid for a relative error delta has covering radius arccos(1 / (1 + delta)). Then a convex surface around the
/// origin, at distance pi along the nearest grid direction's neighbour, is met within (1 + delta) pi along the grid.
/// ([A] Lemma 3.1, whose sqrt(delta) is a bound of this arc cosine's first term only).
///
/// [A] Agarwal, Guibas, Har-Peled, Rabinovitch, Sharir, "Penetration depth of two convex polytopes in 3D", 2000.
#pragma once

#include <cstdint>
#include <vector>

#include "pd/numeric/expected.hpp"
#include "pd/numeric/vector.hpp"

namespace pd {

enum class GridKind : std::uint8_t {
  /// [A] section 3, step 1: equal steps in latitude and (of twice the size) in longitude; about 6.2 / delta directions
  /// for the covering radius above, 12.3 / delta for the paper's sqrt(delta).
  latitude_longitude,
  /// Icosahedron, its faces cut into f^2 triangles with corners weighted by sines; 2.7 / delta directions (2.66 in the
  /// limit; 2.42 is the least that any covering can have).
  geodesic,
};

enum class GridExtent : std::uint8_t {
  sphere,
  hemisphere,  ///< covers every direction up to its sign
};

struct DirectionGrid {
  std::vector<Vec3> directions;  ///< unit up to rounding
  double cosine = 0;             ///< certified: the covering radius is at most arccos(cosine)
};

/// A grid with 1 / cosine <= 1 + delta. The same bits on every machine.
///
/// Proof of the geodesic radius. Let x be a direction in the cone of a triangle with corners v_i on the sphere. Let
/// x' = sum w_i v_i be the point where it meets the triangle's plane (w_i >= 0, sum 1). Then sum w_i <v_i, x> = <x', x>
/// = |x'|, so that some <v_i, x> is at least |x'|, and |x'| at least the distance of the plane from the origin:
/// `cosine` is the least such distance. Latitude and longitude: the metric ds^2 = dphi^2 + sin^2(phi) dtheta^2 is at
/// most the plane one, so half a cell's diagonal bounds the distance to its nearest corner.
///
/// @param delta  in (0, 1].
/// @return ErrorCode::bad_value ("delta"), or limit_exceeded when more than `max_directions`, or than 2^30, are
/// needed.
/// Time and space O(1 / delta).
[[nodiscard]] Expected<DirectionGrid> direction_grid(GridKind kind, double delta,
                                                     GridExtent extent = GridExtent::sphere,
                                                     std::int64_t max_directions = std::int64_t{1} << 24);

}  // namespace pd

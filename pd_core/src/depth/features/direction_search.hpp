/// @file
/// Whether one direction alone separates two bodies at the least depth: a search of the sphere of directions.
#pragma once

#include "depth/features/near_faces.hpp"

namespace pd::detail {

/// A cone of directions about a unit vector that need no search.
struct ExcludedCone {
  Vec3 axis;
  double chord;  ///< |u - axis| of the unit vectors u at its rim: the angle in radians where that is small
};

/// The chord of the cone about a facet's normal in which P is deeper than `limit`, as the facet alone shows, or the one
/// of `reach`. With a disc of radius r of P's boundary at distance s along the normal, h_P at the angle phi from it is
/// at least s cos(phi) + r sin(phi).
/// @return reach where the disc does not show it for all angles from `reach` on.
[[nodiscard]] double cone_of_disc(double distance, double disc, double limit, double reach);

/// Whether h_P(n) <= limit for some unit n outside the cone, P = b - a. A spherical triangle is dropped where the
/// points of P that are extreme in its corners, or one between two of them, show h_P > limit on all of it; else it is
/// cut in four. Deterministic. Requires a cone of less than a right angle.
/// @param supports  counted up.
/// @return true also where 2e5 triangles did not suffice, or one shrank to 1e-14 radians.
[[nodiscard]] bool another_direction_within(const PosedCore& a, const PosedCore& b, const ExcludedCone& cone,
                                            double limit, std::int64_t& supports);

}  // namespace pd::detail

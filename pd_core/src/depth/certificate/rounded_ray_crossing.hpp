/// @file
/// Where a ray crosses a facet's plane of P, rounded from double-double: the bits that exact numbers would give, or
/// nothing.
#pragma once

#include <array>
#include <optional>

#include "depth/certificate/facet_plane.hpp"
#include "depth/difference/direction_signs.hpp"

namespace pd::detail {

struct RoundedRayCrossing {
  double lower;  ///< neighbours (or equal): lower <= length along the ray <= upper
  double upper;
  double depth;      ///< the nearer one
  Vec3 normal;       ///< the exact one's coordinates truncated, then made unit
  FacetPlane plane;  ///< its unit normal only
};

/// @param corners  of the plane, counter-clockwise seen against the ray.
/// @return nothing where the error bound leaves any of these bits open (a coordinate of the normal that is 0, a length
/// that is a double or half way between two), or where the ray does not cross at t > 0.
[[nodiscard]] std::optional<RoundedRayCrossing> rounded_ray_crossing(const DirectionSigns& ray,
                                                                     const std::array<VertexPair, 3>& corners);

}  // namespace pd::detail

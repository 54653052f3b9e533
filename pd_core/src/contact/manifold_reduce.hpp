/// @file
/// Four of many contact points: as many as a solver takes, spread as far as they go.
#pragma once

#include <cstddef>
#include <vector>

#include "contact/manifold_clip.hpp"
#include "pd/contact/manifold.hpp"

namespace pd::detail {

/// Of the points as deep as the deepest within `noise`, one that stays the same from frame to frame.
/// @param flat  the points across the normal.
[[nodiscard]] std::size_t deepest_point(const std::vector<ContactPoint>& points, const std::vector<Vec2>& flat,
                                        double deepest, double noise);

/// Keeps four of the points (at least four there): `first`, the farthest from it, and the two that span most area to
/// either side.
void reduce_to_four(std::vector<ContactPoint>& points, std::vector<Vec2>& flat, std::size_t first);

}  // namespace pd::detail

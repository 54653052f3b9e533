/// @file
/// Which spheres of a hull of spheres count.
#pragma once

#include <vector>

#include "pd/shape/sphere_hull.hpp"

namespace pd::detail {

/// Sorts the spheres, drops repeated ones and those that lie inside the hull of the others by more than 2^-40 of its
/// size, as far as a budget of 2^18 sums a sphere shows it. Others are the same hull, only slower.
///
/// Sphere i lies inside where every direction d has a sphere j with <c_j - c_i, d> + (r_j - r_i) |d| > 0. The
/// directions are the points of a cube, which is cut into cells until one j does for all of a cell.
[[gnu::cold]] void keep_outer_spheres(std::vector<Sphere>& spheres);

}  // namespace pd::detail

/// @file
/// A certified bracket of the depth of two solids: the translations near zero are covered by balls in which A overlaps
/// B.
///
/// A point that lies at a distance r from A's surface, inside, and s from B's certifies a ball of such translations: A
/// moved by less than r + s still overlaps B, since each solid holds a ball about the point, and the two balls meet. So
/// does a point at a distance s outside of B, for less than r - s: the point of B that is nearest to it stays in A.
/// Cubes of translations are looked at from the nearest on; one that no ball covers is halved along each axis. The
/// nearest cube that is left bounds the depth from below. Where no ball is found, the cube's middle is tried as a
/// translation that separates, exactly.
///
/// If a share delta of the depth is asked for, some delta^-1 cubes are looked at where the placements that separate
/// begin at a plane, and delta^-2 where they begin at a sphere about zero. Sharp edges that cross each other cost
/// more: balls near them are small.
#pragma once

#include "solid/overlap_depth.hpp"

namespace pd::detail {

/// Narrows the bracket of `out`, whose lower end may be 0, until it reaches the share of the settings or they allow no
/// more points.
/// @return whether the translation is a better one; normal, depth and upper end then fit to it.
bool narrow_by_cover(const OverlapQuestion& question, SolidDepth& out);

}  // namespace pd::detail

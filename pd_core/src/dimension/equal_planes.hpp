/// @file
/// Facets of a hull that are one facet up to rounding.
#pragma once

#include <cstdint>
#include <vector>

#include "dimension/radial_hull.hpp"

namespace pd::dimension::detail {

/// Per facet of the hull: the first of the connected facets with the same plane, or -1 for a dead facet. Of the polar
/// body, planes are vertices.
std::vector<std::int32_t> merge_equal_planes(const RadialHull& hull);

}  // namespace pd::dimension::detail

/// @file
/// Where a facet of one small solid and a face of the other meet that lie in one plane once A has left B. Their facet
/// of P is the sum of both faces, so that the point below the origin may lie beyond the one face moved by each corner
/// of the other.
#pragma once

#include <optional>

#include "depth/difference/polytope_difference.hpp"

namespace pd::detail {

/// A point that the faces have in common when A is moved by `height` along `normal` (unit), in the common axes,
/// relative to B's translation; it lies in each of them up to 64u of the reach. Nothing where they have none, or where
/// neither is a facet.
/// Requires solids of at most eight vertices, supports that are prepared, and a plane across `normal` that supports P
/// at `height`. Time: O(corners of A's face times corners of B's), no allocation.
[[nodiscard]] std::optional<Vec3> meeting_point(const PolytopeDifference& difference, const Vec3& normal,
                                                double height);

}  // namespace pd::detail

/// @file
/// The ball about the origin of its frame that holds a core.
#pragma once

#include "pd/shape/convex_shape.hpp"

namespace pd::detail {

/// Largest distance of a point of the core from the origin of its frame, of a polytope rounded up; elsewhere within
/// 2^-50 of itself.
[[nodiscard]] double core_radius(const ConvexShape::Core& core);

}  // namespace pd::detail

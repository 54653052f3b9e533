/// @file
/// From checked points to a hull in memory.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "pd/shape/convex_polytope.hpp"

namespace pd::detail {

/// Refuses an empty set, one of more than 3e8 points, numbers that are not finite and numbers above kMaxCoordinate; the
/// first offence is named.
[[nodiscard]] std::optional<Error> refuse_points(std::span<const Vec3> points);

/// The hull of points that `refuse_points` lets pass.
/// @param caller_ids  stand in the result for the positions in `points`; empty: the positions themselves.
[[nodiscard]] ConvexPolytope build_hull(std::span<const Vec3> points, std::span<const std::int32_t> caller_ids = {});

}  // namespace pd::detail

/// @file
/// Lines against every level of a hierarchy: [D] Lemmas 5.2 and 5.3 and Corollary 5.5. (Lemma 5.4, a plane, is
/// PolyhedralHierarchy::support.)
#pragma once

#include <cstdint>

#include "pd/numeric/expected.hpp"
#include "pd/shape/convex_polytope.hpp"
#include "pd/structure/polyhedral_hierarchy.hpp"
#include "pd/structure/twin_hierarchy.hpp"

namespace pd {

/// The times t at which a small body moved by t d / |d| meets a level's polytope: an interval.
struct LevelCrossing {
  bool meets = false;  ///< the moved body meets the interior
  /// Exact for level 0: neighbouring doubles round the exact values, or equal; of either sign.
  double enter_lower = 0, enter_upper = 0;
  double leave_lower = 0, leave_upper = 0;
  std::int64_t steps = 0;        ///< vertices or facets evaluated and signs asked for
  std::int64_t certificate = 0;  ///< of twin hierarchies: facets looked at in the final check, by their degrees
  std::int32_t repairs = 0;      ///< of twin hierarchies: scans of all of a level's facets, where rounding hid the way
};

/// A point gives the line of Lemma 5.2 (its first and last intersection), a segment the translating line of Lemma 5.3
/// as far as it reaches, any body of at most 9 vertices Corollary 5.5. Hierarchy and small body are in one frame.
///
/// Departure: [D] answers these by the outer hierarchies of the inner levels; here the inner hierarchy is descended
/// with the small body as a fixed cap (src/depth/rays/hierarchy_descent.hpp), which needs no second structure for any
/// level. The overload below asks the outer ones.
///
/// @param level  0 (the polytope itself) to levels().size() - 1. At coarser levels than 0 choices between planes within
///               rounding of each other are made in doubles, as no check against all edges of the level follows.
/// @return ErrorCode::unsupported for an outer hierarchy, out_of_range ("level"), limit_exceeded (more than 9 vertices,
///         "small"), non_finite or zero_direction ("direction").
/// Time O(log n).
[[nodiscard]] Expected<LevelCrossing> crossing_of_level(const PolyhedralHierarchy& hierarchy, int level,
                                                        const ConvexPolytope& small, const Vec3& direction);

/// Lemma 5.2 as it stands: where the line {point + t direction / |direction|} enters and leaves a level's polytope, by
/// that level's outer hierarchy. Exact for every level: the two facets that the descent ends with are checked by exact
/// signs against all of their neighbours, or against each other where the line misses.
///
/// @param point  finite.
/// @return ErrorCode::out_of_range ("level"), non_finite ("point", "direction"), zero_direction ("direction").
/// Time O(log n), the two facets' degrees, and a scan of all facets where rounding hid the way (`repairs`).
[[nodiscard]] Expected<LevelCrossing> crossing_of_level(const TwinHierarchy& twin, int level, const Vec3& point,
                                                        const Vec3& direction);

}  // namespace pd

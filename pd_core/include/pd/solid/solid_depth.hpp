/// @file
/// Class, distance and depth of two solids that closed meshes bound, or of a solid and a convex shape.
///
/// The class is exact on the stored numbers and poses. Solids are overlapping when their interiors meet, touching when
/// they have boundary points alone in common, separated else. A slot of zero width belongs to the forbidden placements
/// (`compound_depth.hpp`): no depth is told by it, and two solids in such a place are touching, in a seat (`is_seat`).
#pragma once

#include <cstdint>

#include "pd/depth/depth_answer.hpp"
#include "pd/numeric/expected.hpp"
#include "pd/shape/convex_shape.hpp"
#include "pd/shape/mesh_solid.hpp"
#include "pd/shape/pose.hpp"

namespace pd {

class Scratch;

/// A solid and where it stands. Refers to the solid: it must outlive the query.
struct PosedSolid {
  const MeshSolid* solid;
  Pose pose;
};

struct SolidSettings {
  /// The bracket of the depth closes to upper <= (1 + delta) lower; in (0, 1].
  double delta = 1e-2;
  /// The budget of solids that have too many convex parts: points whose distances from both surfaces are asked, some 5
  /// to 15 microseconds each. Where they do not suffice, the bracket is as wide as it is by then.
  std::int64_t max_points = 500'000;
};

struct SolidStatistics {
  std::int64_t triangle_pairs = 0;  ///< pairs of triangles that were looked at
  std::int64_t parts_a = 0;         ///< convex parts that a depth was told by; 0: none
  std::int64_t parts_b = 0;
  std::int64_t points = 0;  ///< whose distances from both surfaces were asked
};

/// The answer of `penetration_depth`, and the faces of the callers' meshes that give it; -1: unknown.
struct SolidDepth : PenetrationDepth {
  std::int32_t face_a = -1;
  std::int32_t face_b = -1;
  /// Class and depth are those of the stored numbers; upper - lower is rounding.
  bool exact = true;
  SolidStatistics work;
};

/// The class alone.
[[nodiscard]] ContactClass classify(const PosedSolid& a, const PosedSolid& b);

/// True if A fits exactly: the solids touch, and the places without an overlap have no volume around A's place. So
/// small moves without an overlap lie in a plane at most, or there are none: a peg in a hole of exactly its size, a
/// cube in a notch of exactly its width. Such a place is no way out of an overlap.
///
/// Exact on the stored numbers. Time: that of the class, for each of the sectors into which the contacts cut the
/// directions; most solids that touch ask one class, and most that fit ask none.
/// @return limit_exceeded above 4,096 sectors, and where vertices or edges that do not meet are nearer than a millionth
/// of the size.
[[nodiscard]] Expected<bool> is_seat(const PosedSolid& a, const PosedSolid& b);

/// Depth of two solids, or their distance when apart.
///
/// Separated: witnesses are points of the surfaces, `distance_lower <= exact <= distance_upper`, within 1e-12 of each
/// other relative to the distance (`bracket_reached` is false where they are not).
/// Overlapping: lower <= depth <= upper, and the stored translation separates exactly. `bracket_reached` is false where
/// upper > (1 + delta) lower.
/// Time: O(n log n) for n triangles where the solids are apart or touch. Where they overlap, a budget: unions of up to
/// 1,024 pairs of convex parts, or the points of the settings.
/// @return bad_value ("delta", "max_points").
[[nodiscard]] Expected<SolidDepth> penetration_depth(const PosedSolid& a, const PosedSolid& b, Scratch& scratch,
                                                     const SolidSettings& settings = {});

/// Depth or distance of a solid and a convex shape of any kind: curved, or swept by a margin. The solid moves.
///
/// A polytope without a margin is asked as a solid, as above. Other shapes meet the solid where they meet one of its
/// triangles, or lie inside of it: class and distance are those of the convex `penetration_depth`, as exact as there.
/// The points of the settings are the budget where the two overlap. `face_b` is -1.
/// Time: a convex query for each triangle that the shape comes near; where they overlap, some microseconds a point.
/// @return bad_value as above; not_full_dimensional for a flat polytope without a margin; out_of_range for poses
/// farther apart than numbers reach.
[[nodiscard]] Expected<SolidDepth> penetration_depth(const PosedSolid& a, const PosedShape& b, Scratch& scratch,
                                                     const SolidSettings& settings = {});

/// A shape that moves, beside a solid that stays.
[[nodiscard]] Expected<SolidDepth> penetration_depth(const PosedShape& a, const PosedSolid& b, Scratch& scratch,
                                                     const SolidSettings& settings = {});

/// The class alone. @return as `penetration_depth`
[[nodiscard]] Expected<ContactClass> classify(const PosedSolid& a, const PosedShape& b, Scratch& scratch);

}  // namespace pd

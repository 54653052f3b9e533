/// @file
/// Bodies as polygons for the eye: what a page draws of a pair. No figure rests on it.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "pd/depth/minkowski_difference.hpp"
#include "pd/shape/compound.hpp"

namespace pd::report {

/// Points and the polygons between them. Polygons are counter-clockwise from outside; of flat bodies both sides are
/// there; a segment or a point has none.
struct EyePolytope {
  std::vector<Vec3> points;
  std::vector<std::vector<std::int32_t>> polygons;
  std::vector<Vec3> normals;                       ///< of the polygons, unit
  std::vector<std::array<std::int32_t, 2>> edges;  ///< between polygons that meet at more than 10 degrees
  std::vector<int> kinds;  ///< of the polygons: 0 a facet of A, 1 a facet of B, 2 edge against edge; empty: one kind
};

/// The body where the pose puts it; each part of a compound is one. Polytopes of at most 400 vertices as they are;
/// cylinders and cones with rims of 48 corners; larger, swept and other curved ones as the hull of their supports in
/// 642 directions.
[[nodiscard]] std::vector<EyePolytope> eye_polytopes(const Compound& body, const Pose& pose);

/// B + (-A) of what `eye_polytopes` gives for each pair of parts, at most 64 pairs.
[[nodiscard]] std::vector<EyePolytope> eye_difference(const std::vector<EyePolytope>& a,
                                                      const std::vector<EyePolytope>& b);

}  // namespace pd::report

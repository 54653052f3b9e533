/// @file
/// Convex parts that cover a solid, or that lie in a solid, by cutting cells of space until their contents are nearly
/// convex.
#pragma once

#include <vector>

#include "pd/solid/convex_decomposition.hpp"
#include "solid/part_merging.hpp"

namespace pd::detail {

struct CutParts {
  std::vector<SolidPart> parts;
  std::int64_t steps = 0;
};

/// Parts that cover the solid. A cell's part is the hull of what the cell holds, and its error how far the hull reaches
/// beyond the solid.
[[nodiscard]] CutParts outer_parts(const MeshSolid& solid, const DecompositionSettings& settings);

/// Parts that lie in the solid. A cell's part is what lies below the planes of all faces in the cell, and its error the
/// largest distance of the cell's contents from the part. The hull of two parts replaces them where no face enters the
/// hull, which is decided exactly.
[[nodiscard]] CutParts inner_parts(const MeshSolid& solid, const DecompositionSettings& settings);

}  // namespace pd::detail

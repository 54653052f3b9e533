/// @file
/// A solid as few convex parts, with a certified error.
///
/// Outer parts cover the solid: every point of the solid lies in a part, and no point of a part is farther from the
/// solid than the stated error. Inner parts lie in the solid, and no point of the solid is farther from their union
/// than the stated error.
///
/// Space is cut by planes, exactly, until the hull of what a cell holds of the solid reaches no farther beyond the
/// solid than the error that was asked. A plane is one of the solid's faces or lies across an axis; the one is taken
/// that leaves the smallest hulls. Then neighbouring parts are merged while the hull of both stays within the error.
/// The number of parts is small, and not the least: to find the least number is NP-hard.
///
/// How the error is certified stands in `src/solid/hull_reach.hpp`. Planes across axes as candidates, and merging by
/// the volume that is added, are those of V-HACD; distance as a measure of concavity is that of CoACD [WLLS22]. Both
/// measure by samples, while the bound here holds for every point.
///
/// [WLLS22] Wei, Liu, Ling, Su, "Approximate convex decomposition for 3D meshes with collision-aware concavity and tree
/// search", 2022.
#pragma once

#include <cstdint>
#include <functional>

#include "pd/numeric/expected.hpp"
#include "pd/shape/compound.hpp"
#include "pd/shape/mesh_solid.hpp"

namespace pd {

struct DecompositionSettings {
  /// The most that parts may differ from the solid, in the solid's unit of length, greater than 0.
  double error = 0;
  /// False: parts cover the solid. True: parts lie in the solid.
  bool inside = false;
  std::int64_t max_parts = 4096;
  /// Work that may be spent: bounds of distances and pieces of faces, a microsecond or several each.
  std::int64_t max_steps = 20'000'000;

  /// Parts that are finished, cells that still wait to be cut, and steps so far.
  struct Progress {
    std::int64_t parts = 0;
    std::int64_t open = 0;
    std::int64_t steps = 0;
  };
  /// Called now and then while the work goes on; may be empty.
  std::function<void(const Progress&)> watch = {};
};

struct SolidDecomposition {
  /// Polytopes, each at the identity pose.
  Compound parts;
  /// Certified, rounding included: no point is farther than this.
  double error = 0;
  /// error <= DecompositionSettings::error. False where a limit ended the work: parts still cover the solid or lie in
  /// the solid, and `error` still holds.
  bool error_reached = false;
  std::int64_t steps = 0;
  double solid_volume = 0;
  double parts_volume = 0;  ///< the sum of the volumes of the parts, which may overlap
};

/// Cuts a solid into convex parts.
///
/// @return bad_value ("error") unless the error is finite and greater than 0, ("max_parts", "max_steps") below 1;
/// limit_exceeded for a solid that is thinner than rounding everywhere.
///
/// Deterministic. Time and memory grow with the solid's triangles, times the depth of the cuts, and with area / error^2
/// where hulls reach beyond the solid.
[[nodiscard]] Expected<SolidDecomposition> decompose(const MeshSolid& solid, const DecompositionSettings& settings);

}  // namespace pd

/// @file
/// A solid cut into convex parts along the planes of its faces.
///
/// The parts tile the solid. A cell of space is cut by the plane of a face, until what the cell holds of the solid is
/// convex. Cuts are exact: a corner of a part is the meeting point of three planes of faces. Where all corners are
/// doubles, as those of solids built along axes mostly are, the parts are the solid. Elsewhere corners are rounded, and
/// there are two unions: parts that lie in the solid, and parts that cover it. The gap between the two is some rounding
/// errors wide but for parts thinner than that, and as wide as a tolerance where one is given.
///
/// Why inner parts lie in the solid: let x lie in a cell below the planes of all faces there, and y in the solid and
/// the cell. If x were outside, the way from x to y would enter the solid through the front of a face. Then x would lie
/// above that face's plane. Why outer parts cover the solid: no face rises beyond the planes that bound such a part. So
/// the cell is solid beyond a plane as a whole, or empty there. The place of one point tells which, and a cell that is
/// solid there is cut once more.
#pragma once

#include <cstdint>
#include <optional>
#include <utility>

#include "pd/numeric/expected.hpp"
#include "pd/shape/compound.hpp"
#include "pd/shape/mesh_solid.hpp"

namespace pd {

struct SolidPartsLimits {
  std::int64_t parts = 512;
  /// A cell counts as convex where no face rises above the plane of another by more than this length. Inner parts stay
  /// below all planes, outer parts reach over them as far as the faces do: fewer parts, and a gap between the two.
  double tolerance = 0;
  std::int64_t polygons = 20'000;  ///< pieces of faces, cut by the planes
};

/// Immutable.
class SolidParts {
 public:
  /// @return limit_exceeded where the solid has more parts, or its faces more pieces, than `limits` allows; bad_value
  /// ("tolerance").
  static Expected<SolidParts> from_solid(const MeshSolid& solid, const SolidPartsLimits& limits = {});

  /// Lies in the solid.
  [[nodiscard]] const Compound& inner() const { return inner_; }
  /// Covers the solid.
  [[nodiscard]] const Compound& outer() const { return exact_ ? inner_ : *outer_; }
  /// Both are the solid itself.
  [[nodiscard]] bool exact() const { return exact_; }

 private:
  SolidParts(Compound inner) : inner_(std::move(inner)) {}  // NOLINT(google-explicit-constructor)

  Compound inner_;
  std::optional<Compound> outer_;
  bool exact_ = true;
};

}  // namespace pd

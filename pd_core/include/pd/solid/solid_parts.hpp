/// @file
/// A solid cut into convex parts along the planes of its faces.
///
/// The parts tile the solid. A cell of space is cut by the plane of a face, until what the cell holds of the solid is
/// convex. Cuts are exact: a corner of a part is the meeting point of three planes of faces. Where all corners are
/// doubles, as those of solids built along axes mostly are, the parts are the solid. Elsewhere corners are rounded, and
/// there are two unions: parts that lie in the solid, and parts that cover it. The gap between the two is some rounding
/// errors wide but for parts thinner than that.
#pragma once

#include <cstdint>

#include "pd/numeric/expected.hpp"
#include "pd/shape/compound.hpp"
#include "pd/shape/mesh_solid.hpp"

namespace pd {

struct SolidPartsLimits {
  std::int64_t parts = 512;
  std::int64_t polygons = 20'000;  ///< pieces of faces, cut by the planes
};

/// Immutable.
class SolidParts {
 public:
  /// @return limit_exceeded where the solid has more parts, or its faces more pieces, than `limits` allows.
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

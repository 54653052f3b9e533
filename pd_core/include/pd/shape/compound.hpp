/// @file
/// Non-convex bodies as unions of convex parts.
///
/// A part stands where its pose in the compound's frame puts it, and the compound where its own pose puts that:
/// x -> R (R_part x + t_part) + t. The composition is exact where one of the two rotations is the identity and the
/// translations combine without rounding. This is always so under the identity. It is so under any pose for parts
/// that are only translated within the compound by a vector that their vertices take exactly. A stack of boxes stays a
/// stack of boxes when it is turned. Elsewhere the composed pose is rounded, each number once, and that pose is the
/// body that all answers are about; posed alike, the same compound is always the same body.
///
/// [A] Agarwal, Guibas, Har-Peled, Rabinovitch, Sharir, "Penetration depth of two convex polytopes in 3D", 2000, open
/// problem (ii).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pd/numeric/expected.hpp"
#include "pd/shape/convex_shape.hpp"
#include "pd/shape/pose.hpp"

namespace pd {

/// Immutable once made. One convex body is a compound of one part.
class Compound {
 public:
  struct Part {
    ConvexShape shape;
    Pose pose;  ///< in the compound's frame
  };

  Compound(ConvexShape shape) : parts_{{std::move(shape), Pose()}} {}  // NOLINT(google-explicit-constructor)

  /// The union of the parts, in their order.
  /// @return ErrorCode::too_few_points ("parts") when there are none.
  static Expected<Compound> from_parts(std::vector<Part> parts);

  struct Placed;
  /// The union of compounds: their parts, one body's after the other's.
  /// @return as `from_parts`, and out_of_range ("parts[i].pose") when a composed translation passes kMaxCoordinate.
  static Expected<Compound> from_compounds(std::span<const Placed> bodies);

  /// `margin` added to that of every part: the union of the swept parts is the swept union.
  [[nodiscard]] Expected<Compound> with_margin(double margin) const;

  /// Parts that are only translated hold that translation in their vertices where it leaves them exact: vertex and
  /// facet numbers stay, the pose is then the identity.
  [[nodiscard]] const std::vector<Part>& parts() const { return parts_; }

  /// The parts in the world. They refer to the compound, which must outlive them.
  /// @return ErrorCode::out_of_range ("pose") when a composed translation passes kMaxCoordinate.
  [[nodiscard]] Expected<std::vector<PosedShape>> posed(const Pose& pose) const;

 private:
  Compound() = default;
  std::vector<Part> parts_;
};

struct Compound::Placed {
  Compound body;
  Pose pose;
};

/// A compound and where it stands. Refers to the compound: it must outlive the query.
struct PosedCompound {
  const Compound* body;
  Pose pose;
};

/// The pose x -> outer(inner(x)), rounded as said above.
/// @return ErrorCode::out_of_range when its translation passes kMaxCoordinate.
[[nodiscard]] Expected<Pose> composed(const Pose& outer, const Pose& inner);

}  // namespace pd

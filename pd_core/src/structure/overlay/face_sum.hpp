/// @file
/// One facet of P = B + (-A) as the planar Minkowski sum of a face of B and the mirror image of a face of A, and P
/// itself where it is flat.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "shape/posed_pair.hpp"
#include "structure/overlay/facet_of_difference.hpp"
#include "structure/overlay/overlay_walk.hpp"

namespace pd::detail {

/// Orientation inside the plane spanned by u and v, counter-clockwise about u x v, exact.
class InPlane {
 public:
  /// Requires u x v != 0.
  InPlane(const PosedPair& pair, const PairVector& u, const PairVector& v);

  /// Sign of <x x y, u x v> for vectors x, y of the plane: one coordinate of x x y decides.
  [[nodiscard]] int turn(const PairVector& x, const PairVector& y) const;

 private:
  const PosedPair* pair_;
  int axis_ = 0;  ///< a coordinate in which u x v is not zero
  int sign_ = 0;  ///< its sign
};

/// A face of A and a face of B whose difference is one whole facet of P (coplanar pieces of the overlay united).
struct FacePair {
  Feature on_a;
  Feature on_b;
};

/// The whole facet that a piece of the overlay belongs to, or nothing when another piece of the same facet stands for
/// it (so that a walk meets every facet of P exactly once). Exact; time of the order of the two degrees.
std::optional<FacePair> whole_facet(const OverlayWalk& walk, const OverlayPiece& piece);

/// b - a as vertex ids.
struct DifferencePoint {
  std::int32_t a;
  std::int32_t b;
  friend bool operator==(const DifferencePoint&, const DifferencePoint&) = default;
};

/// The corners of `faces` counter-clockwise about u x v, no three collinear; two for a segment, one for a point. Facets
/// must be those whose planes are parallel to u and v: of B with the outward normal u x v, of A with its opposite.
/// Time O(corners).
void sum_loop(const PosedPair& pair, const FacePair& faces, const InPlane& plane, std::vector<DifferencePoint>& loop);

/// P where it has no interior.
struct FlatDifference {
  int affine_dimension = 0;  ///< 0, 1 or 2
  FacePair faces;            ///< the two bodies themselves
  PairVector u;              ///< spans P (dimension >= 1)
  PairVector v;              ///< with u (dimension 2)
};

/// Whether P is flat, exactly. Only two flat bodies can have a flat difference.
std::optional<FlatDifference> flat_difference(const PosedPair& pair);

/// Whether the origin lies in a flat P, exactly. `loop` is a buffer.
bool contains_origin(const PosedPair& pair, const FlatDifference& flat, std::vector<DifferencePoint>& loop);

}  // namespace pd::detail

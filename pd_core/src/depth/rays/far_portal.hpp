/// @file
/// A portal that may have corners at infinity: a triangle that a given line crosses, of vertices of P = B + (-A) and of
/// up to three points z_k = -M^2 d + M g_k, M beyond all bounds, that lie behind everything and surround the line.
///
/// With a far corner the triangle's plane is taken to leading order in M: parallel to the line, over the side that the
/// other two corners make of the shadow of P along d. So the search for a shadow that covers the line's point and the
/// search for the facet where the line leaves are one.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "depth/difference/direction_signs.hpp"
#include "depth/difference/exact_support.hpp"

namespace pd::detail {

/// The plane of a portal, by its outward normal.
struct PortalPlane {
  enum class Kind : std::uint8_t {
    spanned,   ///< u x w
    parallel,  ///< d x w
    fixed,     ///< `exact`
  };
  Kind kind = Kind::fixed;
  PairVector u, w;
  Dyadic3 exact;
  RoundedDirection rounded{};
  bool of_portal = false;  ///< holds all corners of the portal that are not far
  std::size_t corner = 3;  ///< a corner in the plane that is a vertex of P; 3: none, everything is beyond
};

class FarPortal {
 public:
  /// All three corners far.
  explicit FarPortal(const DirectionSigns& ray);

  [[nodiscard]] bool is_far(std::size_t i) const { return corners_[i].a < 0; }
  [[nodiscard]] bool has_far_corner() const { return is_far(0) || is_far(1) || is_far(2); }
  [[nodiscard]] const VertexPair& corner(std::size_t i) const { return corners_[i]; }

  [[nodiscard]] PortalPlane plane() const;
  /// Sign of <edge, normal>, exact.
  [[nodiscard]] int sign(const PortalPlane& plane, const PairVector& edge) const;
  /// Whether a vertex of P lies strictly outside the plane.
  [[nodiscard]] bool beyond(const PortalPlane& plane, const VertexPair& s) const;
  /// Takes s, which lies beyond the plane, for the corner that leaves a triangle across the line.
  void replace(const VertexPair& s);

  [[nodiscard]] std::int64_t signs_asked() const { return signs_asked_; }

 private:
  /// Is this step in A or in B a side of the portal, or none at all?
  [[nodiscard]] bool is_side(const PairVector& edge) const;
  /// Is s two corners' sum less the third, vertex by vertex? Then it lies in their plane.
  [[nodiscard]] bool completes_parallelogram(const VertexPair& s) const;
  /// As DirectionSigns::side, where x may be far.
  [[nodiscard]] int side(const VertexPair& x, const VertexPair& y) const;

  const DirectionSigns& ray_;
  const PosedPair& pair_;
  std::array<Vec3, 3> around_;         ///< g_k: counter-clockwise seen against d, positively spanning across it
  std::array<VertexPair, 3> corners_;  ///< a = -1: far, and b is k
  mutable std::int64_t signs_asked_ = 0;
};

}  // namespace pd::detail

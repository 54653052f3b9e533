/// @file
/// A facet of P = B + (-A) for two solids of at most eight vertices: of a facet of one body and a vertex of the other,
/// or of two edges.
#pragma once

#include "depth/difference/polytope_difference.hpp"
#include "depth/facets/near_facets.hpp"
#include "pd/shape/pose.hpp"
#include "shape/small_gauss_map.hpp"

namespace pd::detail {

/// By the numbers of the Gauss maps; -1: none.
struct SmallPiece {
  int facet_a = -1;
  int facet_b = -1;
  int edge_a = -1;
  int edge_b = -1;
  double sign = 1;  ///< of edge of B x edge of A, to point outwards
};

/// A facet's distance errs, in units of the reach, by the turn of its normal (16u and 3u as it is stored, 9u for the
/// cofactors and 5u for their product), by the vertices and products of its height (12u) and by a root and a quotient
/// (3u). A parallelogram's lowest corner errs by 22u: its point by 10.5u, products and sums by 8u, root and quotient.
inline constexpr double kSmallPieceLowerError = 50 * kUnitRoundoff;
/// h_P(n) exceeds <s, n> of the support s by at most this: 10.5u for a point, 6u for scans that compare products,
/// 3u for the product, 2u for the length of n.
inline constexpr double kSmallPieceUpperError = 24 * kUnitRoundoff;

/// Both bodies at their poses; the difference's supports are prepared.
class SmallPieces {
 public:
  SmallPieces(const Pose& pose_a, const Pose& pose_b, const PolytopeDifference& difference);

  [[nodiscard]] const SmallGaussMap& map_a() const { return map_a_; }
  [[nodiscard]] const SmallGaussMap& map_b() const { return map_b_; }
  /// What turns facets' normals to those of -A and of B, any positive scale.
  [[nodiscard]] const Mat3& normals_a() const { return normals_a_; }
  [[nodiscard]] const Mat3& normals_b() const { return normals_b_; }

  /// Outward, of any length.
  [[nodiscard]] Vec3 normal(const SmallPiece& piece) const {
    if (piece.facet_a >= 0) return normals_a_ * difference_.a().facet_normal(piece.facet_a);
    if (piece.facet_b >= 0) return normals_b_ * difference_.b().facet_normal(piece.facet_b);
    return piece.sign * edge_b(piece.edge_b).cross(edge_a(piece.edge_a));
  }
  /// An edge of -A as a vector, and one of B.
  [[nodiscard]] Vec3 edge_a(int edge) const {
    return point(difference_.posed_a(), map_a_.from[edge]) - point(difference_.posed_a(), map_a_.to[edge]);
  }
  [[nodiscard]] Vec3 edge_b(int edge) const {
    return point(difference_.posed_b(), map_b_.to[edge]) - point(difference_.posed_b(), map_b_.from[edge]);
  }

  /// The features of the bodies that make the piece, s being its support.
  void name(const SmallPiece& piece, const DifferenceVertex& s, NearFacets& out) const;

 private:
  [[nodiscard]] static Vec3 point(const VertexArrays& v, int i) { return {v.x[i], v.y[i], v.z[i]}; }

  const PolytopeDifference& difference_;
  const SmallGaussMap& map_a_;
  const SmallGaussMap& map_b_;
  const Mat3 normals_a_;  ///< of -A
  const Mat3 normals_b_;
};

}  // namespace pd::detail

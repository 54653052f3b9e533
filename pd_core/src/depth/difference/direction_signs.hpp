/// @file
/// Exact signs that involve a posed pair and one direction given in doubles (a ray's, a query's).
#pragma once

#include "shape/posed_pair.hpp"
#include "shape/support/vertex_pair.hpp"

namespace pd::detail {

class DirectionSigns {
 public:
  /// Requires a finite direction other than zero.
  DirectionSigns(const PosedPair& pair, const Vec3& direction);

  [[nodiscard]] const PosedPair& pair() const { return *pair_; }
  /// The direction times a power of two, largest |coordinate| in [1, 2).
  [[nodiscard]] const Vec3& scaled() const { return scaled_; }
  [[nodiscard]] const Dyadic3& exact() const { return exact_; }

  /// Sign of <x, d>.
  [[nodiscard]] int along(const PairVector& x) const;
  /// Sign of det(x, y, d): which way x turns to y seen against d.
  [[nodiscard]] int turn(const PairVector& x, const PairVector& y) const;

  /// Side of the line through the origin along d on which points x -> y of P pass: the sign of det(x, y, d), and where
  /// that is 0 its sign for a line moved and turned by infinitely little,
  ///   origin + e1 o1 + e2 o2 + e3 o3, direction d + f1 r1 + f2 r2 + f3 r3, 1 >> e1 >> e2 >> e3 >> f1 >> f2 >> f3 > 0
  /// (o1 a fixed generic vector, the others coordinate axes). Moving the origin changes the determinant by
  /// -<o, (y - x) x d>; if y - x is parallel to d, turning decides. Never 0 for two different points.
  [[nodiscard]] int side(const VertexPair& x, const VertexPair& y) const;
  /// `side(M g, y)` for M beyond all bounds: the sign of det(g, y, d), and of det(g, y - o, d) where that is 0.
  /// Requires g not parallel to d. Never 0.
  [[nodiscard]] int side_of_far(const Vec3& g, const VertexPair& y) const;

 private:
  const PosedPair* pair_;
  Vec3 scaled_;
  Dyadic3 exact_;
};

}  // namespace pd::detail

/// @file
/// Ways out for a piece of a union from the body that touches it, along a given direction, and their contact points.
#pragma once

#include "pd/contact/farthest_point.hpp"
#include "pd/contact/manifold.hpp"
#include "union_contact/cover.hpp"

namespace pd::detail {

/// A way out for the piece's side of a pair: along a facet of the piece or against one of the other body.
struct PieceExit {
  double depth = 0;
  Vec3 n = Vec3::UnitX();      ///< unit, from the piece outward, in the world
  Vec3 on_own = Vec3::Zero();  ///< points of both surfaces, in the world
  Vec3 on_other = Vec3::Zero();
};

/// @param farthest  the point of the other body's core that lies the farthest against n
[[nodiscard]] PieceExit exit_along(const PieceSide& side, const Vec3& n, double depth, const Vec3& farthest);

/// The manifold along an exit, of points that lie on the piece.
/// @param own, frame  the piece
[[nodiscard]] ContactManifold points_along(const PieceExit& exit, const PieceSide& side, const UnionFrame& frame,
                                           const UnionPiece& own, double threshold, double slack,
                                           ManifoldScratch& scratch);

/// Returns the greatest depth of a manifold's points. Requires: it has some.
[[nodiscard]] double deepest_of(const ContactManifold& points);

/// Takes a point out of a manifold; the last one takes its place.
void drop_point(ContactManifold& points, int i);

}  // namespace pd::detail

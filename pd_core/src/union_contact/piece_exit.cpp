#include "union_contact/piece_exit.hpp"

#include <algorithm>

namespace pd::detail {

double deepest_of(const ContactManifold& points) {
  double deepest = points.points[0].depth;
  for (int i = 1; i < points.count; ++i) deepest = std::max(deepest, points.points[static_cast<std::size_t>(i)].depth);
  return deepest;
}

void drop_point(ContactManifold& points, int i) {
  --points.count;
  points.points[static_cast<std::size_t>(i)] = points.points[static_cast<std::size_t>(points.count)];
}

PieceExit exit_along(const PieceSide& side, const Vec3& n, double depth, const Vec3& farthest) {
  const Vec3 on_other = farthest - side.other.shape->margin() * n;
  return {depth, n, on_other + depth * n, on_other};
}

ContactManifold points_along(const PieceExit& exit, const PieceSide& side, const UnionFrame& frame,
                             const UnionPiece& own, double threshold, double slack, ManifoldScratch& scratch) {
  PenetrationDepth answer;
  answer.contact = exit.depth > 0 ? ContactClass::overlapping : ContactClass::separated;
  answer.depth = std::max(exit.depth, 0.0);
  answer.distance = std::max(-exit.depth, 0.0);
  answer.normal = side.is_b ? exit.n : Vec3(-exit.n);
  answer.witness_a = side.is_b ? exit.on_other : exit.on_own;
  answer.witness_b = side.is_b ? exit.on_own : exit.on_other;
  ContactManifold points =
      side.is_b ? contact_manifold(side.other, side.own, answer, threshold, scratch, DeepestPoint::as_lifted)
                : contact_manifold(side.own, side.other, answer, threshold, scratch, DeepestPoint::as_lifted);
  for (int i = points.count - 1; i >= 0; --i) {
    const Vec3 foot = frame.place(side.on_piece(points.points[static_cast<std::size_t>(i)]) - own.margin * exit.n);
    const bool outside = std::any_of(own.planes.begin(), own.planes.end(),
                                     [&](const PiecePlane& plane) { return plane.height(foot) > 2 * slack; });
    if (outside) drop_point(points, i);
  }
  return points;
}

}  // namespace pd::detail

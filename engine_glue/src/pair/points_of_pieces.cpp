#include "pair/points_of_pieces.hpp"

#include "pieces/asked_pieces.hpp"

namespace pd::detail {

namespace {

ContactManifold closest_point_of(const PenetrationDepth& depth) {
  ContactManifold closest;
  closest.normal = depth.normal;
  closest.points[0].position_a = depth.witness_a;
  closest.points[0].position_b = depth.witness_b;
  closest.points[0].depth = -depth.signed_distance();
  closest.count = 1;
  return closest;
}

}  // namespace

void keep_points_of_pieces(const AskedPair& asked, const PairAnswer& answer, ThreadBuffers& buffers,
                           ContactManifold& points) {
  const double distance = answer.depth.signed_distance();
  if (distance > asked.contact_reach) {
    if (distance <= asked.asked_reach) points = closest_point_of(answer.depth);
    return;
  }
  AskedPieces pieces(asked.a, asked.b,
                     {.threshold = asked.contact_reach,
                      .seconds = asked.seconds,
                      .shapes = asked.shapes,
                      .near = buffers.near,
                      .cover = buffers.cover,
                      .manifold = buffers.manifold});
  count_covered(keep_uncovered(pieces.as(answer.a, answer.b), answer.depth, AnswerPoints::made, points), buffers);
}

}  // namespace pd::detail

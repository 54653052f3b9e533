#include "pair/points_of_pieces.hpp"

#include <BulletCollision/BroadphaseCollision/btBroadphaseProxy.h>
#include <BulletCollision/CollisionShapes/btCollisionShape.h>

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

bool is_triangle(const btCollisionObjectWrapper& piece) {
  return piece.getCollisionShape()->getShapeType() == TRIANGLE_SHAPE_PROXYTYPE;
}

}  // namespace

bool far_pair(double contact_reach, double asked_reach, const PenetrationDepth& depth, ContactManifold& points) {
  const double distance = depth.signed_distance();
  if (distance <= contact_reach) return false;
  points.count = 0;
  if (distance <= asked_reach) points = closest_point_of(depth);
  return true;
}

void keep_points_of_pieces(const AskedPair& asked, const PairAnswer& answer, ThreadBuffers& buffers,
                           ContactManifold& points) {
  if (far_pair(asked.contact_reach, asked.asked_reach, answer.depth, points)) return;
  AskedPieces pieces(asked.a, asked.b,
                     {.threshold = asked.contact_reach,
                      .seconds = asked.seconds,
                      .shapes = asked.shapes,
                      .near = buffers.near,
                      .cover = buffers.cover,
                      .manifold = buffers.manifold});
  const ContactManifold alone = points;
  count_covered(keep_uncovered(pieces.as(answer.a, answer.b), answer.depth, AnswerPoints::made, points), buffers);
  // The other parts' contacts are not known here. A part that is deep in a triangle would fall through without its own.
  const bool triangle = is_triangle(asked.a) || is_triangle(asked.b);
  if (points.count == 0 && triangle && -answer.depth.signed_distance() > asked.contact_reach) points = alone;
}

}  // namespace pd::detail

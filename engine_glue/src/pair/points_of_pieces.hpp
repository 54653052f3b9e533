/// @file
/// The points of two pieces of unions, of a question that may reach farther than contacts do.
#pragma once

#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>

#include "pair/thread_buffers.hpp"
#include "pd/contact/manifold.hpp"
#include "shapes/pair_answer.hpp"
#include "shapes/step_shapes.hpp"

namespace pd::detail {

/// Two pieces and how far they were asked about. A query may ask for distances of metres; contacts, and the neighbours
/// that may cover them, lie within the breaking threshold.
struct AskedPair {
  const btCollisionObjectWrapper& a;
  const btCollisionObjectWrapper& b;
  double contact_reach;  ///< up to which gap points are contacts
  double asked_reach;    ///< up to which gap the closest point is wanted
  double seconds;        ///< of the step
  StepShapes shapes;
};

/// Changes the points of a pair that is farther apart than contacts reach to its closest point, as Bullet's queries get
/// one, or to none beyond what was asked for. @return false, and nothing changed, for a pair that is nearer
bool far_pair(double contact_reach, double asked_reach, const PenetrationDepth& depth, ContactManifold& points);

/// Changes the points of an answer to those that hold for the unions. If the pieces are farther apart than contacts
/// reach, it is their closest point, as Bullet's queries get one for each pair of a compound's children.
/// Requires: `buffers.near.begin_pair`.
void keep_points_of_pieces(const AskedPair& asked, const PairAnswer& answer, ThreadBuffers& buffers,
                           ContactManifold& points);

}  // namespace pd::detail

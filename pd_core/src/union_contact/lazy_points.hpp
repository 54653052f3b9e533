/// @file
/// The contact points of a pair's answer, made when they are asked for: what is turned or dropped for what lies round
/// it needs none.
#pragma once

#include "pd/contact/manifold.hpp"
#include "pd/union_contact/covered_contact.hpp"

namespace pd::detail {

/// In the caller's manifold, whose normal is the answer's from the beginning.
class LazyPoints {
 public:
  LazyPoints(const PiecePair& pair, const PenetrationDepth& depth, AnswerPoints given, ContactManifold& points)
      : pair_(pair), depth_(depth), made_(given == AnswerPoints::made), points_(points) {
    if (made_) return;
    points_.normal = depth.normal;
    points_.count = 0;
    made_ = depth.signed_distance() > pair.threshold;
  }
  [[nodiscard]] const Vec3& normal() const { return points_.normal; }
  /// Whether there are none.
  [[nodiscard]] bool none() const { return made_ && points_.count == 0; }
  ContactManifold& get() {
    if (!made_) {
      points_ = contact_manifold(pair_.a, pair_.b, depth_, pair_.threshold, pair_.manifold, DeepestPoint::as_lifted);
      made_ = true;
    }
    return points_;
  }
  void set(const ContactManifold& points) {
    points_ = points;
    made_ = true;
  }

 private:
  const PiecePair& pair_;
  const PenetrationDepth& depth_;
  bool made_;
  ContactManifold& points_;
};

}  // namespace pd::detail

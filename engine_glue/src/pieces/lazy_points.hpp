/// @file
/// The contact points of a pair's answer, made when they are asked for: what is turned or dropped for what lies round
/// it needs none.
#pragma once

#include "pd/contact/manifold.hpp"
#include "pieces/covered_contact.hpp"
#include "shapes/pair_answer.hpp"

namespace pd::detail {

/// In the caller's manifold, whose normal is the answer's from the beginning.
class LazyPoints {
 public:
  LazyPoints(const PairAnswer& answer, double threshold, ManifoldScratch& scratch, AnswerPoints given,
             ContactManifold& points)
      : answer_(answer), threshold_(threshold), scratch_(scratch), made_(given == AnswerPoints::made), points_(points) {
    if (made_) return;
    points_.normal = answer.depth.normal;
    points_.count = 0;
    made_ = answer.depth.signed_distance() > threshold;
  }
  [[nodiscard]] const Vec3& normal() const { return points_.normal; }
  /// Whether there are none.
  [[nodiscard]] bool none() const { return made_ && points_.count == 0; }
  ContactManifold& get() {
    if (!made_) {
      points_ = contact_manifold(answer_.a, answer_.b, answer_.depth, threshold_, scratch_, DeepestPoint::as_lifted);
      made_ = true;
    }
    return points_;
  }
  void set(const ContactManifold& points) {
    points_ = points;
    made_ = true;
  }

 private:
  const PairAnswer& answer_;
  double threshold_;
  ManifoldScratch& scratch_;
  bool made_;
  ContactManifold& points_;
};

}  // namespace pd::detail

/// @file
/// How far two objects come in a step, and which parts of one leap over themselves in it.
#pragma once

#include <algorithm>

#include "shapes/body_motion.hpp"
#include "union/union_algorithm.hpp"

namespace pd::detail {

class StepLeap {
 public:
  /// @param size  of the body `question.a`
  StepLeap(const UnionQuestion& question, btScalar size) : seconds_(question.time), size_(size) {
    moves_ = motion_of(*question.a.getCollisionObject(), seconds_, of_a_) &&
             motion_of(*question.b.getCollisionObject(), seconds_, of_b_);
  }

  /// The way of the body's points, at most. Zero where nothing is known of it.
  [[nodiscard]] double way() const {
    if (!moves_) return 0;
    const btScalar speed =
        (of_a_.velocity - of_b_.velocity).length() + of_a_.gained.length() + (of_a_.turn - of_b_.turn).length() * size_;
    return static_cast<double>(speed * seconds_);
  }

  /// How far a part comes that may be through a sheet as a whole after the step; zero: it does not come so far. Who
  /// leaps over more than the whole body is not led back.
  /// @param box    the part's, along the axes of `basis`
  /// @param alone  it is the whole body, and turns about itself; others go through by one end first
  [[nodiscard]] btScalar over_itself(const btVector3& middle, const btVector3& box, const btMatrix3x3& basis,
                                     bool alone) const {
    if (!moves_) return 0;
    const btVector3 leap = seconds_ * (of_a_.velocity_at(middle) - of_b_.velocity_at(middle)) * basis;
    const btScalar turned = alone ? 0 : seconds_ * (of_a_.turn - of_b_.turn).length() * btScalar(0.5) * box.length();
    const btVector3 over = leap.absolute() - box;
    return over[over.maxAxis()] + turned > 0 ? std::min(leap.length() + turned, size_) : btScalar(0);
  }

 private:
  BodyMotion of_a_, of_b_;
  btScalar seconds_, size_;
  bool moves_;
};

}  // namespace pd::detail

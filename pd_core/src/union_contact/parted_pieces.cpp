#include "pd/union_contact/parted_pieces.hpp"

#include <cmath>

namespace pd {

namespace {

/// A host's matrix is off a rotation by 2^-22 at most, and so are products of two, a few times over.
constexpr double kOffRotation = 0x1p-19;

}  // namespace

void PartedPieces::note(const Pose& a, const Pose& b, const PenetrationDepth& answer) {
  distance_ = answer.distance_lower;
  if (!known()) return;
  const Mat3 back = b.rotation().transpose();
  normal_ = back * answer.normal;
  place_ = back * (a.translation() - b.translation());
  rotation_ = back * a.rotation();
}

bool PartedPieces::beyond(double gap, const Pose& a, const Pose& b, double radius) const {
  if (!known()) return false;
  const Mat3 back = b.rotation().transpose();
  const Vec3 place = back * (a.translation() - b.translation());
  // The difference of two rotations stretches two directions alike and the third not at all.
  const double turned = std::sqrt(0.5) * (back * a.rotation() - rotation_).norm() * radius;
  const double rounding = kOffRotation * (place.cwiseAbs().sum() + radius + distance_);
  return distance_ + normal_.dot(place - place_) - turned - rounding > gap;
}

}  // namespace pd

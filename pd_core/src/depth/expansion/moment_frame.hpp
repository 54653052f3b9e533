/// @file
/// The frame in which P is about as wide in all directions, for directions to begin a search with: P stands for the
/// ellipsoid of its bodies' second moments.
///
/// Four directions as far apart as a ball's facets find one end of a needle four times, and of a lens or a roof a flat
/// tetrahedron. Laid out in this frame they find four sides of anything.
///
/// With C = L L^T the ellipsoid {L x : |x| <= k}, a direction w of the frame is the direction L^-T w.
#pragma once

#include <cmath>

#include "depth/difference/polytope_difference.hpp"
#include "pd/numeric/vector.hpp"

namespace pd::detail {

class MomentFrame {
 public:
  explicit MomentFrame(const PolytopeDifference& difference) {
    Mat3 c = moments_of(difference.a(), difference.rotation_a()) + moments_of(difference.b(), difference.rotation_b());
    // Support functions add up, (h_A + h_B)^2 <= 2 h_A^2 + 2 h_B^2. Bodies flatter than a thousandth of their length
    // are taken for that thick, and none for thinner than rounding.
    const double least = kLeastShare * c.trace() + kLeastShare * kLeastShare * difference.reach() * difference.reach();
    c = 2 * c;
    // Quotients first, so that no root waits for another.
    const double share_0 = 1 / (c(0, 0) + least);
    const double part_10 = c(1, 0) * share_0, part_20 = c(2, 0) * share_0;
    const double share_1 = 1 / (c(1, 1) + least - part_10 * c(1, 0));
    const double rest_21 = c(2, 1) - part_20 * c(1, 0);
    const double rest_22 = c(2, 2) + least - part_20 * c(2, 0) - rest_21 * rest_21 * share_1;
    inverse_[0] = std::sqrt(share_0);
    inverse_[1] = std::sqrt(share_1);
    inverse_[2] = std::sqrt(1 / rest_22);
    l10_ = c(1, 0) * inverse_[0];
    l20_ = c(2, 0) * inverse_[0];
    l21_ = rest_21 * inverse_[1];
  }

  /// Where the depth of the ellipsoid about P's centre is expected, as the frame has it, any length. The direction u of
  /// its least height k sqrt(u^T C u) + <centre, u> for |u| = 1 solves (k C / sqrt(u^T C u) - depth) u = -centre: near
  /// C^-1 of the way back to the centre where the depth is little beside the ellipsoid's least semi-axis, and with more
  /// of that axis the deeper. Two times C^-1 where the origin lies deep, which is within one root of the moments of the
  /// centre (a surface of an ellipsoid is sqrt(5) of them away), is as good as that solution
  /// (tests/bench/notebook/2026-11-26-pairs.md).
  [[nodiscard]] Vec3 expected(const Vec3& centre) const {
    const Vec3 once = against(-centre);
    return once.squaredNorm() < 1 ? against(out_of(once)) : once;
  }

  /// L^T u: a direction as the frame has it.
  [[nodiscard]] Vec3 into(const Vec3& u) const {
    return {u.x() / inverse_[0] + l10_ * u.y() + l20_ * u.z(), u.y() / inverse_[1] + l21_ * u.z(), u.z() / inverse_[2]};
  }
  /// L^-T w: the inverse.
  [[nodiscard]] Vec3 out_of(const Vec3& w) const {
    const double z = w.z() * inverse_[2];
    const double y = (w.y() - l21_ * z) * inverse_[1];
    return {(w.x() - l10_ * y - l20_ * z) * inverse_[0], y, z};
  }

 private:
  static constexpr double kLeastShare = 0x1p-20;

  static Mat3 moments_of(const ConvexPolytope& body, const Mat3& rotation) {
    return rotation * body.storage().second_moments * rotation.transpose();
  }
  /// L^-1 x: L^T u of the direction u = C^-1 x.
  [[nodiscard]] Vec3 against(const Vec3& x) const {
    const double a = x.x() * inverse_[0];
    const double b = (x.y() - l10_ * a) * inverse_[1];
    return {a, b, (x.z() - l20_ * a - l21_ * b) * inverse_[2]};
  }

  double inverse_[3];  ///< of L's diagonal
  double l10_, l20_, l21_;
};

}  // namespace pd::detail

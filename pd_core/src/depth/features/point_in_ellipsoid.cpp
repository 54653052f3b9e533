#include "depth/features/point_in_ellipsoid.hpp"

#include <algorithm>
#include <cmath>

#include "numeric/unit_roundoff.hpp"

namespace pd::detail {

namespace {

/// The iteration converges quadratically from below; more steps would only be rounding.
constexpr int kMaxSteps = 40;

/// t = r_min^2 - m, and d_i = r_i^2 - r_min^2, so that r_i^2 - m = d_i + t keeps its relative accuracy.
class SecularEquation {
 public:
  SecularEquation(const Vec3& radii, const Vec3& point)
      : radii_(radii),
        point_(point),
        least_(radii.minCoeff()),
        d_((radii.array() - least_) * (radii.array() + least_)) {}

  /// p_i / (d_i + t); 0 for 0 / 0, which is the limit.
  [[nodiscard]] Vec3 quotients(double t) const {
    Vec3 q;
    for (int i = 0; i < 3; ++i) q[i] = point_[i] == 0 ? 0 : point_[i] / (d_[i] + t);
    return q;
  }

  /// Where phi(t) = sum (p_i r_i / (d_i + t))^2 falls to 1; 0 in the hard case, where it never is above.
  [[nodiscard]] double root() const {
    double t = 0;
    for (int i = 0; i < 3; ++i) t = std::max(t, std::abs(point_[i]) * radii_[i] - d_[i]);
    for (int step = 0; step < kMaxSteps; ++step) {
      double phi = 0, slope = 0;
      const Vec3 q = quotients(t);
      for (int i = 0; i < 3; ++i) {
        const double term = q[i] * q[i] * (radii_[i] * radii_[i]);
        phi += term;
        if (term > 0) slope += term / (d_[i] + t);
      }
      if (!(phi > 1) || !(slope > 0)) break;
      // Newton on 1 / sqrt(phi), which is concave: it comes from below and never passes the root.
      const double next = std::min(t + phi * (std::sqrt(phi) - 1) / slope, least_ * least_);
      if (!(next > t)) break;
      t = next;
    }
    return t;
  }

  [[nodiscard]] PointInEllipsoid answer(double t) const {
    PointInEllipsoid out;
    out.outward = quotients(t);
    const double share = out.outward.dot(point_);
    const double square = least_ * least_;
    // Of r_min^2 - t 2u r_min^2, of the sum 8u of itself and of 1 less it u.
    const double error = 16 * kUnitRoundoff * square * (1 + share);
    const double squared = (square - t) * (1 - share) - error;
    out.lower = squared > 0 ? std::sqrt(squared) * (1 - 4 * kUnitRoundoff) : 0;
    if (t == 0) complete_hard_case(out.outward);
    return out;
  }

 private:
  /// The nearest points lie on both sides of the plane across a shortest axis.
  void complete_hard_case(Vec3& outward) const {
    int axis = 0;
    radii_.minCoeff(&axis);
    const double rest = 1 - outward.cwiseProduct(radii_).squaredNorm();
    outward[axis] = std::sqrt(std::max(0.0, rest)) / least_;
  }

  Vec3 radii_;
  Vec3 point_;
  double least_;
  Vec3 d_;
};

}  // namespace

PointInEllipsoid point_in_ellipsoid(const Vec3& radii, const Vec3& point) {
  const SecularEquation equation(radii, point);
  return equation.answer(equation.root());
}

}  // namespace pd::detail

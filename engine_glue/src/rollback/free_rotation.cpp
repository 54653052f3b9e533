#include "rollback/free_rotation.hpp"

#include <algorithm>
#include <cmath>

namespace pd::detail {

namespace {

/// Turns of a substep are at most this: the error of fourth order is then below what single precision resolves.
constexpr double kSubstepRadians = 0.04;
/// A body that turns faster than this many substeps hold is no case of a step of Bullet's, which turns it by less.
constexpr int kMostSubsteps = 256;
/// 1 / (2 - 2^(1/3)).
constexpr double kOuterShare = 1.3512071919596578;

class Spin {
 public:
  Spin(const Rotation& start, const Vec3& inertia) : inertia_(inertia) {
    rows_.topRows<3>() = start.orientation;
    rows_.row(3) = (start.orientation.transpose() * start.angular_velocity).cwiseProduct(inertia).transpose();
  }

  /// One step of second order.
  void step(double time) {
    turn(0, 0.5 * time);
    turn(1, 0.5 * time);
    turn(2, time);
    turn(1, 0.5 * time);
    turn(0, 0.5 * time);
  }

  [[nodiscard]] Rotation rotation() const {
    const Mat3 orientation = rows_.topRows<3>();
    return {orientation, orientation * rows_.row(3).transpose().cwiseQuotient(inertia_)};
  }

 private:
  void turn(int axis, double time) {
    const double angle = time * rows_(3, axis) / inertia_[axis];
    const double c = std::cos(angle);
    const double s = std::sin(angle);
    const int next = (axis + 1) % 3;
    const int last = (axis + 2) % 3;
    const Eigen::Vector4d column = rows_.col(next);
    rows_.col(next) = c * column + s * rows_.col(last);
    rows_.col(last) = c * rows_.col(last) - s * column;
  }

  /// The orientation, and the momentum in the frame of the body below it: a turn of the body is the same product from
  /// the right for both.
  Eigen::Matrix<double, 4, 3> rows_;
  Vec3 inertia_;
};

}  // namespace

Rotation rotate_freely(const Rotation& start, const Vec3& inertia, double duration) {
  const double turns = std::ceil(start.angular_velocity.norm() * duration / kSubstepRadians);
  const int substeps = static_cast<int>(std::clamp(turns, 1.0, static_cast<double>(kMostSubsteps)));
  const double time = duration / substeps;
  Spin spin(start, inertia);
  for (int i = 0; i < substeps; ++i) {
    spin.step(kOuterShare * time);
    spin.step((1 - 2 * kOuterShare) * time);
    spin.step(kOuterShare * time);
  }
  return spin.rotation();
}

}  // namespace pd::detail

/// @file
/// A rigid placement, exact as written: world point = R * local + t in real arithmetic on the stored numbers.
///
/// A quaternion q stands for the homogeneous rotation divided by |q|^2, which is rational in its four numbers, so that
/// exact predicates on posed vertices stay exact. A matrix is taken as it stands, without re-orthogonalisation.
#pragma once

#include <array>

#include "pd/numeric/expected.hpp"
#include "pd/numeric/vector.hpp"

namespace pd {

class Pose {
 public:
  /// The identity.
  Pose() : rotation_(Mat3::Identity()), translation_(Vec3::Zero()) {}

  /// @param rotation  row i, column j at (i, j); must satisfy max|R^T R - I| <= 1e-6 and det R > 0.
  /// @return ErrorCode::non_finite, not_a_rotation (its residual stated) or out_of_range (|t_i| > kMaxCoordinate).
  static Expected<Pose> from_matrix(const Mat3& rotation, const Vec3& translation);

  /// @param wxyz  scalar first; | |q| - 1 | <= 1e-6.
  /// @return ErrorCode::non_finite, bad_value (zero quaternion), not_a_rotation (its length stated) or out_of_range.
  static Expected<Pose> from_quaternion(const std::array<double, 4>& wxyz, const Vec3& translation);

  /// For hosts whose matrices are rotations only up to their own rounding (a physics engine's float basis): any finite
  /// matrix is taken as it stands. Requires finite numbers within the range of `from_matrix`.
  static Pose from_trusted_matrix(const Mat3& rotation, const Vec3& translation);

  /// R rounded to doubles (exactly R when the pose was given as a matrix).
  [[nodiscard]] const Mat3& rotation() const { return rotation_; }
  [[nodiscard]] const Vec3& translation() const { return translation_; }

  /// Given as a quaternion: R is exactly `homogeneous(q) / |q|^2`.
  [[nodiscard]] bool is_quaternion() const { return is_quaternion_; }
  [[nodiscard]] const std::array<double, 4>& quaternion_wxyz() const { return wxyz_; }

  /// The rotation nearest to R in the Frobenius norm (smooth bodies are posed by it).
  [[nodiscard]] Mat3 nearest_rotation() const;

  /// R * local + t in doubles.
  [[nodiscard]] Vec3 apply(const Vec3& local) const { return rotation_ * local + translation_; }

  friend bool operator==(const Pose&, const Pose&) = default;

 private:
  Mat3 rotation_;
  Vec3 translation_;
  std::array<double, 4> wxyz_{1, 0, 0, 0};
  bool is_quaternion_ = false;
};

/// Coordinates, translations, radii and margins are refused above this magnitude (`out_of_range`), so that no sum of
/// two posed coordinates overflows.
inline constexpr double kMaxCoordinate = 1e300;

}  // namespace pd

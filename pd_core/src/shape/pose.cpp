#include "pd/shape/pose.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>

#include "numeric/double_double.hpp"
#include "numeric/dyadic.hpp"
#include "numeric/number_text.hpp"
#include "numeric/small_decompositions.hpp"

namespace pd {
namespace {

using detail::Dyadic;
using detail::indexed;
using detail::number_text;

constexpr double kRotationTolerance = 1e-6;

std::optional<Error> refuse_translation(const Vec3& translation) {
  for (int i = 0; i < 3; ++i) {
    if (!std::isfinite(translation[i])) {
      return Error{ErrorCode::non_finite, "a translation must be finite", indexed("translation", i)};
    }
    if (std::abs(translation[i]) > kMaxCoordinate) {
      return Error{ErrorCode::out_of_range,
                   std::string("|") + number_text(translation[i]) + "| is above the largest coordinate " +
                       number_text(kMaxCoordinate),
                   indexed("translation", i)};
    }
  }
  return std::nullopt;
}

/// max|R^T R - I|, exact. Overflow cannot happen: the numbers are dyadic.
Dyadic orthogonality_residual(const Mat3& r) {
  Dyadic largest;
  for (int i = 0; i < 3; ++i) {
    for (int j = i; j < 3; ++j) {
      Dyadic entry(i == j ? -1.0 : 0.0);
      for (int k = 0; k < 3; ++k) entry = entry + Dyadic(r(k, i)) * Dyadic(r(k, j));
      if (entry.sign() < 0) entry = -entry;
      if (entry > largest) largest = entry;
    }
  }
  return largest;
}

/// The residual in doubles; its error is below 1e-14 where no entry exceeds 2 (7 roundings of terms below 4).
double rounded_residual(const Mat3& r) { return (r.transpose() * r - Mat3::Identity()).cwiseAbs().maxCoeff(); }

/// The rotation of q / |q|, each entry rounded from double-double (relative to 1, error below 1.01 ulp).
Mat3 rotation_of(const std::array<double, 4>& q) {
  using detail::DoubleDouble;
  using detail::two_product;
  const auto product = [&](int i, int j) {
    return two_product(q[static_cast<std::size_t>(i)], q[static_cast<std::size_t>(j)]);
  };
  const DoubleDouble ww = product(0, 0);
  const DoubleDouble xx = product(1, 1);
  const DoubleDouble yy = product(2, 2);
  const DoubleDouble zz = product(3, 3);
  const DoubleDouble squared = (ww + xx) + (yy + zz);
  const auto twice = [&](const DoubleDouble& s) {
    return detail::to_double(DoubleDouble{2 * s.hi, 2 * s.lo} / squared);
  };
  const auto once = [&](const DoubleDouble& s) { return detail::to_double(s / squared); };
  Mat3 r;
  r(0, 0) = once((ww + xx) - (yy + zz));
  r(1, 1) = once((ww + yy) - (xx + zz));
  r(2, 2) = once((ww + zz) - (xx + yy));
  r(0, 1) = twice(product(1, 2) - product(0, 3));
  r(1, 0) = twice(product(1, 2) + product(0, 3));
  r(0, 2) = twice(product(1, 3) + product(0, 2));
  r(2, 0) = twice(product(1, 3) - product(0, 2));
  r(1, 2) = twice(product(2, 3) - product(0, 1));
  r(2, 1) = twice(product(2, 3) + product(0, 1));
  return r;
}

/// Transposed inverse by cofactors; `determinant` is returned beside it.
Mat3 cofactors(const Mat3& m, double& determinant) {
  Mat3 c;
  for (int i = 0; i < 3; ++i) c.row(i) = m.row((i + 1) % 3).cross(m.row((i + 2) % 3));
  determinant = m.row(0).dot(c.row(0));
  return c;
}

}  // namespace

Expected<Pose> Pose::from_matrix(const Mat3& rotation, const Vec3& translation) {
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      if (!std::isfinite(rotation(i, j))) {
        return Error{ErrorCode::non_finite, "a rotation must be finite", indexed("rotation", 3 * i + j)};
      }
    }
  }
  if (auto refused = refuse_translation(translation)) return *std::move(refused);
  // Clearly good matrices need no exact arithmetic; the others are decided, and reported, by the exact residual.
  const bool clearly_good =
      rotation.cwiseAbs().maxCoeff() <= 2 && rounded_residual(rotation) <= kRotationTolerance - 1e-14;
  if (!clearly_good) {
    const Dyadic residual = orthogonality_residual(rotation);
    if (residual > Dyadic(kRotationTolerance)) {
      return Error{
          ErrorCode::not_a_rotation,
          "max|R^T R - I| = " + number_text(std::min(residual.to_double(), std::numeric_limits<double>::max())) +
              ", must be <= " + number_text(kRotationTolerance),
          "rotation"};
    }
  }
  double determinant = 0;
  cofactors(rotation, determinant);
  if (determinant <= 0) {  // |det| is within 1e-5 of 1 here, so its sign is certain
    return Error{ErrorCode::not_a_rotation, "det R = " + number_text(determinant) + ": a reflection, must be > 0",
                 "rotation"};
  }
  return from_trusted_matrix(rotation, translation);
}

Expected<Pose> Pose::from_quaternion(const std::array<double, 4>& wxyz, const Vec3& translation) {
  for (std::size_t i = 0; i < 4; ++i) {
    if (!std::isfinite(wxyz[i])) {
      return Error{ErrorCode::non_finite, "a quaternion must be finite", indexed("quaternion", static_cast<int>(i))};
    }
  }
  if (auto refused = refuse_translation(translation)) return *std::move(refused);
  if (std::all_of(wxyz.begin(), wxyz.end(), [](double c) { return c == 0; })) {
    return Error{ErrorCode::bad_value, "a zero quaternion stands for no rotation", "quaternion"};
  }
  // std::hypot neither over- nor underflows; the exact squared length decides near the bounds.
  const double length = std::hypot(std::hypot(wxyz[0], wxyz[1]), std::hypot(wxyz[2], wxyz[3]));
  if (!(std::abs(length - 1) <= kRotationTolerance - 1e-14)) {
    Dyadic squared;
    for (const double c : wxyz) squared = squared + Dyadic(c) * Dyadic(c);
    const Dyadic low = Dyadic(1.0) - Dyadic(kRotationTolerance);
    const Dyadic high = Dyadic(1.0) + Dyadic(kRotationTolerance);
    if (squared < low * low || squared > high * high) {
      return Error{ErrorCode::not_a_rotation,
                   "|q| = " + number_text(std::min(length, std::numeric_limits<double>::max())) + ", must be within " +
                       number_text(kRotationTolerance) + " of 1",
                   "quaternion"};
    }
  }
  Pose pose;
  pose.rotation_ = rotation_of(wxyz);
  pose.translation_ = translation;
  pose.wxyz_ = wxyz;
  pose.is_quaternion_ = true;
  return pose;
}

Pose Pose::from_trusted_matrix(const Mat3& rotation, const Vec3& translation) {
  Pose pose;
  pose.rotation_ = rotation;
  pose.translation_ = translation;
  return pose;
}

Mat3 Pose::nearest_rotation() const {
  // Newton's iteration for the polar factor, X <- (X + X^-T) / 2, converges quadratically to it from any nonsingular X
  // (Higham, "Computing the polar decomposition", 1986). From a residual of 1e-6 two steps reach rounding level.
  constexpr double kConverged = 4e-16;
  constexpr int kMaxSteps = 12;
  Mat3 x = rotation_;
  if (rounded_residual(x) < 0.5) {
    for (int step = 0; step < kMaxSteps; ++step) {
      double determinant = 0;
      const Mat3 c = cofactors(x, determinant);
      if (!(determinant > 0)) break;
      const Mat3 next = 0.5 * (x + c / determinant);
      const double change = (next - x).cwiseAbs().maxCoeff();
      x = next;
      if (change <= kConverged) return x;
    }
  }
  // Far from a rotation (trusted host matrices only): U diag(1, 1, +-1) V^T of the singular value decomposition.
  const double scale = rotation_.cwiseAbs().maxCoeff();
  if (scale == 0) return Mat3::Identity();
  const Mat3 scaled = rotation_ / scale;
  const detail::SmallSingularValues singular(scaled.data(), 3);
  const Eigen::Map<const Mat3> left(singular.scaled_left()), v(singular.right());
  Mat3 u;
  u.col(0) = left.col(0) / singular.value(0);
  u.col(1) = singular.value(1) > 0 ? Vec3(left.col(1) / singular.value(1)) : Vec3(u.col(0).unitOrthogonal());
  u.col(2) = v.col(0).cross(v.col(1)).dot(v.col(2)) * u.col(0).cross(u.col(1));
  return u * v.transpose();
}

}  // namespace pd

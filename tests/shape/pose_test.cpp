/// Poses: what is a rotation, what is refused and how, and the nearest rotation.
#include "pd/shape/pose.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <random>

namespace pd {
namespace {

const double kNaN = std::numeric_limits<double>::quiet_NaN();
const double kInfinity = std::numeric_limits<double>::infinity();

double residual(const Mat3& r) { return (r.transpose() * r - Mat3::Identity()).cwiseAbs().maxCoeff(); }

TEST(Pose, IdentityByDefault) {
  const Pose pose;
  EXPECT_EQ(pose.apply({1, 2, 3}), Vec3(1, 2, 3));
  EXPECT_FALSE(pose.is_quaternion());
}

TEST(Pose, MatrixIsTakenAsItStands) {
  Mat3 r;
  r << 1, 1e-7, 0, -1e-7, 1, 0, 0, 0, 1;
  const auto pose = Pose::from_matrix(r, {1, 2, 3});
  ASSERT_TRUE(pose.has_value());
  EXPECT_EQ(pose->rotation(), r);
  EXPECT_EQ(pose->translation(), Vec3(1, 2, 3));
}

TEST(Pose, MatrixRefusals) {
  Mat3 r = Mat3::Identity();
  const Vec3 o = Vec3::Zero();
  r(1, 2) = kNaN;
  EXPECT_EQ(Pose::from_matrix(r, o).error().code, ErrorCode::non_finite);
  EXPECT_EQ(Pose::from_matrix(r, o).error().where, "rotation[5]");
  EXPECT_EQ(Pose::from_matrix(Mat3::Zero(), o).error().code, ErrorCode::not_a_rotation);
  EXPECT_NE(Pose::from_matrix(Mat3::Zero(), o).error().message.find("= 1,"), std::string::npos);
  Mat3 sheared = Mat3::Identity();
  sheared(0, 1) = 0.1;
  EXPECT_EQ(Pose::from_matrix(sheared, o).error().code, ErrorCode::not_a_rotation);
  Mat3 mirror = Mat3::Identity();
  mirror(2, 2) = -1;
  EXPECT_EQ(Pose::from_matrix(mirror, o).error().code, ErrorCode::not_a_rotation);
  EXPECT_EQ(Pose::from_matrix(Mat3::Constant(1e300), o).error().code, ErrorCode::not_a_rotation);
  EXPECT_EQ(Pose::from_matrix(Mat3::Identity(), {0, kInfinity, 0}).error().code, ErrorCode::non_finite);
  EXPECT_EQ(Pose::from_matrix(Mat3::Identity(), {0, kInfinity, 0}).error().where, "translation[1]");
  EXPECT_EQ(Pose::from_matrix(Mat3::Identity(), {0, 0, 2e300}).error().code, ErrorCode::out_of_range);
}

TEST(Pose, ResidualIsDecidedExactly) {
  // R^T R - I has the single entry s^2 - 1; the bound 1e-6 falls between two neighbouring doubles s.
  double s = std::sqrt(1 + 1e-6);
  int accepted = 0;
  int refused = 0;
  for (int k = 0; k < 5; ++k) s = std::nextafter(s, 0);
  for (int k = 0; k < 10; ++k, s = std::nextafter(s, 2)) {
    Mat3 r = Mat3::Identity();
    r(0, 0) = s;
    const bool accept = Pose::from_matrix(r, Vec3::Zero()).has_value();
    EXPECT_FALSE(accept && refused > 0) << "not monotone";
    ++(accept ? accepted : refused);
  }
  EXPECT_GT(accepted, 0);
  EXPECT_GT(refused, 0);
}

TEST(Pose, Quaternions) {
  const auto turn = Pose::from_quaternion({0.5, 0.5, 0.5, 0.5}, Vec3::Zero());
  ASSERT_TRUE(turn.has_value());
  EXPECT_TRUE(turn->is_quaternion());
  EXPECT_EQ(turn->apply({1, 0, 0}), Vec3(0, 1, 0));
  EXPECT_EQ(turn->apply({0, 1, 0}), Vec3(0, 0, 1));
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  for (int round = 0; round < 1000; ++round) {
    std::array<double, 4> q;
    for (double& c : q) c = normal(random);
    const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    for (double& c : q) c *= (1 + 9e-7) / length;  // a sloppy length changes nothing: R is homogeneous in q
    const auto pose = Pose::from_quaternion(q, Vec3::Zero());
    ASSERT_TRUE(pose.has_value());
    EXPECT_LT(residual(pose->rotation()), 5e-16);
    EXPECT_GT(pose->rotation().determinant(), 0);
  }
}

TEST(Pose, QuaternionRefusals) {
  const Vec3 o = Vec3::Zero();
  EXPECT_EQ(Pose::from_quaternion({0, 0, 0, 0}, o).error().code, ErrorCode::bad_value);
  EXPECT_EQ(Pose::from_quaternion({2, 0, 0, 0}, o).error().code, ErrorCode::not_a_rotation);
  EXPECT_NE(Pose::from_quaternion({2, 0, 0, 0}, o).error().message.find("|q| = 2"), std::string::npos);
  EXPECT_EQ(Pose::from_quaternion({1, kNaN, 0, 0}, o).error().code, ErrorCode::non_finite);
  EXPECT_EQ(Pose::from_quaternion({1e308, 1e308, 1e308, 1e308}, o).error().code, ErrorCode::not_a_rotation);
  EXPECT_EQ(Pose::from_quaternion({5e-324, 0, 0, 0}, o).error().code, ErrorCode::not_a_rotation);
  EXPECT_EQ(Pose::from_quaternion({1, 0, 0, 0}, {1e301, 0, 0}).error().code, ErrorCode::out_of_range);
}

TEST(Pose, NearestRotation) {
  std::mt19937_64 random(2);
  std::normal_distribution<double> normal;
  for (const double noise : {0.0, 1e-9, 1e-7, 1e-2, 10.0}) {
    for (int round = 0; round < 200; ++round) {
      std::array<double, 4> q;
      for (double& c : q) c = normal(random);
      const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
      for (double& c : q) c /= length;
      const Mat3 rotation = Pose::from_quaternion(q, Vec3::Zero())->rotation();
      Mat3 given = rotation;
      for (int i = 0; i < 9; ++i) given(i) += noise * normal(random);
      const Mat3 nearest = Pose::from_trusted_matrix(given, Vec3::Zero()).nearest_rotation();
      EXPECT_LT(residual(nearest), 3e-15);
      EXPECT_GT(nearest.determinant(), 0);
      // No rotation is nearer; the one that the noise was added to is a fair candidate.
      EXPECT_LE((nearest - given).norm(), (rotation - given).norm() + 1e-14);
      // R^T given is symmetric for the nearest R.
      const Mat3 stretch = nearest.transpose() * given;
      EXPECT_LT((stretch - stretch.transpose()).cwiseAbs().maxCoeff(), 1e-13 * (1 + given.norm()));
    }
  }
  EXPECT_EQ(Pose::from_trusted_matrix(Mat3::Zero(), Vec3::Zero()).nearest_rotation(), Mat3::Identity());
}

}  // namespace
}  // namespace pd

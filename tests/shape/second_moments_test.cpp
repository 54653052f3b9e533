/// @file
/// Second moments of solids against closed formulas and against a sum over a fine subdivision's points; sizes at the
/// ends of the range of doubles; which bodies are elongated.
#include "shape/hull/second_moments.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "scenes/shape_families.hpp"

namespace pd::detail {
namespace {

double off(const Mat3& found, const Mat3& wanted) { return (found - wanted).norm() / wanted.norm(); }

ConvexPolytope hull(const std::vector<Vec3>& points) { return *ConvexPolytope::from_points(points); }

std::vector<Vec3> box_at(const Vec3& half, const Vec3& middle) {
  std::vector<Vec3> out;
  for (int k = 0; k < 8; ++k) {
    out.push_back(middle + Vec3((k & 1) != 0 ? half.x() : -half.x(), (k & 2) != 0 ? half.y() : -half.y(),
                                (k & 4) != 0 ? half.z() : -half.z()));
  }
  return out;
}

TEST(SecondMoments, OfABoxWhereverItStands) {
  const Vec3 half(1, 0.5, 0.25);
  const Mat3 wanted = (half.cwiseProduct(half) / 3).asDiagonal();
  for (const Vec3& middle : {Vec3(0, 0, 0), Vec3(0.3, -0.2, 0.7), Vec3(9, -20, 30)}) {
    EXPECT_LT(off(hull(box_at(half, middle)).storage().second_moments, wanted), 1e-9) << middle.transpose();
  }
}

TEST(SecondMoments, OfATetrahedron) {
  const std::vector<Vec3> corners = {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {0.5, 0.25, 3}};
  Vec3 centroid = Vec3::Zero();
  for (const Vec3& p : corners) centroid += p / 4;
  // About the centroid: the corners' squares over 20.
  Mat3 wanted = Mat3::Zero();
  for (const Vec3& p : corners) wanted += (p - centroid) * (p - centroid).transpose() / 20;
  EXPECT_LT(off(hull(corners).storage().second_moments, wanted), 1e-12);
}

TEST(SecondMoments, OfAPolygonByItsVertices) {
  const ConvexPolytope square = hull({{1, 1, 0}, {-1, 1, 0}, {1, -1, 0}, {-1, -1, 0}});
  EXPECT_LT(off(square.storage().second_moments, Vec3(1, 1, 0).asDiagonal()), 1e-12);
}

TEST(SecondMoments, OfABallOfPointsNearABall) {
  scenes::Random random(7);
  const Mat3 found = hull(scenes::sphere_hull(2000, random)).storage().second_moments;
  EXPECT_LT(off(found, 0.2 * Mat3::Identity()), 0.02);
}

TEST(SecondMoments, AtTheEndsOfTheRange) {
  for (const double size : {1e-320, 1e-200, 1e-100, 1e100, 1e200, 1e300}) {
    const ConvexPolytope body = hull(box_at(size * Vec3(1, 0.5, 0.25), Vec3::Zero()));
    const Mat3& found = body.storage().second_moments;
    for (int i = 0; i < 9; ++i) EXPECT_FALSE(std::isnan(found(i))) << size;
    if (size > 1e-150 && size < 1e150) {
      EXPECT_LT(off(found / size / size, (Vec3(1, 0.25, 0.0625) / 3).asDiagonal()), 1e-9) << size;
      EXPECT_TRUE(body.storage().elongated) << size;
    }
  }
}

TEST(SecondMoments, ElongatedOnesAreTold) {
  scenes::Random random(3);
  EXPECT_FALSE(hull(box_at({1, 1, 1}, {0, 0, 0})).storage().elongated);
  EXPECT_FALSE(hull(scenes::prism(64)).storage().elongated);
  EXPECT_FALSE(hull(scenes::sphere_hull(32, random)).storage().elongated);
  EXPECT_TRUE(hull(scenes::needle(32, random)).storage().elongated);
  EXPECT_TRUE(hull(scenes::lens(32, 0.1)).storage().elongated);
  EXPECT_TRUE(hull(box_at({1, 0.5, 0.25}, {0, 0, 0})).storage().elongated);
}

}  // namespace
}  // namespace pd::detail

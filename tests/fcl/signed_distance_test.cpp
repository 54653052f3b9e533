/// @file
/// FCL's collision objects asked through pdepth, beside FCL's own distance and known answers.
#include "pd/fcl/signed_distance.hpp"

#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/convex.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/halfspace.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/distance.h>
#include <gtest/gtest.h>

#include <cmath>
#include <deque>
#include <limits>
#include <random>
#include <vector>

namespace pd {
namespace {

using Geometry = std::shared_ptr<fcl::CollisionGeometryd>;

/// A box as a convex mesh.
Geometry convex_box(double x, double y, double z) {
  auto points = std::make_shared<std::vector<fcl::Vector3d>>();
  for (int i = 0; i < 8; ++i) points->emplace_back((i & 1) ? x : -x, (i & 2) ? y : -y, (i & 4) ? z : -z);
  const auto faces = std::make_shared<std::vector<int>>(
      std::vector<int>{4, 0, 2, 3, 1, 4, 4, 5, 7, 6, 4, 0, 1, 5, 4, 4, 2, 6, 7, 3, 4, 0, 4, 6, 2, 4, 1, 3, 7, 5});
  return std::make_shared<fcl::Convexd>(points, 6, faces);
}

class FclDoor : public testing::Test {
 protected:
  fcl::Transform3d somewhere(double reach) {
    fcl::Quaterniond q{normal_(random_), normal_(random_), normal_(random_), normal_(random_)};
    fcl::Transform3d t = fcl::Transform3d::Identity();
    t.linear() = q.normalized().toRotationMatrix();
    t.translation() = reach * fcl::Vector3d{normal_(random_), normal_(random_), normal_(random_)};
    return t;
  }
  std::mt19937 random_{17};
  std::normal_distribution<double> normal_;
  FclQueries queries_;
};

TEST_F(FclDoor, AgreesWithFclWhereFclIsRight) {
  const std::vector<Geometry> shapes = {std::make_shared<fcl::Boxd>(0.6, 0.8, 1), std::make_shared<fcl::Sphered>(0.4),
                                        std::make_shared<fcl::Capsuled>(0.2, 0.8),
                                        std::make_shared<fcl::Cylinderd>(0.3, 0.8), convex_box(0.3, 0.4, 0.5)};
  int apart = 0, overlapping = 0;
  for (int trial = 0; trial < 400; ++trial) {
    const fcl::CollisionObjectd a(shapes[static_cast<std::size_t>(trial) % 5], somewhere(0.5));
    const fcl::CollisionObjectd b(shapes[static_cast<std::size_t>(trial) / 5 % 5], somewhere(0.5));
    fcl::DistanceResultd ours, own;
    const double x = queries_.distance(&a, &b, fcl::DistanceRequestd(), ours);
    EXPECT_EQ(ours.min_distance, x);
    const fcl::Vector3d way = ours.nearest_points[1] - ours.nearest_points[0];
    EXPECT_NEAR(way.norm(), std::abs(x), 1e-6 * std::abs(x) + 1e-12);
    if (x > 0) {
      ++apart;
      fcl::DistanceRequestd request(true);
      request.distance_tolerance = 1e-9;
      fcl::distance(&a, &b, request, own);
      EXPECT_NEAR(x, own.min_distance, 1e-5) << "trial " << trial;
    } else {
      ++overlapping;
      // FCL has no say in the depth: the way out leads out, and nine tenths of it do not.
      for (const double share : {0.9, 1.0 + 1e-5}) {
        fcl::Transform3d moved = a.getTransform();
        moved.translation() += share * way;
        const fcl::CollisionObjectd out(shapes[static_cast<std::size_t>(trial) % 5], moved);
        fcl::CollisionResultd result;
        EXPECT_EQ(fcl::collide(&out, &b, fcl::CollisionRequestd(), result) > 0, share < 1) << "trial " << trial;
      }
    }
  }
  EXPECT_GT(apart, 50);
  EXPECT_GT(overlapping, 50);
  EXPECT_EQ(queries_.left_to_fcl(), 0);
}

TEST_F(FclDoor, KnownContacts) {
  const auto box = std::make_shared<fcl::Boxd>(1, 1, 1);
  const fcl::CollisionObjectd a(box);
  fcl::CollisionObjectd b(box);
  b.setTranslation({0.25, 0.125, 0.875});
  fcl::CollisionResultd result;
  EXPECT_EQ(queries_.collide(&a, &b, fcl::CollisionRequestd(10, true), result), 4u);
  ASSERT_EQ(result.numContacts(), 4u);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(result.getContact(i).normal, fcl::Vector3d(0, 0, 1));
    EXPECT_NEAR(result.getContact(i).penetration_depth, 0.125, 1e-13);
    EXPECT_DOUBLE_EQ(result.getContact(i).pos.z(), 0.4375);
  }
  result.clear();
  EXPECT_EQ(queries_.collide(&a, &b, fcl::CollisionRequestd(1, true), result), 1u);
  result.clear();
  EXPECT_EQ(queries_.collide(&a, &b, fcl::CollisionRequestd(), result), 1u);
  b.setTranslation({0, 0, 1});
  EXPECT_EQ(queries_.collide(&a, &b, fcl::CollisionRequestd(), result), 1u) << "touching";
  b.setTranslation({0, 0, 1 + 1e-12});
  EXPECT_EQ(queries_.collide(&a, &b, fcl::CollisionRequestd(), result), 0u);
  fcl::DistanceResultd nearest;
  EXPECT_NEAR(queries_.distance(&a, &b, fcl::DistanceRequestd(), nearest), 1e-12, 1e-15);
}

TEST_F(FclDoor, ChangedGeometriesAreConvertedAgain) {
  const auto ball = std::make_shared<fcl::Sphered>(0.5);
  const fcl::CollisionObjectd a(ball);
  fcl::CollisionObjectd b(ball);
  b.setTranslation({2, 0, 0});
  fcl::DistanceResultd result;
  EXPECT_DOUBLE_EQ(queries_.distance(&a, &b, fcl::DistanceRequestd(), result), 1);
  ball->radius = 0.75;
  EXPECT_DOUBLE_EQ(queries_.distance(&a, &b, fcl::DistanceRequestd(), result), 0.5);
  for (int i = 0; i < 2000; ++i) {  // addresses that come again are other geometries
    fcl::CollisionObjectd passing(std::make_shared<fcl::Boxd>(1 + i % 3, 1, 1));
    passing.setTranslation({4, 0, 0});
    fcl::DistanceResultd here;
    EXPECT_DOUBLE_EQ(queries_.distance(&a, &passing, fcl::DistanceRequestd(), here), 3.25 - 0.5 * (1 + i % 3));
  }
}

TEST_F(FclDoor, BorrowedGeometriesMayGo) {
  fcl::Sphered ball(0.5);
  std::deque<fcl::Boxd> boxes;
  const auto borrowed = [](fcl::CollisionGeometryd& geometry) {
    return fcl::CollisionObjectd(std::shared_ptr<fcl::CollisionGeometryd>(std::shared_ptr<void>(), &geometry));
  };
  const fcl::CollisionObjectd a = borrowed(ball);
  for (int i = 0; i < 600; ++i) {  // more than are kept
    fcl::CollisionObjectd passing = borrowed(boxes.emplace_back(1 + i % 3, 1, 1));
    passing.setTranslation({4, 0, 0});
    fcl::DistanceResultd here;
    EXPECT_DOUBLE_EQ(queries_.distance(&a, &passing, fcl::DistanceRequestd(), here), 3.5 - 0.5 * (1 + i % 3));
  }
}

TEST_F(FclDoor, OneBadGeometryOfTwoObjects) {
  const auto bad = std::make_shared<fcl::Sphered>(std::numeric_limits<double>::quiet_NaN());
  const fcl::CollisionObjectd a(bad), b(bad);
  fcl::CollisionResultd result;
  for (int i = 1; i <= 3; ++i) {
    queries_.collide(&a, &b, fcl::CollisionRequestd(), result);
    EXPECT_EQ(queries_.left_to_fcl(), i);
  }
}

TEST_F(FclDoor, ContactsThatAResultHoldsDoNotCount) {
  const fcl::CollisionObjectd ball(std::make_shared<fcl::Sphered>(0.5));
  const fcl::CollisionObjectd ground(std::make_shared<fcl::Halfspaced>(fcl::Vector3d(0, 0, 1), 0.25));
  fcl::CollisionResultd result;
  for (std::size_t i = 1; i <= 3; ++i) {
    EXPECT_EQ(queries_.collide(&ball, &ground, fcl::CollisionRequestd(1, true), result), 1u) << "by FCL";
    EXPECT_EQ(queries_.collide(&ball, &ball, fcl::CollisionRequestd(1, true), result), 1u);
    EXPECT_EQ(result.numContacts(), 2 * i);
  }
}

TEST_F(FclDoor, WhatIsNoBodyIsFcls) {
  const fcl::CollisionObjectd ball(std::make_shared<fcl::Sphered>(0.5));
  const fcl::CollisionObjectd ground(std::make_shared<fcl::Halfspaced>(fcl::Vector3d(0, 0, 1), 0.25));
  fcl::CollisionResultd result, own;
  EXPECT_EQ(queries_.collide(&ball, &ground, fcl::CollisionRequestd(1, true), result),
            fcl::collide(&ball, &ground, fcl::CollisionRequestd(1, true), own));
  EXPECT_EQ(result.getContact(0).penetration_depth, own.getContact(0).penetration_depth);
  EXPECT_EQ(queries_.left_to_fcl(), 1);
  EXPECT_NE(queries_.first_reason().find("geometry"), std::string::npos);
  const fcl::CollisionObjectd nothing(std::make_shared<fcl::Sphered>(-1));
  fcl::CollisionObjectd lost(std::make_shared<fcl::Sphered>(1));
  lost.setTranslation({std::numeric_limits<double>::quiet_NaN(), 0, 0});
  for (const fcl::CollisionObjectd* bad : {&nothing, static_cast<const fcl::CollisionObjectd*>(&lost)})
    queries_.collide(&ball, bad, fcl::CollisionRequestd(), result);
  EXPECT_EQ(queries_.left_to_fcl(), 3);
  EXPECT_EQ(queries_.answered(), 0);
}

}  // namespace
}  // namespace pd

/// @file
/// Approx-Separation as the paper has it: (1 + delta) never broken, against the exact oracle on every family, with both
/// grids and both shots.
#include "pd/depth/approximate_separation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "oracle/judged_pair.hpp"

namespace pd {
namespace {

using oracle::JudgedPair;

/// Whether A moved by `translation` is disjoint from B, by the oracle.
bool separates(const JudgedPair& pair, const Vec3& translation) {
  const oracle::Body a(pair.points().a), b(pair.points().b);
  oracle::JudgeSettings settings;
  settings.distance = false;
  const oracle::ExactPair moved(a, pair.points().pose_a, b, pair.points().pose_b, translation);
  return oracle::judge(moved, settings).contact != ContactClass::overlapping;
}

class ApproxSeparation : public testing::TestWithParam<int> {};

TEST_P(ApproxSeparation, KeepsItsFactor) {
  const auto family = static_cast<scenes::PairFamily>(GetParam());
  Scratch scratch;
  for (int d = 0; d < scenes::kDepthClasses; ++d) {
    for (const int n : {5, 16}) {
      const JudgedPair pair = JudgedPair::of_family(family, n, static_cast<scenes::DepthClass>(d), 7);
      const PenetrationDepth exact = penetration_depth(pair.a(), pair.b(), scratch);
      ASSERT_EQ(pair.complaint(exact, Bracket::tightest), "");
      const bool solid =
          pair.a().shape->polytope()->affine_dimension() == 3 && pair.b().shape->polytope()->affine_dimension() == 3;
      for (const double delta : {1.0, 0.3, 0.1, 0.03}) {
        for (const GridKind grid : {GridKind::latitude_longitude, GridKind::geodesic}) {
          ApproximateSeparationSettings settings;
          settings.grid = grid;
          const auto portal = approximate_separation(pair.a(), pair.b(), delta, scratch, settings);
          ASSERT_TRUE(portal.has_value());
          ASSERT_EQ(portal->contact, exact.contact);
          EXPECT_LE(portal->lower, exact.lower) << pair.name() << " delta " << delta;
          EXPECT_GE(portal->upper, exact.upper) << pair.name() << " delta " << delta;
          EXPECT_LE(portal->upper, (1 + delta) * portal->lower) << pair.name() << " delta " << delta;
          EXPECT_LE(portal->translation.stableNorm(), portal->upper * (1 + 0x1p-50));
          if (exact.contact != ContactClass::overlapping) {
            EXPECT_EQ(portal->rays, 0);
          } else {
            EXPECT_GE(portal->shortest_ray.stableNorm() * (1 + 0x1p-46), portal->upper);
            EXPECT_LE(portal->shortest_ray.stableNorm(), (1 + delta) * exact.upper);
            if (delta == 0.3) {
              EXPECT_TRUE(separates(pair, portal->translation)) << pair.name();
            }
          }
          if (delta != 0.3 && delta != 1) continue;
          settings.shot = DirectionalMethod::hierarchy;
          const auto hierarchy = approximate_separation(pair.a(), pair.b(), delta, scratch, settings);
          ASSERT_EQ(hierarchy.has_value(), solid);
          if (!hierarchy) {
            EXPECT_EQ(hierarchy.error().code, ErrorCode::not_full_dimensional);
            continue;
          }
          // The same rays end on the same planes.
          EXPECT_EQ(hierarchy->lower, portal->lower);
          EXPECT_EQ(hierarchy->upper, portal->upper);
          EXPECT_EQ(hierarchy->rays, portal->rays);
        }
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, ApproxSeparation, testing::Range(0, scenes::kPairFamilies), [](const auto& tested) {
  return std::string(to_string(static_cast<scenes::PairFamily>(tested.param)));
});

TEST(ApproxSeparation, RaysAreProportionalToTheInverseOfDelta) {
  scenes::Random random(11);
  Scratch scratch;
  const ConvexShape a(*ConvexPolytope::from_points(scenes::sphere_hull(60, random)));
  const PosedShape at_rest{&a, Pose()};
  for (const GridKind grid : {GridKind::latitude_longitude, GridKind::geodesic}) {
    ApproximateSeparationSettings settings;
    settings.grid = grid;
    const double constant = grid == GridKind::geodesic ? 2.7 : 6.2;
    for (const double delta : {0.1, 0.01, 0.001}) {
      const auto found = approximate_separation(at_rest, at_rest, delta, scratch, settings);
      ASSERT_TRUE(found.has_value());
      const double share = static_cast<double>(found->rays) * delta;
      EXPECT_NEAR(share, constant, 0.12 * constant + 8 * std::sqrt(delta)) << delta;
      EXPECT_LT(found->ray_supports, 40 * found->rays);
    }
  }
}

TEST(ApproxSeparation, MarginsAddToBothBounds) {
  const ConvexPolytope box = *ConvexPolytope::box(Vec3(1, 1, 1));
  const ConvexShape sharp(box), round = *ConvexShape(box).with_margin(0.25);
  Scratch scratch;
  const Pose aside = *Pose::from_matrix(Mat3::Identity(), Vec3(1.5, 0.1, 0.2));
  const auto deep = approximate_separation({&round, Pose()}, {&sharp, aside}, 0.2, scratch);
  ASSERT_TRUE(deep.has_value());
  EXPECT_EQ(deep->upper, 0.75);
  EXPECT_LE(deep->lower, 0.75);
  EXPECT_GE(deep->lower, 0.25 + 0.5 / 1.2);
  // Overlapping by the margin alone: exact.
  const Pose farther = *Pose::from_matrix(Mat3::Identity(), Vec3(2.125, 0, 0));
  const auto by_margin = approximate_separation({&round, Pose()}, {&sharp, farther}, 0.2, scratch);
  ASSERT_TRUE(by_margin.has_value());
  EXPECT_EQ(by_margin->contact, ContactClass::overlapping);
  EXPECT_EQ(by_margin->rays, 0);
  EXPECT_EQ(by_margin->lower, 0.125);
  EXPECT_EQ(by_margin->upper, 0.125);
}

TEST(ApproxSeparation, RefusesByName) {
  const ConvexShape cube(*ConvexPolytope::box(Vec3(1, 1, 1))), ball(*ConvexShape::ellipsoid(Vec3(1, 1, 2)));
  const PosedShape box{&cube, Pose()};
  Scratch scratch;
  const auto refusal = [&](const PosedShape& b, double delta, const ApproximateSeparationSettings& settings = {}) {
    const auto answer = approximate_separation(box, b, delta, scratch, settings);
    return answer ? std::string("none") : std::string(to_string(answer.error().code)) + " " + answer.error().where;
  };
  EXPECT_EQ(refusal(box, 0.5), "none");
  for (const double delta : {0.0, -1.0, 1.0000001, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_EQ(refusal(box, delta), "bad_value delta");
  }
  EXPECT_EQ(refusal(box, 1e-7), "limit_exceeded delta");
  EXPECT_EQ(refusal(box, 1e-300), "limit_exceeded delta");
  ApproximateSeparationSettings settings;
  settings.max_rays = 20;
  EXPECT_EQ(refusal(box, 0.01, settings), "limit_exceeded delta");
  settings.shot = DirectionalMethod::overlay;
  EXPECT_EQ(refusal(box, 0.5, settings), "unsupported shot");
  EXPECT_EQ(refusal({&ball, Pose()}, 0.5), "unsupported ");
}

}  // namespace
}  // namespace pd

/// @file
/// Derivatives of the signed depth: a pair whose derivatives are known, central differences, ties.
#include "pd/depth/derivatives.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "oracle/derivative_cases.hpp"

namespace pd {
namespace {

using oracle::DerivativeFamily;

TEST(Derivatives, OfASphereInAFaceAreThoseOfItsHeight) {
  const ConvexShape ball = *ConvexShape::sphere(.5), block(*ConvexPolytope::box({2, 2, 1}));
  const Vec3 centre(.3, -.2, 1.4);
  Scratch scratch;
  const DepthDerivatives d =
      depth_derivatives({&ball, *Pose::from_matrix(Mat3::Identity(), centre)}, {&block, {}}, scratch);
  EXPECT_TRUE(d.unique_direction);
  EXPECT_TRUE(d.unique_witness);
  EXPECT_TRUE(d.stable_features);
  EXPECT_NEAR(d.signed_depth, .1, 1e-15);
  EXPECT_NEAR((d.by_a.translation - Vec3(0, 0, -1)).norm(), 0, 1e-15);
  EXPECT_NEAR(d.by_a.rotation.norm(), 0, 1e-15);  // a ball turns in place
  EXPECT_NEAR((d.by_b.translation - Vec3(0, 0, 1)).norm(), 0, 1e-15);
  EXPECT_NEAR((d.by_b.rotation - Vec3(.3, -.2, 1).cross(Vec3(0, 0, 1))).norm(), 0, 1e-15);
  // The face turns the normal; the ball's lowest point stays under its centre.
  EXPECT_NEAR((d.normal_by_b.rotation.col(0) - Vec3(0, -1, 0)).norm(), 0, 1e-14);
  EXPECT_NEAR(d.normal_by_a.translation.norm(), 0, 1e-14);
  EXPECT_NEAR((d.witness_a_by_a.translation - Mat3::Identity()).norm(), 0, 1e-14);
}

TEST(Derivatives, OfParallelFacesHaveADirectionAndNoRotation) {
  const ConvexShape cube(*ConvexPolytope::box({1, 1, 1}));
  Scratch scratch;
  const DepthDerivatives d =
      depth_derivatives({&cube, *Pose::from_matrix(Mat3::Identity(), {.1, .2, 1.9})}, {&cube, {}}, scratch);
  EXPECT_TRUE(d.unique_direction);
  EXPECT_FALSE(d.unique_witness);
  EXPECT_FALSE(d.stable_features);
  EXPECT_EQ(d.by_b.translation, Vec3(0, 0, 1));
  EXPECT_TRUE(std::isnan(d.by_b.rotation[0]));
  EXPECT_TRUE(std::isnan(d.normal_by_a.rotation(0, 0)));
}

TEST(Derivatives, ParallelFacesApartShareMoreThanAPointAtEverySize) {
  Scratch scratch;
  for (const double scale : {0x1p-60, 1.0, 0x1p60}) {
    const ConvexShape cube(*ConvexPolytope::box(scale * Vec3(1, 1, 1)));
    const Pose above = *Pose::from_matrix(Mat3::Identity(), scale * Vec3(.1, .2, 2.1));
    const DepthDerivatives d = depth_derivatives({&cube, above}, {&cube, {}}, scratch);
    EXPECT_TRUE(d.unique_direction) << scale;
    EXPECT_FALSE(d.unique_witness) << scale;
  }
}

TEST(Derivatives, OfAFlatDifferenceDoNotExist) {
  const ConvexShape square(*ConvexPolytope::from_points(std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}));
  Scratch scratch;
  EXPECT_FALSE(depth_derivatives({&square, {}}, {&square, {}}, scratch).unique_direction);
}

TEST(Derivatives, ScaleWithThePair) {
  Scratch scratch;
  const oracle::PosedPairCase pair = oracle::derivative_case(DerivativeFamily::polytopes, 3, 2);
  const auto times = [](const ConvexShape& shape, double scale) {
    std::vector<Vec3> points;
    for (int v = 0; v < shape.polytope()->num_vertices(); ++v) points.push_back(scale * shape.polytope()->vertex(v));
    return ConvexShape(*ConvexPolytope::from_points(points));
  };
  const DepthDerivatives one = depth_derivatives(pair.posed_a(), pair.posed_b(), scratch);
  ASSERT_TRUE(one.stable_features);
  for (const double scale : {0x1p-400, 0x1p300}) {
    const ConvexShape a = times(pair.a, scale), b = times(pair.b, scale);
    const Pose pose_a = *Pose::from_matrix(pair.pose_a.rotation(), scale * pair.pose_a.translation());
    const Pose pose_b = *Pose::from_matrix(pair.pose_b.rotation(), scale * pair.pose_b.translation());
    const DepthDerivatives d = depth_derivatives({&a, pose_a}, {&b, pose_b}, scratch);
    EXPECT_TRUE(d.stable_features);
    EXPECT_NEAR(d.signed_depth / scale, one.signed_depth, 1e-14);
    EXPECT_NEAR((d.by_a.rotation / scale - one.by_a.rotation).norm(), 0, 1e-13);
    EXPECT_NEAR((d.witness_b_by_a.rotation / scale - one.witness_b_by_a.rotation).norm(), 0, 1e-11);
    EXPECT_NEAR((d.normal_by_b.translation * scale - one.normal_by_b.translation).norm(), 0, 1e-11);
  }
}

/// Witnesses placed anew are so at every size.
TEST(Derivatives, WitnessesOfCurvedBodiesScaleWithThePair) {
  Scratch scratch;
  const auto times = [](const ConvexShape& shape, double scale) {
    if (const auto* e = std::get_if<Ellipsoid>(&shape.core())) return *ConvexShape::ellipsoid(scale * e->radii);
    if (const auto* c = std::get_if<Cylinder>(&shape.core())) {
      return *ConvexShape::cylinder(scale * c->radius, scale * c->half_height, c->axis);
    }
    if (const auto* c = std::get_if<Cone>(&shape.core())) {
      return *ConvexShape::cone(scale * c->radius, scale * c->half_height, c->axis);
    }
    std::vector<Vec3> points;
    for (int v = 0; v < shape.polytope()->num_vertices(); ++v) points.push_back(scale * shape.polytope()->vertex(v));
    return ConvexShape(*ConvexPolytope::from_points(points));
  };
  int judged = 0;
  for (std::uint64_t i = 0; i < 40; ++i) {
    const oracle::PosedPairCase pair = oracle::derivative_case(DerivativeFamily::curved, 3, i);
    if (pair.a.margin() > 0 || pair.b.margin() > 0) continue;
    // About A's translation, so that rounding of places does not count.
    const Vec3 offset = pair.pose_b.translation() - pair.pose_a.translation();
    const auto posed = [&](const ConvexShape& a, const ConvexShape& b, double scale) {
      return depth_derivatives({&a, *Pose::from_matrix(pair.pose_a.rotation(), Vec3::Zero())},
                               {&b, *Pose::from_matrix(pair.pose_b.rotation(), scale * offset)}, scratch);
    };
    const DepthDerivatives one = posed(pair.a, pair.b, 1);
    if (!one.stable_features) continue;
    for (const double scale : {0x1p-400, 0x1p300}) {
      const DepthDerivatives d = posed(times(pair.a, scale), times(pair.b, scale), scale);
      EXPECT_LT((d.answer.witness_a / scale - one.answer.witness_a).norm(), 1e-12) << i;
      EXPECT_LT((d.answer.witness_b / scale - one.answer.witness_b).norm(), 1e-12) << i;
      ++judged;
    }
  }
  EXPECT_GT(judged, 20);
}

/// The command `derivative_pairs` judges the same by the hundred thousand.
TEST(Derivatives, AgreeWithCentralDifferences) {
  Scratch scratch;
  constexpr double kStep = 1e-5;
  int judged = 0, features = 0;
  for (const auto family :
       {DerivativeFamily::polytopes, DerivativeFamily::rounded, DerivativeFamily::round, DerivativeFamily::curved}) {
    const bool curved = family == DerivativeFamily::curved;
    for (std::uint64_t i = 0; i < (curved ? 40 : 150); ++i) {
      const oracle::PosedPairCase pair = oracle::derivative_case(family, 1, i);
      if (runner_up_within(pair, 1e-3, kStep, scratch)) continue;
      const oracle::GradientJudgement g = judge_gradient(pair, kStep, scratch);
      EXPECT_TRUE(g.one_slope) << pair.kind << " " << i;
      ++judged;
      if (g.derivatives.stable_features && g.one_feature_slope) {
        ++features;
        EXPECT_LE(g.feature_error, curved ? 6e-2 : 1e-4) << pair.kind << " " << i;
      }
      EXPECT_TRUE(g.derivatives.unique_direction) << pair.kind << " " << i;
      EXPECT_LE(g.gradient_error, curved ? 1e-4 : 1e-6) << pair.kind << " " << i;
    }
  }
  EXPECT_GT(judged, 200);
  EXPECT_GT(features, 200);
}

/// A cylinder with two ways out whose depths differ by less than a step: each has its derivatives, and the differences
/// have none.
TEST(Derivatives, DifferencesAcrossARunnerUpAreNoDerivative) {
  Scratch scratch;
  const oracle::PosedPairCase pair = oracle::derivative_case(DerivativeFamily::curved, 2303, 53);
  const oracle::GradientJudgement g = judge_gradient(pair, 1e-5, scratch);
  EXPECT_TRUE(g.derivatives.unique_direction);
  EXPECT_FALSE(g.one_slope);
  EXPECT_FALSE(g.one_feature_slope);
  EXPECT_GT(g.gradient_error, 1e-2);
}

/// A lean of 1e-5 from a normal that all but crosses a disc, or that meets a flat ellipsoid, covers an arc longer than
/// a flat must be; it bends all the same.
TEST(Derivatives, ArcsNextToTheNormalAreNoFlats) {
  Scratch scratch;
  // A cone's rim, 1.4 degrees off its disc, over the side of another cone.
  const oracle::PosedPairCase rim = oracle::derivative_case(DerivativeFamily::curved, 2306, 2323);
  const ConvexShape lens = *ConvexShape::ellipsoid({.7, .9, .02}), ball = *ConvexShape::ellipsoid({.5, .8, .6});
  const ConvexShape hat = *ConvexShape::cone(.8, .005, 2), egg = *ConvexShape::ellipsoid({.5, .4, .6});
  const Pose tilted = *Pose::from_matrix(Eigen::AngleAxisd(.4, Vec3(.6, .8, 0)).toRotationMatrix(), {.3, .1, 1.2});
  for (const auto& pair : {rim, oracle::PosedPairCase{"lens", lens, ball, {}, tilted},
                           oracle::PosedPairCase{"hat", hat, egg, {}, tilted}}) {
    const oracle::GradientJudgement g = judge_gradient(pair, 1e-5, scratch);
    EXPECT_TRUE(g.one_feature_slope) << pair.kind;
    EXPECT_TRUE(g.derivatives.stable_features) << pair.kind;
    EXPECT_LT(g.feature_error, 5e-3) << pair.kind;
  }
}

TEST(Derivatives, FlagTiesAsTheyWereBuilt) {
  Scratch scratch;
  for (std::uint64_t i = 0; i < 12 * oracle::kTieKinds; ++i) {
    const oracle::TieCase tie = oracle::tie_case(1, i);
    const DepthDerivatives d = depth_derivatives(tie.pair.posed_a(), tie.pair.posed_b(), scratch);
    EXPECT_EQ(d.unique_direction, tie.unique_direction) << tie.pair.kind << " " << i;
    EXPECT_EQ(d.unique_witness, tie.unique_witness) << tie.pair.kind << " " << i;
  }
}

}  // namespace
}  // namespace pd

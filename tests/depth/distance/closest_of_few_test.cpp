/// @file
/// Closest points of bodies of few vertices: the kernels on one instruction set against another, brackets against the
/// tightest answer, planes against every vertex of P.
#include "depth/distance/closest_of_few.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <bit>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "depth/distance/nearest_of_few.hpp"
#include "depth/distance/simplex_lanes.hpp"
#include "pd/depth/penetration_depth.hpp"
#include "pd/depth/scratch.hpp"
#include "scenes/shape_families.hpp"

namespace pd {
namespace detail {

NearestOfFew nearest_of_few_baseline(const FewVertices& bodies, const VertexPair* start, int count,
                                     const NearestGoal& goal);
NearestOfFew nearest_on_simplex_baseline(const LanePoint* corners, int count);
SupportOfFew support_of_few_baseline(const FewVerticesInFrames& bodies, const double (&direction)[3]);
bool add_to_face_baseline(NearestLaneFace& face, const LanePoint& s);

namespace {

constexpr BracketWidth kWidth{1.8e-14, 0};

enum class Kind { round, slender, boxes, flush_boxes, many };

class FewVerticesApart : public ::testing::TestWithParam<Kind> {
 protected:
  struct Bodies {
    ConvexPolytope a, b;
    Pose pose_a, pose_b;
  };

  Vec3 vector() { return {normal_(random_), normal_(random_), normal_(random_)}; }
  double size() { return 0.2 + std::abs(normal_(random_)); }
  ConvexPolytope body() {
    if (GetParam() == Kind::boxes || GetParam() == Kind::flush_boxes) {
      return *ConvexPolytope::box({size(), size(), size()});
    }
    const Vec3 scale = GetParam() == Kind::slender ? Vec3(1, 0.03, 0.05) : Vec3(1, 1, 1);
    std::vector<Vec3> points(GetParam() == Kind::many ? 48 : 8);
    for (Vec3& p : points) p = vector().normalized().cwiseProduct(scale);
    return *ConvexPolytope::from_points(points);
  }
  Mat3 rotation() {
    if (GetParam() == Kind::flush_boxes) return Mat3::Identity();
    return Eigen::Quaterniond{normal_(random_), normal_(random_), normal_(random_), normal_(random_)}
        .normalized()
        .matrix();
  }
  /// Apart, nearly always, by something between 1e-3 and a few sizes.
  Bodies draw() {
    const Vec3 at = vector();
    Bodies bodies{body(), body(), *Pose::from_matrix(rotation(), at), *Pose::from_matrix(rotation(), at)};
    const Vec3 way = vector().normalized();
    Scratch scratch;
    const ConvexShape a(bodies.a), b(bodies.b);
    const double gap = std::pow(10.0, -3 + 0.5 * static_cast<double>(random_() % 8));
    double near = 0, far = 20;
    for (int step = 0; step < 40; ++step) {
      const double middle = (near + far) / 2;
      bodies.pose_b = *Pose::from_matrix(bodies.pose_b.rotation(), at + middle * way);
      const DepthSettings certified{.bracket = Bracket::certified};
      const auto answer = penetration_depth({&a, bodies.pose_a}, {&b, bodies.pose_b}, scratch, certified);
      (answer.distance < gap ? near : far) = middle;
    }
    bodies.pose_b = *Pose::from_matrix(bodies.pose_b.rotation(), at + far * way);
    return bodies;
  }
  DifferenceVertex any_vertex(const PolytopeDifference& difference) {
    const int of_b = static_cast<int>(random_() % static_cast<unsigned>(difference.b().num_vertices()));
    return difference.vertex(static_cast<int>(random_() % static_cast<unsigned>(difference.a().num_vertices())), of_b);
  }

 private:
  std::mt19937_64 random_{17};
  std::normal_distribution<double> normal_;
};

std::uint64_t bits(double x) { return std::bit_cast<std::uint64_t>(x); }

void expect_same_bits(const NearestOfFew& x, const NearestOfFew& y) {
  ASSERT_EQ(x.status, y.status);
  ASSERT_EQ(x.count, y.count);
  EXPECT_EQ(x.supports, y.supports);
  EXPECT_EQ(bits(x.height), bits(y.height));
  for (int k = 0; k < 3; ++k) EXPECT_EQ(bits(x.direction[k]), bits(y.direction[k]));
  for (int i = 0; i < x.count; ++i) {
    EXPECT_EQ(x.simplex[i].a, y.simplex[i].a);
    EXPECT_EQ(x.simplex[i].b, y.simplex[i].b);
    if (x.status != NearestOfFew::Status::nearest) continue;
    EXPECT_EQ(bits(x.weights[i]), bits(y.weights[i]));
    for (int k = 0; k < 3; ++k) EXPECT_EQ(bits(x.points[i][k]), bits(y.points[i][k]));
  }
}

TEST_P(FewVerticesApart, BracketsHoldTheTightestDistance) {
  Scratch scratch;
  int certified = 0, confirmed = 0;
  constexpr int kPairs = 200;
  for (int i = 0; i < kPairs; ++i) {
    SCOPED_TRACE(i);
    const Bodies bodies = draw();
    const ConvexShape a(bodies.a), b(bodies.b);
    const PenetrationDepth truth = penetration_depth({&a, bodies.pose_a}, {&b, bodies.pose_b}, scratch);
    ASSERT_EQ(truth.contact, ContactClass::separated);
    PolytopeDifference difference(bodies.a, bodies.pose_a, bodies.b, bodies.pose_b);
    PosedVerticesPair posed;
    difference.prepare_supports(posed);

    const DifferenceVertex first = any_vertex(difference);
    std::int64_t calls = 0;
    const ClosestPoint found = closest_of_few(difference, {&first, 1}, 0, kWidth, calls);
    EXPECT_GT(calls, 0);
    if (!found.certified) continue;
    ++certified;
    EXPECT_LE(found.lower, truth.distance_upper);
    EXPECT_GE(found.upper, truth.distance_lower);
    EXPECT_LE(found.upper - found.lower, 1.8e-14 * difference.reach() * (1 + 1e-12));
    EXPECT_NEAR((found.point + found.upper * found.normal).norm(), 0, 1e-13 * difference.reach());

    std::vector<VertexPair> simplex;
    for (int k = 0; k < found.count; ++k) simplex.push_back({found.simplex[k].a, found.simplex[k].b});
    const ClosestPoint again = confirm_closest_point(difference, simplex, 0, kWidth);
    if (!again.certified) continue;
    ++confirmed;
    EXPECT_LE(again.lower, truth.distance_upper);
    EXPECT_GE(again.upper, truth.distance_lower);
  }
  EXPECT_GE(certified, kPairs * 98 / 100);
  EXPECT_GE(confirmed, kPairs * 85 / 100);
}

TEST_P(FewVerticesApart, PlanesLieBeyondAndNoVertexInFrontOfThem) {
  for (int i = 0; i < 100; ++i) {
    SCOPED_TRACE(i);
    const Bodies bodies = draw();
    PolytopeDifference difference(bodies.a, bodies.pose_a, bodies.b, bodies.pose_b);
    PosedVerticesPair posed;
    difference.prepare_supports(posed);
    const DifferenceVertex first = any_vertex(difference);
    std::int64_t calls = 0;
    const ClosestPoint nearest = closest_of_few(difference, {&first, 1}, 1e-9, kWidth, calls);
    ASSERT_TRUE(nearest.certified);
    EXPECT_FALSE(plane_of_few(difference, first, nearest.upper, calls));
    for (const double share : {0.0, 0.5, 0.99}) {
      const auto plane = plane_of_few(difference, first, share * nearest.lower, calls);
      ASSERT_TRUE(plane);
      EXPECT_GT(plane->lower, share * nearest.lower * (1 - 1e-15));
      EXPECT_NEAR(plane->normal.norm(), 1, 1e-15);
      for (int p = 0; p < bodies.a.num_vertices(); ++p) {
        for (int q = 0; q < bodies.b.num_vertices(); ++q) {
          ASSERT_LE(difference.vertex(p, q).x.dot(plane->normal), -plane->lower);
        }
      }
    }
  }
}

TEST_P(FewVerticesApart, KernelsGiveTheSameBitsOnEveryInstructionSet) {
  for (int i = 0; i < 100; ++i) {
    SCOPED_TRACE(i);
    const Bodies bodies = draw();
    PolytopeDifference difference(bodies.a, bodies.pose_a, bodies.b, bodies.pose_b);
    PosedVerticesPair posed;
    difference.prepare_supports(posed);
    const Vec3& t = difference.offset();
    const FewVertices few{difference.posed_a(), difference.posed_b(), {t.x(), t.y(), t.z()}};
    const FewVerticesInFrames in_frames{arrays_of(bodies.a), arrays_of(bodies.b), difference.rotation_a().data(),
                                        difference.rotation_b().data()};
    VertexPair start[4];
    LanePoint corners[4];
    for (int k = 0; k < 4; ++k) {
      const DifferenceVertex v = any_vertex(difference);
      start[k] = {v.a, v.b};
      corners[k] = {v.x.x(), v.x.y(), v.x.z(), v.a, v.b};
    }
    const NearestGoal goal{1e-15 * difference.reach(), 1e3, 0};
    for (int count = 1; count <= 4; ++count) {
      expect_same_bits(nearest_of_few(few, start, count, goal), nearest_of_few_baseline(few, start, count, goal));
      if (count == 4) continue;
      expect_same_bits(nearest_on_simplex(corners, count), nearest_on_simplex_baseline(corners, count));
    }
    const Vec3 d = vector();
    const SupportOfFew x = support_of_few(in_frames, {d.x(), d.y(), d.z()});
    const SupportOfFew y = support_of_few_baseline(in_frames, {d.x(), d.y(), d.z()});
    EXPECT_EQ(x.ids.a, y.ids.a);
    EXPECT_EQ(x.ids.b, y.ids.b);
    for (int k = 0; k < 3; ++k) {
      EXPECT_EQ(bits(x.on_a[k]), bits(y.on_a[k]));
      EXPECT_EQ(bits(x.on_b[k]), bits(y.on_b[k]));
    }
  }
}

TEST_P(FewVerticesApart, WhatHoldsTheOriginIsLeftToOthers) {
  for (int i = 0; i < 100; ++i) {
    const Bodies bodies = draw();
    const Pose pose_b = *Pose::from_matrix(bodies.pose_b.rotation(), bodies.pose_a.apply(bodies.a.centre()) -
                                                                         bodies.pose_b.rotation() * bodies.b.centre());
    PolytopeDifference difference(bodies.a, bodies.pose_a, bodies.b, pose_b);
    PosedVerticesPair posed;
    difference.prepare_supports(posed);
    const DifferenceVertex first = any_vertex(difference);
    std::int64_t calls = 0;
    EXPECT_FALSE(closest_of_few(difference, {&first, 1}, 0, kWidth, calls).certified);
    EXPECT_FALSE(plane_of_few(difference, first, 0, calls));
  }
}

TEST(ManyVerticesApart, BracketsHoldTheTightestDistance) {
  using scenes::PairFamily;
  Scratch scratch;
  int pairs = 0, certified = 0;
  for (const PairFamily family : {PairFamily::sphere, PairFamily::needle, PairFamily::prism, PairFamily::grid}) {
    for (std::uint64_t seed = 0; seed < 30; ++seed) {
      SCOPED_TRACE(std::string(scenes::to_string(family)) + " " + std::to_string(seed));
      const scenes::PointPair pair =
          scenes::make_pair(family, seed % 2 == 0 ? 100 : 600, scenes::DepthClass::gap, seed);
      const ConvexPolytope a = *ConvexPolytope::from_points(pair.a), b = *ConvexPolytope::from_points(pair.b);
      const ConvexShape shape_a(a), shape_b(b);
      const PenetrationDepth truth = penetration_depth({&shape_a, pair.pose_a}, {&shape_b, pair.pose_b}, scratch);
      ASSERT_EQ(truth.contact, ContactClass::separated);
      const PolytopeDifference difference(a, pair.pose_a, b, pair.pose_b);
      const DifferenceVertex first = difference.vertex(0, b.num_vertices() - 1);
      std::vector<std::int32_t> stack;
      std::int64_t calls = 0;
      const ClosestPoint found = closest_point(difference, {&first, 1}, 0, kWidth, stack, calls);
      ++pairs;
      if (!found.certified) continue;
      ++certified;
      EXPECT_LE(found.lower, truth.distance_upper);
      EXPECT_GE(found.upper, truth.distance_lower);
      EXPECT_LE(found.upper - found.lower, 1.8e-14 * difference.reach());
    }
  }
  EXPECT_GT(certified, pairs * 9 / 10);
}

TEST(ManyVerticesApart, FacesAreTheSameBitsOnEachInstructionSet) {
  scenes::Random random(41);
  for (int search = 0; search < 200; ++search) {
    NearestLaneFace face{}, baseline{};
    const Vec3 away = 1.2 * random.direction();
    for (std::int32_t id = 0; id < 8; ++id) {
      const Vec3 x = away + random.direction();
      const LanePoint s{x.x(), x.y(), x.z(), id, id};
      const bool outside = add_to_face(face, s);
      ASSERT_EQ(outside, add_to_face_baseline(baseline, s));
      if (!outside) break;
      EXPECT_EQ(bits(face.length), bits(baseline.length));
      ASSERT_EQ(face.count, baseline.count);
      for (int i = 0; i < face.count; ++i) {
        EXPECT_EQ(face.corners[i].a, baseline.corners[i].a);
        EXPECT_EQ(bits(face.weights[i]), bits(baseline.weights[i]));
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, FewVerticesApart,
                         ::testing::Values(Kind::round, Kind::slender, Kind::boxes, Kind::flush_boxes, Kind::many));

}  // namespace
}  // namespace detail
}  // namespace pd

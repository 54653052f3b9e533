/// @file
/// A search that is observed: what is shown is true of P as the caller named A and B, and the answer is the same.

#include "pd/depth/search_observer.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "pd/depth/penetration_depth.hpp"
#include "pd/depth/scratch.hpp"
#include "scenes/shape_families.hpp"

namespace pd {
namespace {

struct Record final : SearchObserver {
  void on_step(const SearchStep& step) override { steps.push_back(step); }
  void on_end(const SearchEnd& end) override { ends.push_back(end); }
  std::vector<SearchStep> steps;
  std::vector<SearchEnd> ends;
};

/// The largest <b - a, n> over the vertices, by looking at all of them.
double height_of_difference(const PosedShape& a, const PosedShape& b, const Vec3& n) {
  double highest = -1e300, lowest = 1e300;
  for (int v = 0; v < b.shape->polytope()->num_vertices(); ++v) {
    highest = std::max(highest, b.pose.apply(b.shape->polytope()->vertex(v)).dot(n));
  }
  for (int v = 0; v < a.shape->polytope()->num_vertices(); ++v) {
    lowest = std::min(lowest, a.pose.apply(a.shape->polytope()->vertex(v)).dot(n));
  }
  return highest - lowest;
}

void expect_true_steps(const Record& record, const PosedShape& a, const PosedShape& b, double depth) {
  for (const SearchStep& step : record.steps) {
    ASSERT_EQ(step.faces.size(), step.distances.size());
    ASSERT_GE(step.nearest, 0);
    const auto nearest = static_cast<std::size_t>(step.nearest);
    const double height = height_of_difference(a, b, step.normal);
    EXPECT_NEAR(step.support.dot(step.normal), height, 1e-6 * (1 + std::abs(height)));
    for (const Vec3& x : step.vertices) EXPECT_LE(x.dot(step.normal), height + 1e-12);
    // The face lies across the normal at its distance, its corners counter-clockwise from outside.
    const auto corner = [&](std::size_t i) { return step.vertices[static_cast<std::size_t>(step.faces[nearest][i])]; };
    EXPECT_NEAR(corner(0).dot(step.normal), step.distances[nearest], 1e-9);
    EXPECT_GT((corner(1) - corner(0)).cross(corner(2) - corner(0)).dot(step.normal), 0);
    EXPECT_LE(step.lower, depth + 1e-12);
    EXPECT_GE(step.upper, depth - 1e-12);
  }
}

TEST(SearchObserver, IsShownWhatHappensAndChangesNothing) {
  Scratch plain, observed;
  int steps = 0, swapped = 0;
  for (const scenes::PairFamily family : {scenes::PairFamily::sphere, scenes::PairFamily::prism}) {
    for (std::uint64_t seed = 0; seed < 10; ++seed) {
      const scenes::PointPair points = scenes::make_pair(family, 20, scenes::DepthClass::mid, seed);
      const ConvexShape shape_a(*ConvexPolytope::from_points(points.a));
      const ConvexShape shape_b(*ConvexPolytope::from_points(points.b));
      const PosedShape a{&shape_a, points.pose_a}, b{&shape_b, points.pose_b};
      for (const bool swap : {false, true}) {
        const PosedShape &first = swap ? b : a, &second = swap ? a : b;
        Record record;
        observe_searches(observed, &record);
        const PenetrationDepth shown = penetration_depth(first, second, observed);
        observe_searches(observed, nullptr);
        const PenetrationDepth hidden = penetration_depth(first, second, plain);
        EXPECT_EQ(shown.depth, hidden.depth);
        EXPECT_EQ(shown.normal, hidden.normal);
        EXPECT_EQ(shown.witness_a, hidden.witness_a);
        ASSERT_FALSE(record.steps.empty());
        ASSERT_FALSE(record.ends.empty());
        EXPECT_EQ(record.ends.front().arithmetic, "double");
        expect_true_steps(record, first, second, shown.depth);
        if (record.ends.size() == 1) {
          EXPECT_GT(record.ends[0].normal.dot(shown.normal), 1 - 1e-9);
        }
        steps += static_cast<int>(record.steps.size());
        swapped += swap ? 1 : 0;
      }
    }
  }
  EXPECT_GT(steps, 100);
  EXPECT_EQ(swapped, 20);
}

std::string arithmetics(const PosedShape& a, const PosedShape& b) {
  Scratch scratch;
  Record record;
  observe_searches(scratch, &record);
  (void)penetration_depth(a, b, scratch);
  std::string words;
  for (const SearchEnd& end : record.ends) {
    words += std::string(end.arithmetic) + ": " + std::string(end.outcome) + ", ";
  }
  return words;
}

TEST(SearchObserver, SeesExactArithmeticWhereDoublesCannotTell) {
  const ConvexShape box(ConvexPolytope::box({1, 1, 1}).value());
  const Pose touching = Pose::from_matrix(Mat3::Identity(), {0.25, 0.5, 2}).value();
  EXPECT_EQ(arithmetics({&box, Pose()}, {&box, touching}), "double: undecided, exact: touching, ");
  const ConvexShape capsule = ConvexShape::capsule(0.5, 1, 2).value();
  const Pose inside = Pose::from_matrix(Mat3::Identity(), {0.3, 0.2, 0.1}).value();
  EXPECT_EQ(arithmetics({&box, Pose()}, {&capsule, inside}), "double: certified, ");
}

TEST(SearchObserver, RuledBodiesNextToContactReachTheirBracket) {
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  const auto direction = [&] { return Vec3{normal(random), normal(random), normal(random)}.normalized(); };
  // A prism of more facets than are looked at one by one.
  std::vector<Vec3> corners;
  for (int k = 0; k < 140; ++k) {
    const double angle = 2 * 3.14159265358979 * k / 140;
    for (const double z : {-0.4, 0.4}) corners.emplace_back(std::cos(angle), 0.7 * std::sin(angle), z);
  }
  const ConvexShape prism(ConvexPolytope::from_points(corners).value());
  const ConvexShape cone = ConvexShape::cone(0.5, 1, 2).value();
  for (int trial = 0; trial < 240; ++trial) {
    // Ruled bodies a hair inside each other, from 1e-9 down to 1e-12.
    const double deep = std::pow(10.0, -9 - trial % 4);
    const double angle = 3 * normal(random);
    const Mat3 turned = Eigen::AngleAxisd(angle, direction()).toRotationMatrix();
    const PosedShape a{&prism, Pose()};
    PosedShape b{&cone, Pose::from_trusted_matrix(turned, 4 * direction())};
    Scratch scratch;
    const PenetrationDepth apart = penetration_depth(a, b, scratch);
    ASSERT_EQ(apart.contact, ContactClass::separated);
    b.pose = Pose::from_trusted_matrix(turned, b.pose.translation() + (apart.distance + deep) * apart.normal);
    const std::string words = arithmetics(a, b);
    EXPECT_EQ(words.rfind("double: ", 0), 0U) << words;
    const PenetrationDepth answer = penetration_depth(a, b, scratch);
    ASSERT_NE(answer.contact, ContactClass::separated);
    // The width is a share of the pair's size: `touching` allows as much.
    EXPECT_TRUE(answer.bracket_reached || answer.upper - answer.lower <= 4e-12) << deep << " " << words;
  }
}

}  // namespace
}  // namespace pd

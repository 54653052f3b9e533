/// @file
/// Cylinders and cones in polytopes: against a sweep of directions, with bodies that lie flush on each other, and
/// points that lie in both bodies.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "oracle/curved_oracle.hpp"
#include "pd/depth/penetration_depth.hpp"
#include "pd/depth/scratch.hpp"
#include "scenes/shape_families.hpp"

namespace pd::detail {
namespace {

using scenes::Random;

/// Thin and flat ones among them.
double random_size(Random& random) {
  return random.integer(0, 3) == 0 ? random.uniform(0.02, 0.2) : random.uniform(0.4, 1.2);
}

ConvexShape random_revolution(Random& random) {
  const double radius = random_size(random), half_height = random_size(random);
  const int axis = random.integer(0, 2);
  return random.integer(0, 1) == 0 ? *ConvexShape::cylinder(radius, half_height, axis)
                                   : *ConvexShape::cone(radius, half_height, axis);
}

ConvexShape random_polytope(Random& random) {
  if (random.integer(0, 1) == 0) {
    return *ConvexPolytope::box({random_size(random), random_size(random), random_size(random)});
  }
  scenes::Points points = scenes::sphere_hull(random.integer(4, 40), random);
  const Vec3 sizes{random_size(random), random_size(random), random_size(random)};
  for (Vec3& p : points) p = p.cwiseProduct(sizes);
  return *ConvexPolytope::from_points(points);
}

/// By how much a point lies outside a body, at most.
double outside(const PosedShape& body, const Vec3& point) {
  const Vec3 p = body.pose.rotation().transpose() * (point - body.pose.translation());
  if (const ConvexPolytope* polytope = body.shape->polytope()) {
    double most = -1e300;
    for (int f = 0; f < polytope->num_facets(); ++f) {
      const Vec3 corner = polytope->vertex(polytope->facet_vertices(f)[0]);
      most = std::max(most, polytope->facet_normal(f).dot(p - corner));
    }
    return most;
  }
  const auto* cylinder = std::get_if<Cylinder>(&body.shape->core());
  const auto* cone = std::get_if<Cone>(&body.shape->core());
  const int axis = cylinder ? cylinder->axis : cone->axis;
  Vec3 across = p;
  across[axis] = 0;
  if (cylinder) return std::max(across.norm() - cylinder->radius, std::abs(p[axis]) - cylinder->half_height);
  const double radius = cone->radius * (cone->half_height - p[axis]) / (2 * cone->half_height);
  return std::max(across.norm() - radius, -p[axis] - cone->half_height);
}

/// What every answer promises, of P's own height in long double, and how near to both bodies the points are.
void check_answer(const PosedShape& a, const PosedShape& b, const PenetrationDepth& answer, const std::string& what) {
  ASSERT_EQ(answer.contact, ContactClass::overlapping) << what;
  ASSERT_TRUE(answer.bracket_reached) << what;
  ASSERT_GE(answer.upper, oracle::difference_support(a, b, answer.normal)) << what;
  ASSERT_LE(answer.lower, oracle::sweep_directions(a, b, 150, 3).least) << what;
  ASSERT_LE(outside(a, answer.witness_a), 1e-4) << what;
  ASSERT_LE(outside(b, answer.witness_b), 1e-4) << what;
  ASSERT_LE((answer.witness_b - answer.witness_a - answer.translation).norm(), 1e-14) << what;
}

/// Asks about many pairs, and counts those that overlap.
class Questions {
 public:
  /// The round body is A in every second pair. False where the bodies do not overlap; `a` and `b` are who was asked.
  bool ask(const PosedShape& round, const PosedShape& polytope) {
    a = asked % 2 == 0 ? round : polytope;
    b = asked % 2 == 0 ? polytope : round;
    const PenetrationDepth answer = penetration_depth(a, b, scratch_, {.bracket = Bracket::certified});
    const std::string pair = "pair " + std::to_string(asked++);
    if (answer.contact != ContactClass::overlapping) return false;
    ++overlapping;
    check_answer(a, b, answer, pair);
    return true;
  }

  PosedShape a{nullptr, Pose()}, b{nullptr, Pose()};
  int asked = 0, overlapping = 0;

 private:
  Scratch scratch_;
};

TEST(RevolutionInPolytope, IsThatOfASweepOfDirections) {
  Random random(3);
  Questions questions;
  for (int i = 0; i < 1500; ++i) {
    const ConvexShape round = random_revolution(random), polytope = random_polytope(random);
    const PosedShape posed_round{&round, random.pose(Vec3::Zero())};
    const PosedShape posed_polytope{&polytope, random.pose(random.vector(0, 1.5))};
    if (questions.ask(posed_round, posed_polytope)) {
      ASSERT_FALSE(HasFatalFailure());
    } else {
      ASSERT_LE(oracle::sweep_directions(questions.a, questions.b, 150, 3).least, 1e-11) << "pair " << i;
    }
  }
  EXPECT_GT(questions.overlapping, 600);
}

/// Along each other's axes, in the middle of each other or moved along one, two or three axes: facets, discs, edges and
/// lines of mantles lie flush on each other.
TEST(RevolutionInPolytope, OfBodiesThatLieFlush) {
  Random random(5);
  Questions questions;
  for (int i = 0; i < 1500; ++i) {
    const ConvexShape round = random_revolution(random);
    const bool regular = random.integer(0, 1) == 0;
    const double size = random_size(random);
    const ConvexShape box = regular ? *ConvexPolytope::box({size, size, size})
                                    : *ConvexPolytope::box({size, random_size(random), random_size(random)});
    Vec3 way = Vec3::Zero();
    for (int k = random.integer(0, 3); k > 0; --k) way[random.integer(0, 2)] = random.uniform(-1, 1);
    // By a half turn about an axis, by a quarter, or not at all: as far as doubles know a quarter turn.
    const double half = std::sqrt(0.5);
    const std::array<double, 4> turns[] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {half, half, 0, 0}, {half, 0, half, 0}};
    const PosedShape posed_round{&round, *Pose::from_quaternion(turns[random.integer(0, 3)], way)};
    const PosedShape posed_box{&box, *Pose::from_quaternion(turns[random.integer(0, 3)], Vec3::Zero())};
    questions.ask(posed_round, posed_box);
    ASSERT_FALSE(HasFatalFailure());
  }
  EXPECT_GT(questions.overlapping, 600);
}

TEST(RevolutionInPolytope, ACornerNextToTheMantle) {
  const ConvexShape cylinder = *ConvexShape::cylinder(1, 2, 2);
  const ConvexShape box = *ConvexPolytope::box({1, 1, 0.5});
  // An edge of the box runs along the axis, a corner of its outline a tenth inside the mantle.
  const double half = std::sqrt(0.5), way = 0.9 + std::sqrt(2.0);
  const Pose on_edge = *Pose::from_matrix(Mat3{{half, -half, 0}, {half, half, 0}, {0, 0, 1}}, Vec3(way, 0, 0));
  Scratch scratch;
  const PenetrationDepth answer = penetration_depth({&cylinder, *Pose::from_quaternion({1, 0, 0, 0}, Vec3::Zero())},
                                                    {&box, on_edge}, scratch, {.bracket = Bracket::certified});
  EXPECT_EQ(answer.contact, ContactClass::overlapping);
  EXPECT_NEAR(answer.depth, 0.1, 1e-7);
  EXPECT_NEAR(std::abs(answer.normal.x()), 1, 1e-6);
}

}  // namespace
}  // namespace pd::detail

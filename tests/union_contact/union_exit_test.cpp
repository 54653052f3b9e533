// The way out of a union in doubles is the exact one, but for slots that are narrower than a seam.
#include "pd/union_contact/union_exit.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>
#include <span>
#include <vector>

#include "pd/compound/compound_depth.hpp"
#include "pd/depth/penetration_depth.hpp"
#include "pd/depth/scratch.hpp"
#include "pd/shape/compound.hpp"

namespace pd::test {
namespace {

constexpr UnionExit::Limits kManyFacets{1 << 14, 0x1p-21};

ConvexShape box(const Vec3& half) {
  std::vector<Vec3> corners;
  for (int i = 0; i < 8; ++i) {
    corners.emplace_back(i & 1 ? half.x() : -half.x(), i & 2 ? half.y() : -half.y(), i & 4 ? half.z() : -half.z());
  }
  return ConvexShape(*ConvexPolytope::from_points(corners));
}

Pose at(const Vec3& place, const Mat3& turned = Mat3::Identity()) { return Pose::from_trusted_matrix(turned, place); }

class RandomUnions {
 public:
  explicit RandomUnions(unsigned seed) : random_(seed) {}
  /// Points of a hull that hang together about a place.
  std::vector<Compound::Part> body(int count, const Vec3& place) {
    std::vector<Compound::Part> parts;
    for (int i = 0; i < count; ++i) {
      std::vector<Vec3> points;
      for (int k = 0; k < 9; ++k) points.push_back(0.5 * vector());
      const Vec3 axis = vector().normalized();
      const Mat3 turned = Eigen::AngleAxisd(3 * number(), axis).toRotationMatrix();
      parts.push_back({ConvexShape(*ConvexPolytope::from_points(points)), at(place + 0.5 * vector(), turned)});
    }
    return parts;
  }
  double number() { return 2 * std::generate_canonical<double, 53>(random_) - 1; }
  Vec3 vector() {
    const double x = number(), y = number();
    return {x, y, number()};
  }

 private:
  std::mt19937_64 random_;
};

std::vector<PosedShape> posed(const std::vector<Compound::Part>& parts) {
  std::vector<PosedShape> list;
  for (const Compound::Part& part : parts) list.push_back({&part.shape, part.pose});
  return list;
}

TEST(UnionExit, IsTheExactWay) {
  RandomUnions random(11);
  Scratch scratch;
  UnionExit exit;
  int corners = 0;
  for (int i = 0; i < 200; ++i) {
    SCOPED_TRACE(i);
    const auto parts_a = random.body(1 + i % 5, Vec3::Zero());
    const auto parts_b = random.body(1 + i / 5 % 4, 0.3 * random.vector());
    const Compound a = *Compound::from_parts(parts_a), b = *Compound::from_parts(parts_b);
    const UnionDepth exact = *penetration_depth(PosedCompound{&a, Pose()}, PosedCompound{&b, Pose()}, scratch);
    UnionExit::Way way;
    const auto outcome = exit.find(posed(parts_a), posed(parts_b), kManyFacets, scratch, way);
    if (exact.depth < 1e-3) continue;
    ASSERT_EQ(outcome, UnionExit::Outcome::found);
    EXPECT_NEAR(way.by.norm(), exact.depth, 1e-4 * exact.depth);
    // Between two facets, where neither part's own normal leads straight out.
    const PosedShape last_a = posed(parts_a)[way.a], last_b = posed(parts_b)[way.b];
    const PosedShape moved{last_a.shape, at(last_a.pose.translation() + way.by, last_a.pose.rotation())};
    const PenetrationDepth left = penetration_depth(moved, last_b, scratch);
    EXPECT_LT(std::abs(left.signed_distance()), 1e-4);
    if (left.normal.dot(way.by) < 0.99 * way.by.norm()) ++corners;
  }
  EXPECT_GT(corners, 10);
}

TEST(UnionExit, SaysWhatIsApart) {
  Scratch scratch;
  UnionExit exit;
  const ConvexShape shape = box(Vec3(.5, .5, .5));
  const std::vector<PosedShape> a{{&shape, at(Vec3::Zero())}, {&shape, at(Vec3(1, 0, 0))}};
  const std::vector<PosedShape> b{{&shape, at(Vec3(.2, .3, 1.01))}};
  UnionExit::Way way;
  EXPECT_EQ(exit.find(a, b, kManyFacets, scratch, way), UnionExit::Outcome::apart);
}

// Exact signs lead a sheet into the slot between two boxes, which is the nearest place.
TEST(UnionExit, ASeamIsNoWayOut) {
  Scratch scratch;
  UnionExit exit;
  const ConvexShape shape = box(Vec3(.5, .5, .5)), sheet = box(Vec3(0x1p-30, .1, .1));
  const std::vector<Compound::Part> halves{{shape, at(Vec3(-.5 - 1e-7, 0, 0))}, {shape, at(Vec3(.5 + 1e-7, 0, 0))}};
  const std::vector<Compound::Part> beside{{sheet, at(Vec3(-1e-5, .1, .05))}};
  const Compound a = *Compound::from_parts(beside), b = *Compound::from_parts(halves);
  EXPECT_LT(penetration_depth(PosedCompound{&a, Pose()}, PosedCompound{&b, Pose()}, scratch)->depth, 2e-5);
  UnionExit::Way way;
  ASSERT_EQ(exit.find(posed(beside), posed(halves), kManyFacets, scratch, way), UnionExit::Outcome::found);
  EXPECT_NEAR(way.by.norm(), .5, 1e-4);
  EXPECT_GT(way.by.y(), .49);
}

TEST(UnionExit, HasABudget) {
  Scratch scratch;
  UnionExit exit;
  RandomUnions random(3);
  const auto parts_a = random.body(4, Vec3::Zero()), parts_b = random.body(4, Vec3::Zero());
  UnionExit::Way way;
  EXPECT_EQ(exit.find(posed(parts_a), posed(parts_b), {20, 0x1p-21}, scratch, way), UnionExit::Outcome::over_budget);
}

}  // namespace
}  // namespace pd::test

/// @file
/// Class and distance of solids beside unions of boxes, stars and convex polytopes, which other engines answer.
#include <gtest/gtest.h>

#include "pd/compound/compound_depth.hpp"
#include "pd/depth/penetration_depth.hpp"
#include "pd/depth/scratch.hpp"
#include "pd/solid/solid_depth.hpp"
#include "solid_families.hpp"

namespace pd::test {
namespace {

Pose moved(const Vec3& translation) { return *Pose::from_matrix(Mat3::Identity(), translation); }

Pose random_pose(std::mt19937_64& random, double reach) {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> place(-reach, reach);
  Eigen::Vector4d q{normal(random), normal(random), normal(random), normal(random)};
  q.normalize();
  return *Pose::from_quaternion({q[0], q[1], q[2], q[3]}, {place(random), place(random), place(random)});
}

/// Cells on a grid of half steps: they overlap, touch in faces, edges and corners, and lie apart.
TEST(SolidClass, CellsOfAGrid) {
  std::mt19937_64 random(71);
  Scratch scratch;
  std::array<int, 3> seen{};
  for (int pair = 0; pair < 200; ++pair) {
    const Cells cells_a = random_cells(random, 1 + static_cast<int>(random() % 6));
    const Cells cells_b = random_cells(random, 1 + static_cast<int>(random() % 6));
    const MeshSolid a = solid_of(mesh_of(cells_a)), b = solid_of(mesh_of(cells_b));
    const Compound boxes_a = boxes_of(cells_a), boxes_b = boxes_of(cells_b);
    const auto step = [&] { return 0.5 * static_cast<double>(static_cast<int>(random() % 13) - 6); };
    const Pose pose = moved({step(), step(), step()});
    ContactClass expected = ContactClass::separated;
    double nearest = HUGE_VAL;
    for (const auto& p : cells_a) {
      for (const auto& q : cells_b) {
        double squared = 0, deepest = HUGE_VAL;
        for (std::size_t k = 0; k < 3; ++k) {
          const double low = q[k] + pose.translation()[static_cast<int>(k)] - p[k];
          const double gap = std::max({low - 1, -1 - low, 0.0});
          squared += gap * gap;
          deepest = std::min(deepest, 1 - std::abs(low));
        }
        nearest = std::min(nearest, squared);
        if (deepest > 0) expected = ContactClass::overlapping;
        if (squared == 0 && expected == ContactClass::separated) expected = ContactClass::touching;
      }
    }
    ++seen[static_cast<std::size_t>(expected)];
    const Expected<SolidDepth> found = penetration_depth({&a, Pose()}, {&b, pose}, scratch);
    ASSERT_TRUE(found);
    ASSERT_EQ(found->contact, expected) << "pair " << pair;
    ASSERT_EQ(classify({&b, pose}, {&a, Pose()}), expected) << "pair " << pair;
    if (expected == ContactClass::separated) {
      EXPECT_NEAR(found->distance, std::sqrt(nearest), 1e-14);
      EXPECT_LE(found->distance_lower, found->distance_upper);
      EXPECT_TRUE(found->bracket_reached);
    }
    // Both bodies are turned about one point by one quaternion, whose rotation no double holds.
    if (pair % 8 != 0) continue;
    Mesh turned = mesh_of(cells_b);
    for (Vec3& p : turned.points) p += pose.translation();
    const MeshSolid placed = solid_of(turned);
    const Pose turn = *Pose::from_quaternion({0.36, 0.48, -0.64, 0.48}, Vec3::Zero());
    ASSERT_EQ(classify({&a, turn}, {&placed, turn}), expected) << "turned, pair " << pair;
  }
  for (const int count : seen) EXPECT_GT(count, 5);
}

TEST(SolidClass, CavitiesHoldBodiesApart) {
  Cells shell;
  for (int x = 0; x < 3; ++x) {
    for (int y = 0; y < 3; ++y) {
      for (int z = 0; z < 3; ++z) {
        if (x != 1 || y != 1 || z != 1) shell.insert({x, y, z});
      }
    }
  }
  const MeshSolid hollow = solid_of(mesh_of(shell));
  EXPECT_EQ(hollow.num_shells(), 2);
  const auto cube = [](double half) { return *MeshSolid::from_polytope(*ConvexPolytope::box(Vec3::Constant(half))); };
  const MeshSolid small = cube(0.25), filling = cube(0.5), large = cube(0.625), huge = cube(4);
  const Pose middle = moved({1.5, 1.5, 1.5});
  Scratch scratch;
  const SolidDepth apart = *penetration_depth({&small, middle}, {&hollow, Pose()}, scratch);
  EXPECT_EQ(apart.contact, ContactClass::separated);
  EXPECT_EQ(apart.distance, 0.25);
  EXPECT_EQ(classify({&filling, middle}, {&hollow, Pose()}), ContactClass::touching);
  EXPECT_EQ(classify({&large, middle}, {&hollow, Pose()}), ContactClass::overlapping);
  EXPECT_EQ(classify({&huge, middle}, {&hollow, Pose()}), ContactClass::overlapping);
  EXPECT_EQ(classify({&hollow, Pose()}, {&hollow, Pose()}), ContactClass::overlapping);
}

TEST(SolidClass, StarsBesideTheirTetrahedra) {
  std::mt19937_64 random(5);
  Scratch scratch;
  std::array<int, 3> seen{};
  for (int pair = 0; pair < 60; ++pair) {
    const StarBody star_a = random_star(random, 1, Vec3::Zero()), star_b = random_star(random, pair % 2, {0.25, 0, 0});
    const MeshSolid a = solid_of(mesh_of(star_a)), b = solid_of(mesh_of(star_b));
    const Compound parts_a = star_a.tetrahedra(), parts_b = star_b.tetrahedra();
    const Pose pose_a = random_pose(random, 0.9), pose_b = random_pose(random, 0.9);
    const Expected<ContactClass> expected =
        point_in_difference({&parts_a, pose_a}, {&parts_b, pose_b}, Vec3::Zero(), scratch);
    ASSERT_TRUE(expected);
    ASSERT_EQ(classify({&a, pose_a}, {&b, pose_b}), *expected) << pair;
    ++seen[static_cast<std::size_t>(*expected)];
    if (*expected != ContactClass::separated) continue;
    const SolidDepth found = *penetration_depth({&a, pose_a}, {&b, pose_b}, scratch);
    const UnionDepth known = *penetration_depth({&parts_a, pose_a}, {&parts_b, pose_b}, scratch);
    EXPECT_NEAR(found.distance, known.distance, 1e-13 * (1 + known.distance));
    EXPECT_LE(found.distance_lower, known.distance_upper);
    EXPECT_GE(found.distance_upper, known.distance_lower);
  }
  EXPECT_GT(seen[static_cast<std::size_t>(ContactClass::overlapping)], 10);
  EXPECT_GT(seen[static_cast<std::size_t>(ContactClass::separated)], 10);
}

}  // namespace
}  // namespace pd::test

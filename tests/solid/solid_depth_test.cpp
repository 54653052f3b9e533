/// @file
/// Depth of solids beside the same bodies as unions of boxes and of tetrahedra.
#include "pd/solid/solid_depth.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "pd/compound/compound_depth.hpp"
#include "pd/depth/penetration_depth.hpp"
#include "pd/depth/scratch.hpp"
#include "pd/solid/solid_parts.hpp"
#include "solid_families.hpp"

namespace pd::test {
namespace {

Pose moved(const Vec3& translation) { return *Pose::from_matrix(Mat3::Identity(), translation); }

TEST(SolidDepth, CellsOfAGrid) {
  std::mt19937_64 random(9);
  Scratch scratch;
  int overlapping = 0;
  for (int pair = 0; pair < 60; ++pair) {
    const Cells cells_a = random_cells(random, 2 + static_cast<int>(random() % 6));
    const Cells cells_b = random_cells(random, 2 + static_cast<int>(random() % 6));
    const MeshSolid a = solid_of(mesh_of(cells_a)), b = solid_of(mesh_of(cells_b));
    const Compound boxes_a = boxes_of(cells_a), boxes_b = boxes_of(cells_b);
    const auto step = [&] { return 0.25 * static_cast<double>(static_cast<int>(random() % 9) - 4); };
    const Pose pose = moved({step(), step(), step()});
    const SolidDepth found = *penetration_depth({&a, Pose()}, {&b, pose}, scratch);
    const UnionDepth known = *penetration_depth({&boxes_a, Pose()}, {&boxes_b, pose}, scratch);
    if (known.contact != ContactClass::overlapping) continue;
    ++overlapping;
    ASSERT_EQ(found.contact, ContactClass::overlapping) << pair;
    EXPECT_TRUE(found.exact);
    EXPECT_TRUE(found.bracket_reached);
    EXPECT_EQ(found.lower, known.lower) << pair;
    EXPECT_NEAR(found.upper, known.upper, 1e-14);
    const Pose away = moved(pose.translation() - found.translation);
    EXPECT_NE(classify({&a, Pose()}, {&b, away}), ContactClass::overlapping) << pair;
  }
  EXPECT_GT(overlapping, 20);
}

TEST(SolidDepth, StarsWithinTheirBracket) {
  std::mt19937_64 random(31);
  Scratch scratch;
  int overlapping = 0;
  for (int pair = 0; pair < 12; ++pair) {
    const StarBody star_a = random_star(random, pair % 2, Vec3::Zero()), star_b = random_star(random, 0, Vec3::Zero());
    const MeshSolid a = solid_of(mesh_of(star_a)), b = solid_of(mesh_of(star_b));
    const Compound parts_a = star_a.tetrahedra(), parts_b = star_b.tetrahedra();
    const Pose pose = moved({0.3, 0.1 * pair, -0.2});
    const UnionDepth known = *penetration_depth({&parts_a, Pose()}, {&parts_b, pose}, scratch);
    const SolidDepth found = *penetration_depth({&a, Pose()}, {&b, pose}, scratch);
    ASSERT_EQ(found.contact, known.contact) << pair;
    if (known.contact != ContactClass::overlapping) continue;
    ++overlapping;
    EXPECT_TRUE(found.bracket_reached) << pair;
    EXPECT_LE(found.lower, known.upper) << pair;
    EXPECT_GE(found.upper, known.lower) << pair;
    EXPECT_NEAR(found.upper, known.upper, 1e-9) << pair;
    EXPECT_NEAR(found.lower, known.lower, 1e-9) << pair;
  }
  EXPECT_GT(overlapping, 5);
}

Pose turned(const Eigen::Vector4d& wxyz, const Vec3& translation) {
  const Eigen::Vector4d unit = wxyz.normalized();
  return *Pose::from_quaternion({unit[0], unit[1], unit[2], unit[3]}, translation);
}

/// A is moved by a little less than the lower end in many directions, and by the translation that is told.
void expect_bracket_holds(const MeshSolid& a, const MeshSolid& b, const Pose& pose, const SolidDepth& found) {
  EXPECT_LE(found.translation.norm(), found.upper * (1 + 1e-15));
  EXPECT_NE(classify({&a, moved(found.translation)}, {&b, pose}), ContactClass::overlapping);
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 40; ++i) {
    const Vec3 unit = i == 0 ? Vec3(found.translation.normalized())
                             : Vec3{normal(random), normal(random), normal(random)}.normalized();
    EXPECT_EQ(classify({&a, moved(0.9999 * found.lower * unit)}, {&b, pose}), ContactClass::overlapping) << i;
  }
}

/// Stars of many faces have too many parts. With too few points, the bracket is wide, says so, and holds.
TEST(SolidDepth, WideBracketsAreSaidAndHold) {
  std::mt19937_64 random(77);
  Scratch scratch;
  const StarBody star = random_star(random, 2, Vec3::Zero());
  const MeshSolid solid = solid_of(mesh_of(star));
  const Pose pose = *Pose::from_quaternion({0.36, 0.48, -0.64, 0.48}, {0.7, 0.5, 0.25});
  for (const std::int64_t points : {0, 3000, 500'000}) {
    const SolidDepth found = *penetration_depth({&solid, Pose()}, {&solid, pose}, scratch, {.max_points = points});
    ASSERT_EQ(found.contact, ContactClass::overlapping);
    EXPECT_FALSE(found.exact);
    EXPECT_EQ(found.bracket_reached, points == 500'000) << "[" << found.lower << ", " << found.upper << "]";
    EXPECT_EQ(found.bracket_reached, found.upper <= 1.01 * found.lower);
    EXPECT_LE(found.work.points, points + 2000);
    expect_bracket_holds(solid, solid, pose, found);
  }
  EXPECT_EQ(penetration_depth({&solid, Pose()}, {&solid, pose}, scratch, {.max_points = -1}).error().where,
            "max_points");
}

/// The same bodies as cells of a grid, whose depth is known, and as meshes of some thousand triangles, which are not
/// cut into convex parts.
TEST(SolidDepth, FineGridsReachTheBracket) {
  constexpr int kFine = 16;
  std::mt19937_64 random(12);
  Scratch scratch;
  int overlapping = 0;
  for (int pair = 0; pair < 6; ++pair) {
    const Cells cells_a = random_cells(random, 3 + pair % 3), cells_b = random_cells(random, 4);
    const MeshSolid a = fine_solid(cells_a, kFine), b = fine_solid(cells_b, kFine);
    const Compound boxes_a = boxes_of(cells_a), boxes_b = boxes_of(cells_b);
    const auto step = [&] { return 0.25 * static_cast<double>(static_cast<int>(random() % 5) - 2) + 0.1; };
    const Pose pose = turned({1, 0.05 * pair, -0.1, 0.2 * (pair % 2)}, {step(), step(), step()});
    const UnionDepth known = *penetration_depth({&boxes_a, Pose()}, {&boxes_b, pose}, scratch);
    if (known.contact != ContactClass::overlapping) continue;
    ++overlapping;
    ASSERT_GT(a.triangles().size(), 2000U);
    const SolidDepth found = *penetration_depth({&a, Pose()}, {&b, pose}, scratch, {.delta = 0.02});
    ASSERT_EQ(found.contact, ContactClass::overlapping) << pair;
    EXPECT_FALSE(found.exact);
    EXPECT_LE(found.lower, known.upper * (1 + 1e-12)) << pair;
    EXPECT_GE(found.upper, known.lower * (1 - 1e-12)) << pair;
    EXPECT_TRUE(found.bracket_reached) << pair << ": [" << found.lower << ", " << found.upper << "], depth "
                                       << known.upper << ", " << found.work.points << " points";
    expect_bracket_holds(a, b, pose, found);
  }
  EXPECT_GE(overlapping, 3);
}

/// True if a part holds a point, up to rounding.
bool holds(const Compound& parts, const Vec3& x) {
  return std::any_of(parts.parts().begin(), parts.parts().end(), [&](const Compound::Part& part) {
    const ConvexPolytope& polytope = *part.shape.polytope();
    for (int f = 0; f < polytope.num_facets(); ++f) {
      const Vec3& corner = polytope.vertex(polytope.facet_vertices(f).front());
      if (polytope.facet_normal(f).normalized().dot(x - corner) > 1e-9) return false;
    }
    return true;
  });
}

TEST(SolidParts, OuterPartsCoverTheSolidAtEveryTolerance) {
  std::mt19937_64 random(77);
  std::uniform_real_distribution<double> share(0, 1);
  for (int i = 0; i < 8; ++i) {
    const Cells cells = random_cells(random, 2 + i % 5, {i, 0, -i});
    const StarBody star = random_star(random, i % 2, {0.5, 1, 2});
    const bool grid = i % 2 == 0;
    const MeshSolid solid = solid_of(grid ? mesh_of(cells) : mesh_of(star));
    const Compound known = grid ? boxes_of(cells) : star.tetrahedra();
    for (const double tolerance : {0.0, 0.3, 20.0}) {
      const auto parts = SolidParts::from_solid(solid, {.tolerance = tolerance});
      ASSERT_TRUE(parts) << i << ": " << parts.error().message;
      for (const Compound::Part& part : known.parts()) {
        const ConvexPolytope& polytope = *part.shape.polytope();
        for (int k = 0; k < 20; ++k) {
          Vec3 x = Vec3::Zero();
          double weights = 0;
          for (int v = 0; v < polytope.num_vertices(); ++v) {
            const double weight = k < polytope.num_vertices() ? (v == k ? 1.0 : 0.0) : share(random);
            x += weight * polytope.vertex(v);
            weights += weight;
          }
          EXPECT_TRUE(holds(parts->outer(), x / weights)) << i << " at tolerance " << tolerance << ", point " << k;
        }
      }
    }
  }
}

TEST(SolidParts, RefusesATolerance) {
  const MeshSolid solid = *MeshSolid::from_polytope(*ConvexPolytope::box({1, 1, 1}));
  for (const double tolerance : {-1.0, std::nan(""), HUGE_VAL}) {
    const auto parts = SolidParts::from_solid(solid, {.tolerance = tolerance});
    ASSERT_FALSE(parts) << tolerance;
    EXPECT_EQ(parts.error().code, ErrorCode::bad_value);
    EXPECT_EQ(parts.error().where, "tolerance");
  }
}

}  // namespace
}  // namespace pd::test

/// @file
/// Convex parts of solids: covers that are known, points drawn at random, and limits.
#include "pd/solid/convex_decomposition.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "pd/depth/penetration_depth.hpp"
#include "pd/depth/scratch.hpp"
#include "solid_families.hpp"

namespace pd::test {
namespace {

/// The cells of rows of '#', one cell thick.
Cells cells_of(const std::vector<std::string>& rows) {
  Cells cells;
  for (std::size_t y = 0; y < rows.size(); ++y) {
    for (std::size_t x = 0; x < rows[y].size(); ++x) {
      if (rows[y][x] == '#') cells.insert({static_cast<int>(x), static_cast<int>(y), 0});
    }
  }
  return cells;
}

SolidDecomposition parts_of(const MeshSolid& solid, double error, bool inside = false) {
  DecompositionSettings settings;
  settings.error = error;
  settings.inside = inside;
  auto found = decompose(solid, settings);
  if (!found) throw std::runtime_error(found.error().message);
  return *std::move(found);
}

/// How far a point reaches beyond the planes of a polytope: at least its distance for points near a facet, and 0 or
/// less inside.
double above(const ConvexPolytope& polytope, const Vec3& x) {
  double most = -HUGE_VAL;
  for (int f = 0; f < polytope.num_facets(); ++f) {
    most = std::max(most, polytope.facet_normal(f).dot(x - polytope.vertex(polytope.facet_vertices(f)[0])));
  }
  return most;
}

double above(const Compound& parts, const Vec3& x) {
  double least = HUGE_VAL;
  for (const Compound::Part& part : parts.parts()) least = std::min(least, above(*part.shape.polytope(), x));
  return least;
}

/// Distance of a point from a triangle, by its corners, edges and plane.
double distance_to(const std::array<Vec3, 3>& t, const Vec3& x) {
  double least = HUGE_VAL;
  const Vec3 n = (t[1] - t[0]).cross(t[2] - t[0]).normalized();
  bool within = true;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 edge = t[(k + 1) % 3] - t[k];
    const double along = std::clamp((x - t[k]).dot(edge) / edge.squaredNorm(), 0.0, 1.0);
    least = std::min(least, (x - t[k] - along * edge).norm());
    within = within && n.dot(edge.cross(x - t[k])) >= 0;
  }
  return within ? std::abs(n.dot(x - t[0])) : least;
}

double distance_to(const MeshSolid& solid, const Vec3& x) {
  double least = HUGE_VAL;
  for (const MeshSolid::Triangle& t : solid.triangles()) {
    least = std::min(
        least, distance_to({solid.vertex(t.vertices[0]), solid.vertex(t.vertices[1]), solid.vertex(t.vertices[2])}, x));
  }
  return least;
}

/// A point of a polytope: the mean of its vertices by random weights, most of them small.
Vec3 point_of(const ConvexPolytope& polytope, std::mt19937_64& random) {
  std::exponential_distribution<double> weight;
  Vec3 sum = Vec3::Zero();
  double total = 0;
  for (int v = 0; v < polytope.num_vertices(); ++v) {
    const double w = std::pow(weight(random), 6);
    sum += w * polytope.vertex(v);
    total += w;
  }
  return sum / total;
}

TEST(ConvexDecomposition, FlatFiguresOfCellsHaveTheirKnownCovers) {
  struct Known {
    std::vector<std::string> rows;
    std::size_t parts;
  };
  for (const Known& known :
       {Known{{"###", "###"}, 1}, Known{{"#.", "##"}, 2}, Known{{"###", ".#."}, 2}, Known{{"#.#", "###"}, 3},
        Known{{"##.", ".##"}, 2}, Known{{"#####", "#...#", "#####"}, 4}, Known{{"#.#.#", "#####"}, 4}}) {
    const Cells cells = cells_of(known.rows);
    const MeshSolid solid = solid_of(mesh_of(cells));
    for (const bool inside : {false, true}) {
      const SolidDecomposition found = parts_of(solid, 1e-3, inside);
      EXPECT_EQ(found.parts.parts().size(), known.parts) << known.rows.front() << inside;
      EXPECT_EQ(found.error, 0) << known.rows.front() << inside;
      EXPECT_TRUE(found.error_reached);
      EXPECT_NEAR(found.parts_volume, static_cast<double>(cells.size()), 1e-12);
      EXPECT_NEAR(found.solid_volume, static_cast<double>(cells.size()), 1e-12);
    }
  }
}

TEST(ConvexDecomposition, CellsInSpaceAreCoveredExactly) {
  std::mt19937_64 random(5);
  for (int round = 0; round < 6; ++round) {
    const Cells cells = random_cells(random, 4 + round % 6);
    const MeshSolid solid = solid_of(mesh_of(cells));
    for (const bool inside : {false, true}) {
      const SolidDecomposition found = parts_of(solid, 1e-6, inside);
      EXPECT_EQ(found.error, 0);
      EXPECT_LE(found.parts.parts().size(), cells.size());
      EXPECT_NEAR(found.parts_volume, static_cast<double>(cells.size()), 1e-12);
      for (const auto& cell : cells) {
        EXPECT_LE(above(found.parts, Vec3(cell[0] + 0.5, cell[1] + 0.5, cell[2] + 0.5)), 0);
      }
    }
  }
}

/// The hull of an L reaches half a cell beyond it, in the middle of the notch's opening.
TEST(ConvexDecomposition, ErrorIsThatOfTheNotch) {
  const MeshSolid solid = solid_of(mesh_of(cells_of({"#.", "##"})));
  const SolidDecomposition one = parts_of(solid, 0.6);
  EXPECT_EQ(one.parts.parts().size(), 1U);
  EXPECT_GE(one.error, 0.5);
  EXPECT_LE(one.error, 0.56);
  EXPECT_EQ(parts_of(solid, 0.49).parts.parts().size(), 2U);
}

TEST(ConvexDecomposition, StarsAreCoveredWithinTheError) {
  std::mt19937_64 random(17);
  for (int round = 0; round < 2; ++round) {
    const StarBody star = random_star(random, round % 2, Vec3(0.5, -2, 1));
    const MeshSolid solid = solid_of(mesh_of(star));
    const Compound tetrahedra = star.tetrahedra();
    for (const double error : {0.05, 0.2}) {
      const SolidDecomposition outer = parts_of(solid, error);
      EXPECT_TRUE(outer.error_reached);
      EXPECT_LE(outer.error, error);
      for (const Compound::Part& part : tetrahedra.parts()) {
        for (int k = 0; k < 20; ++k) {
          EXPECT_LE(above(outer.parts, point_of(*part.shape.polytope(), random)), 1e-12);
        }
      }
      for (const Compound::Part& part : outer.parts.parts()) {
        for (int k = 0; k < 40; ++k) {
          const Vec3 x = point_of(*part.shape.polytope(), random);
          EXPECT_TRUE(above(tetrahedra, x) <= 0 || distance_to(solid, x) <= outer.error);
        }
      }
    }
  }
}

TEST(ConvexDecomposition, InnerPartsLieInStars) {
  std::mt19937_64 random(23);
  Scratch scratch;
  for (int round = 0; round < 2; ++round) {
    const StarBody star = random_star(random, round % 2, Vec3(0.5, -2, 1));
    const MeshSolid solid = solid_of(mesh_of(star));
    const Compound tetrahedra = star.tetrahedra();
    const SolidDecomposition inner = parts_of(solid, 0.1, true);
    EXPECT_TRUE(inner.error_reached);
    EXPECT_LE(inner.error, 0.1);
    for (const Compound::Part& part : inner.parts.parts()) {
      for (int k = 0; k < 40; ++k) {
        EXPECT_LE(above(tetrahedra, point_of(*part.shape.polytope(), random)), 1e-12);
      }
    }
    const ConvexShape point = *ConvexPolytope::from_points(std::vector<Vec3>{Vec3::Zero()});
    for (const Compound::Part& part : tetrahedra.parts()) {
      for (int k = 0; k < 10; ++k) {
        const Pose at = *Pose::from_matrix(Mat3::Identity(), point_of(*part.shape.polytope(), random));
        double least = HUGE_VAL;
        for (const Compound::Part& held : inner.parts.parts()) {
          least = std::min(least, penetration_depth({&held.shape, Pose()}, {&point, at}, scratch).distance_lower);
        }
        EXPECT_LE(least, inner.error);
      }
    }
  }
}

TEST(ConvexDecomposition, LimitsEndTheWorkAndSaySo) {
  const Cells cells = cells_of({"#.#.#", "#####", "#.#.#"});
  const MeshSolid solid = solid_of(mesh_of(cells));
  for (const bool inside : {false, true}) {
    DecompositionSettings settings;
    settings.error = 1e-3;
    settings.inside = inside;
    settings.max_parts = 2;
    const SolidDecomposition found = *decompose(solid, settings);
    EXPECT_FALSE(found.error_reached);
    EXPECT_GT(found.error, settings.error);
    for (const auto& cell : cells) {
      const Vec3 middle(cell[0] + 0.5, cell[1] + 0.5, 0.5);
      EXPECT_TRUE(inside || above(found.parts, middle) <= 0);
    }
  }
}

TEST(ConvexDecomposition, SettingsThatMeanNothingAreRefused) {
  const MeshSolid solid = solid_of(mesh_of(cells_of({"#"})));
  for (const double error : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(), HUGE_VAL}) {
    DecompositionSettings settings;
    settings.error = error;
    const auto found = decompose(solid, settings);
    ASSERT_FALSE(found);
    EXPECT_EQ(found.error().where, "error");
  }
  DecompositionSettings none;
  none.error = 1;
  none.max_parts = 0;
  EXPECT_EQ(decompose(solid, none).error().where, "max_parts");
  none.max_parts = 1;
  none.max_steps = 0;
  EXPECT_EQ(decompose(solid, none).error().where, "max_steps");
}

/// Sizes of a power of two change no decision.
TEST(ConvexDecomposition, ScalesWithTheSolid) {
  std::mt19937_64 random(29);
  const Mesh mesh = mesh_of(random_star(random, 1, Vec3::Zero()));
  const SolidDecomposition found = parts_of(solid_of(mesh), 0.1);
  Mesh large = mesh;
  for (Vec3& p : large.points) p *= 0x1p+60;
  const SolidDecomposition scaled = parts_of(solid_of(large), 0.1 * 0x1p+60);
  EXPECT_EQ(scaled.parts.parts().size(), found.parts.parts().size());
  EXPECT_EQ(scaled.error, found.error * 0x1p+60);
}

}  // namespace
}  // namespace pd::test

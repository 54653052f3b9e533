/// The table of directions against a scan of all vertices, on shapes whose normal cones are round, slender or flat.
#include "shape/support/direction_table.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "pd/shape/convex_polytope.hpp"
#include "scenes/shape_families.hpp"

namespace pd {
namespace {

using scenes::Points;
using scenes::Random;

struct NamedPolytope {
  std::string name;
  ConvexPolytope polytope;
};

std::vector<NamedPolytope> shapes() {
  Random random(31);
  std::vector<NamedPolytope> all;
  const auto add = [&](const std::string& name, const Points& points) {
    auto built = ConvexPolytope::from_points(points);
    ASSERT_TRUE(built.has_value()) << name;
    all.push_back({name, *built});
  };
  for (const int n : {49, 128, 600, 3000}) {
    const std::string size = " " + std::to_string(n);
    add("sphere" + size, scenes::sphere_hull(n, random));
    add("needle" + size, scenes::needle(n, random));
    add("prism" + size, scenes::prism(n));
    add("cloud" + size, scenes::cloud(8 * n, random));
    add("polygon" + size, scenes::polygon(n, random));
    add("sliver" + size, scenes::sliver(n, 1e-6, random));
    add("grid" + size, scenes::integer_points(8 * n, 40, random));
  }
  return all;
}

double highest(const ConvexPolytope& p, const Vec3& d) {
  double most = p.vertex(0).dot(d);
  for (int v = 1; v < p.num_vertices(); ++v) most = std::max(most, p.vertex(v).dot(d));
  return most;
}

/// All kinds of directions: any, along an axis, on the borders of sides and cells, and normals of facets.
std::vector<Vec3> directions(const ConvexPolytope& p, Random& random) {
  std::vector<Vec3> all;
  for (int i = 0; i < 200; ++i) {
    const double length = std::exp2(random.integer(-90, 90));
    all.push_back(length * random.direction());
  }
  for (int axis = 0; axis < 3; ++axis) all.insert(all.end(), {Vec3::Unit(axis), -Vec3::Unit(axis)});
  for (const double x : {-1.0, 1.0}) {
    for (const double y : {-1.0, 0.0, 1.0}) {
      for (const double z : {-1.0, -0.5, 0.0, 0.25, 1.0}) all.push_back({x, y, z});
    }
  }
  for (int i = 0; i < 50; ++i) all.push_back(p.facet_normal(random.integer(0, p.num_facets() - 1)));
  return all;
}

TEST(DirectionTable, FindsTheFarthestVertexUpToSinglePrecision) {
  Random random(32);
  for (const auto& [name, p] : shapes()) {
    if (p.num_vertices() <= 48) continue;
    for (const Vec3& d : directions(p, random)) {
      Vec3 scaled;
      ASSERT_TRUE(detail::scale_for_search(d, scaled));
      const int v = detail::farthest_in_table(p.storage(), scaled);
      ASSERT_GE(v, 0);
      ASSERT_LT(v, p.num_vertices());
      // Three coordinates of the vertex and of the direction rounded once, three products and two sums.
      EXPECT_LE(highest(p, d) - p.vertex(v).dot(d), 16 * 0x1p-24 * p.radius() * d.norm())
          << name << ", " << d.transpose();
    }
  }
}

TEST(DirectionTable, ListsHoldTheFarthestVertexOfEveryDirectionOfTheirCell) {
  Random random(33);
  for (const NamedPolytope& shape : shapes()) {
    const ConvexPolytope& p = shape.polytope;
    if (p.num_vertices() <= 48) continue;
    const ConvexPolytope::Storage& s = p.storage();
    for (int i = 0; i < 300; ++i) {
      const Vec3 d = random.direction();
      auto x = static_cast<float>(d.x()), y = static_cast<float>(d.y()), z = static_cast<float>(d.z());
      detail::into_frame(s.table_frame(), x, y, z);
      const std::int32_t cell = detail::cell_of(x, y, z, s.table_cells);
      ASSERT_GE(cell, 0);
      ASSERT_LT(cell, 6 * s.table_cells * s.table_cells);
      double listed = -std::numeric_limits<double>::infinity();
      const auto look_at = [&](std::int32_t block) {
        for (const std::int32_t v : s.table_blocks[block].id) listed = std::max(listed, p.vertex(v).dot(d));
      };
      look_at(cell);
      for (std::int32_t b = s.table_more[cell]; b < s.table_more[cell + 1]; ++b) look_at(b);
      // A direction within rounding of a cell's border may be looked up next door.
      EXPECT_LE(highest(p, d) - listed, 0x1p-22 * p.radius()) << shape.name;
    }
  }
}

TEST(DirectionTable, ListsAreShort) {
  Random random(34);
  for (const int n : {128, 512, 2048, 8192}) {
    const auto p = ConvexPolytope::from_points(scenes::sphere_hull(n, random));
    const ConvexPolytope::Storage& s = p->storage();
    const int cells = 6 * s.table_cells * s.table_cells;
    EXPECT_LE(s.table_more[cells], 1.5 * cells) << n;
  }
}

TEST(DirectionTable, TakesBoundedMemoryWhateverTheShape) {
  for (const auto& [name, p] : shapes()) {
    const ConvexPolytope::Storage& s = p.storage();
    if (p.num_vertices() <= 48) {
      EXPECT_EQ(s.table_blocks, nullptr) << name;
      continue;
    }
    const int cells = 6 * s.table_cells * s.table_cells;
    EXPECT_LE(s.table_more[cells], 64 + 1.5 * p.num_vertices()) << name;
  }
}

TEST(DirectionTable, CellsCoverTheCubeOnce) {
  // The middle of every square is looked up as that square.
  for (const std::int32_t cells : {1, 2, 3, 8, 64}) {
    for (std::int32_t cell = 0; cell < 6 * cells * cells; ++cell) {
      const std::int32_t side = cell / (cells * cells);
      const int axis = side / 2;
      std::array<float, 3> d{};
      const auto middle = [&](std::int32_t i) {
        return (2 * static_cast<float>(i) + 1) / static_cast<float>(cells) - 1;
      };
      d[axis] = side % 2 == 0 ? 1.0F : -1.0F;
      d[(axis + 1) % 3] = middle(cell / cells % cells);
      d[(axis + 2) % 3] = middle(cell % cells);
      EXPECT_EQ(detail::cell_of(d[0], d[1], d[2], cells), cell) << cells;
    }
  }
}

TEST(DirectionTable, DirectionsThatSinglePrecisionCannotHoldAreRefused) {
  Vec3 scaled;
  EXPECT_FALSE(detail::scale_for_search(Vec3::Zero(), scaled));
  EXPECT_FALSE(detail::scale_for_search({0, 0, 4e-320}, scaled));
  EXPECT_FALSE(detail::scale_for_search({HUGE_VAL, 0, 0}, scaled));
  ASSERT_TRUE(detail::scale_for_search({0, -3e-300, 1e-310}, scaled));
  EXPECT_GE(scaled.cwiseAbs().maxCoeff(), 1);
  EXPECT_LT(scaled.cwiseAbs().maxCoeff(), 2);
}

}  // namespace
}  // namespace pd

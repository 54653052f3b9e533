/// @file
/// Twin hierarchies: every level's polytope and its outer hierarchy, pointers both ways, linear size.
#include "pd/structure/twin_hierarchy.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "pd/numeric/predicates.hpp"
#include "scenes/shape_families.hpp"

namespace pd {
namespace {

ConvexPolytope hull(const scenes::Points& points) { return *ConvexPolytope::from_points(points); }

std::vector<ConvexPolytope> bodies() {
  scenes::Random random(61);
  return {hull(scenes::sphere_hull(400, random)),
          hull(scenes::needle(150, random)),
          hull(scenes::prism(60)),
          hull(scenes::roof(100, {}, random)),
          hull(scenes::box(Vec3(1, 2, 3))),
          hull(scenes::sphere_hull(4, random)),
          hull(scenes::integer_points(300, 4, random))};
}

TEST(TwinHierarchy, EveryLevelIsTheHullOfItsVertices) {
  for (const ConvexPolytope& body : bodies()) {
    const TwinHierarchy twin = *TwinHierarchy::build(body);
    const PolyhedralHierarchy& inner = twin.inner();
    ASSERT_EQ(twin.num_levels(), static_cast<int>(inner.levels().size()));
    for (int i = 0; i < twin.num_levels(); ++i) {
      const ConvexPolytope& level = twin.outer(i).polytope();
      EXPECT_EQ(twin.outer(i).kind(), HierarchyKind::outer);
      EXPECT_EQ(level.num_vertices(), inner.levels()[static_cast<std::size_t>(i)].vertices);
      EXPECT_EQ(level.num_facets(), inner.levels()[static_cast<std::size_t>(i)].facets);
      int there = 0;
      for (int v = 0; v < body.num_vertices(); ++v) {
        const int local = twin.vertex_of_level(i, v);
        EXPECT_EQ(local >= 0, inner.last_level(v) >= i);
        if (local < 0) continue;
        ++there;
        EXPECT_EQ(twin.vertex_of_whole(i, local), v);
        EXPECT_EQ(level.vertex(local), body.vertex(v));
      }
      EXPECT_EQ(there, level.num_vertices());
    }
  }
}

TEST(TwinHierarchy, PointersLeadFromTrianglesToFacetsAndBack) {
  for (const ConvexPolytope& body : bodies()) {
    const TwinHierarchy twin = *TwinHierarchy::build(body);
    const PolyhedralHierarchy& inner = twin.inner();
    for (int i = 0; i < twin.num_levels(); ++i) {
      const ConvexPolytope& level = twin.outer(i).polytope();
      int triangles = 0;
      for (int f = 0; f < inner.num_faces(); ++f) {
        const auto& corners = inner.face(f);
        const int born = inner.creator(f) < 0 ? 0 : inner.last_level(inner.creator(f)) + 1;
        const bool there = born <= i && std::all_of(corners.begin(), corners.end(),
                                                    [&](std::int32_t v) { return inner.last_level(v) >= i; });
        const int facet = twin.facet_of_triangle(i, f);
        ASSERT_EQ(facet >= 0, there);
        if (!there) continue;
        ++triangles;
        const auto back = twin.triangles_of_facet(i, facet);
        EXPECT_EQ(std::count(back.begin(), back.end(), f), 1);
        const auto loop = level.facet_vertices(facet);
        for (const std::int32_t v : corners) {
          EXPECT_EQ(orient3d(level.vertex(loop[0]), level.vertex(loop[1]), level.vertex(loop[2]), body.vertex(v)), 0);
          EXPECT_NE(std::find(loop.begin(), loop.end(), twin.vertex_of_level(i, v)), loop.end());
        }
      }
      EXPECT_EQ(triangles, 2 * level.num_vertices() - 4);
      std::size_t listed = 0;
      for (int facet = 0; facet < level.num_facets(); ++facet) {
        // As many triangles as the facet's polygon has corners, less two.
        EXPECT_EQ(twin.triangles_of_facet(i, facet).size(), level.facet_vertices(facet).size() - 2);
        listed += twin.triangles_of_facet(i, facet).size();
      }
      EXPECT_EQ(static_cast<int>(listed), triangles);
    }
  }
}

TEST(TwinHierarchy, SizesSumToLinear) {
  scenes::Random random(62);
  std::vector<double> bytes;
  for (const int n : {500, 2000}) {
    const ConvexPolytope body = hull(scenes::sphere_hull(n, random));
    const TwinHierarchy twin = *TwinHierarchy::build(body);
    std::int64_t vertices = 0, facets = 0;
    for (int i = 0; i < twin.num_levels(); ++i) {
      for (const auto& level : twin.outer(i).levels()) {
        vertices += level.vertices;
        facets += level.facets;
      }
    }
    EXPECT_LT(static_cast<double>(vertices + facets), 60.0 * body.num_vertices());
    bytes.push_back(static_cast<double>(twin.memory_bytes()) / body.num_vertices());
  }
  EXPECT_LT(bytes[1], 1.1 * bytes[0]);
}

TEST(TwinHierarchy, RefusesFlatBodies) {
  const ConvexPolytope flat = hull({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  const auto refused = TwinHierarchy::build(flat);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::not_full_dimensional);
}

}  // namespace
}  // namespace pd

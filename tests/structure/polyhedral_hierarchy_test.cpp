/// @file
/// Hierarchies: heights and degrees, supports against a scan, and bodies that leave no choice.
#include "pd/structure/polyhedral_hierarchy.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "oracle/wanted_cases.hpp"
#include "scenes/shape_families.hpp"

namespace pd {
namespace {

ConvexPolytope hull(const std::vector<Vec3>& points) { return *ConvexPolytope::from_points(points); }

void check_levels(const ConvexPolytope& body, const PolyhedralHierarchy& hierarchy) {
  const auto levels = hierarchy.levels();
  ASSERT_FALSE(levels.empty());
  EXPECT_EQ(levels[0].vertices, body.num_vertices());
  EXPECT_EQ(levels[0].facets, body.num_facets());
  for (std::size_t i = 0; i < levels.size(); ++i) {
    EXPECT_GE(levels[i].vertices, 4);
    EXPECT_GE(levels[i].facets, 4);
    EXPECT_LE(levels[i].facets, 2 * levels[i].vertices - 4);
    EXPECT_LE(levels[i].vertices, 2 * levels[i].facets - 4);
    EXPECT_LE(levels[i].max_degree, PolyhedralHierarchy::kMaxDegree);
    EXPECT_EQ(levels[i].max_degree == 0, i + 1 == levels.size());
    if (i == 0) continue;
    const bool inner = hierarchy.kind() == HierarchyKind::inner;
    EXPECT_LT(inner ? levels[i].vertices : levels[i].facets, inner ? levels[i - 1].vertices : levels[i - 1].facets);
  }
}

TEST(PolyhedralHierarchy, SupportsAreThoseOfAScan) {
  scenes::Random random(17);
  std::vector<ConvexPolytope> bodies;
  for (const int n : {4, 5, 8, 30, 300, 3000}) bodies.push_back(hull(scenes::sphere_hull(n, random)));
  bodies.push_back(hull(scenes::needle(200, random)));
  bodies.push_back(hull(scenes::prism(100)));
  bodies.push_back(hull(scenes::lens(100, 0.3)));
  bodies.push_back(hull(scenes::roof(100, {}, random)));
  bodies.push_back(hull(scenes::box(Vec3(1, 2, 3))));
  bodies.push_back(hull(scenes::integer_points(200, 4, random)));
  for (const ConvexPolytope& body : bodies) {
    const PolyhedralHierarchy hierarchy = *PolyhedralHierarchy::build(body, HierarchyKind::inner);
    check_levels(body, hierarchy);
    for (int i = 0; i < 200; ++i) {
      const Vec3 d = random.direction();
      double most = -HUGE_VAL;
      for (int v = 0; v < body.num_vertices(); ++v) most = std::max(most, body.vertex(v).dot(d));
      EXPECT_NEAR(body.vertex(hierarchy.support(d)).dot(d), most, 1e-14 * body.radius());
    }
  }
}

TEST(PolyhedralHierarchy, HeightsAreLogarithmic) {
  scenes::Random random(18);
  for (const int n : {100, 1000, 10000}) {
    const ConvexPolytope body = hull(scenes::sphere_hull(n, random));
    for (const HierarchyKind kind : {HierarchyKind::inner, HierarchyKind::outer}) {
      if (kind == HierarchyKind::outer && n > 1000) continue;
      const PolyhedralHierarchy hierarchy = *PolyhedralHierarchy::build(body, kind);
      check_levels(body, hierarchy);
      std::int64_t total = 0;
      for (const auto& level : hierarchy.levels()) total += level.vertices + level.facets;
      EXPECT_LE(static_cast<double>(hierarchy.levels().size()), 4 + 3 * std::log2(n));
      EXPECT_LE(static_cast<double>(total), 20.0 * n);
      const auto& last = hierarchy.levels().back();
      EXPECT_EQ(last.vertices, 4);
      EXPECT_EQ(last.facets, 4);
    }
    const PolyhedralHierarchy inner = *PolyhedralHierarchy::build(body, HierarchyKind::inner);
    std::int64_t products = 0;
    for (int i = 0; i < 200; ++i) (void)inner.support(random.direction(), &products);
    EXPECT_LT(static_cast<double>(products) / 200, 12 * std::log2(n)) << n;
  }
}

TEST(PolyhedralHierarchy, StarsAndPointersRebuildEveryLevel) {
  // From the coarsest level's triangles back: a star comes in where the triangles that its vertex created go.
  scenes::Random random(19);
  for (const auto& points :
       {scenes::sphere_hull(300, random), scenes::prism(60), scenes::integer_points(300, 5, random)}) {
    const ConvexPolytope body = hull(points);
    for (const HierarchyKind kind : {HierarchyKind::inner, HierarchyKind::outer}) {
      const PolyhedralHierarchy h = *PolyhedralHierarchy::build(body, kind);
      const int elements = kind == HierarchyKind::inner ? body.num_vertices() : body.num_facets();
      std::vector<std::vector<int>> created(static_cast<std::size_t>(elements));
      std::set<int> present;
      for (int f = 0; f < h.num_faces(); ++f) {
        if (h.creator(f) >= 0) created[static_cast<std::size_t>(h.creator(f))].push_back(f);
      }
      for (const std::int32_t v : h.coarsest()) {
        for (const auto& s : h.star(v)) present.insert(s.face);
      }
      std::size_t total = 0;
      for (int level = static_cast<int>(h.levels().size()) - 2; level >= 0; --level) {
        for (int v = 0; v < elements; ++v) {
          if (h.last_level(v) != level) continue;
          const auto star = h.star(v);
          total += star.size();
          EXPECT_LE(star.size(), static_cast<std::size_t>(PolyhedralHierarchy::kMaxDegree));
          ASSERT_EQ(created[static_cast<std::size_t>(v)].size() + 2, star.size());
          for (const int f : created[static_cast<std::size_t>(v)]) ASSERT_EQ(present.erase(f), 1);
          for (std::size_t k = 0; k < star.size(); ++k) {
            auto corners = h.face(star[k].face);
            const auto at = std::find(corners.begin(), corners.end(), v);
            ASSERT_NE(at, corners.end());
            std::rotate(corners.begin(), at, corners.end());
            EXPECT_EQ(corners[1], star[k].neighbour);
            EXPECT_EQ(corners[2], star[(k + 1) % star.size()].neighbour);
            ASSERT_TRUE(present.insert(star[k].face).second);
          }
        }
      }
      // Level 0 is the body's own triangles.
      for (const int f : present) EXPECT_EQ(h.creator(f), -1);
      EXPECT_EQ(present.size(), 2 * static_cast<std::size_t>(elements) - 4);
      EXPECT_LE(total, 9 * static_cast<std::size_t>(elements));
      EXPECT_LE(h.memory_bytes(), 600 * static_cast<std::size_t>(elements) + 4096);
    }
  }
}

TEST(PolyhedralHierarchy, SupportsOfEveryLevelWhateverTheDegrees) {
  const int supports = test::wanted_cases("PD_LEVEL_LINES", 20);
  scenes::Random random(test::wanted_seed(20));
  // The apex of the pyramid has every other vertex for a neighbour.
  scenes::Points pyramid{{0, 0, 1}};
  for (int i = 0; i < 2000; ++i) {
    const scenes::Turn t = scenes::turn(i / 2000.0);
    pyramid.emplace_back(t.cosine, t.sine, 0);
  }
  for (const auto& points : {pyramid, scenes::sphere_hull(500, random), scenes::roof(400, {}, random)}) {
    const ConvexPolytope body = hull(points);
    const PolyhedralHierarchy h = *PolyhedralHierarchy::build(body, HierarchyKind::inner);
    for (int level = 0; level < static_cast<int>(h.levels().size()); ++level) {
      for (int i = 0; i < supports; ++i) {
        const Vec3 d = random.direction();
        double most = -HUGE_VAL;
        for (int v = 0; v < body.num_vertices(); ++v) {
          if (h.last_level(v) >= level) most = std::max(most, body.vertex(v).dot(d));
        }
        std::int64_t products = 0;
        const int found = h.support(d, &products, level);
        EXPECT_GE(h.last_level(found), level);
        EXPECT_NEAR(body.vertex(found).dot(d), most, 1e-14 * body.radius());
        EXPECT_LT(products, 600);
      }
    }
  }
}

TEST(PolyhedralHierarchy, BodiesThatLeaveNoChoice) {
  const auto levels = [](const ConvexPolytope& body, HierarchyKind kind) {
    const PolyhedralHierarchy h = *PolyhedralHierarchy::build(body, kind);
    check_levels(body, h);
    return h.levels().size();
  };
  const ConvexPolytope tetrahedron = hull({{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}});
  EXPECT_EQ(levels(tetrahedron, HierarchyKind::inner), 1);
  EXPECT_EQ(levels(tetrahedron, HierarchyKind::outer), 1);
  // No five planes of a box bound a body.
  EXPECT_EQ(levels(*ConvexPolytope::box(Vec3(1, 2, 3)), HierarchyKind::outer), 1);
  EXPECT_GT(levels(*ConvexPolytope::box(Vec3(1, 2, 3)), HierarchyKind::inner), 1);
  // A pyramid must keep its apex, and loses a corner of its base.
  const ConvexPolytope pyramid = hull({{1, 1, 0}, {1, -1, 0}, {-1, 1, 0}, {-1, -1, 0}, {0, 0, 1}});
  EXPECT_EQ(levels(pyramid, HierarchyKind::inner), 2);
  const ConvexPolytope square = hull({{1, 1, 0}, {1, -1, 0}, {-1, 1, 0}, {-1, -1, 0}});
  EXPECT_EQ(PolyhedralHierarchy::build(square, HierarchyKind::inner).error().code, ErrorCode::not_full_dimensional);
}

}  // namespace
}  // namespace pd

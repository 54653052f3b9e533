/// @file
/// Depth along a direction by descending hierarchies: against the portal search on every family, on levels against
/// hulls of their vertices, the counterexample to [D] step 1D as printed, and counted steps.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <utility>

#include "pd/depth/approximate_separation.hpp"
#include "pd/depth/difference_queries.hpp"
#include "pd/depth/directional_depth.hpp"
#include "pd/depth/level_queries.hpp"
#include "pd/depth/penetration_depth.hpp"
#include "pd/depth/scratch.hpp"
#include "scenes/shape_families.hpp"

namespace pd {
namespace {

ConvexPolytope hull(const scenes::Points& points) { return *ConvexPolytope::from_points(points); }

TEST(HierarchyDescent, EqualsThePortalSearchOnEveryFamily) {
  scenes::Random random(51);
  Scratch scratch;
  int overlapping = 0, rays = 0;
  std::int64_t repairs = 0;
  for (int family = 0; family < scenes::kPairFamilies; ++family) {
    for (const int n : {5, 9, 40, 300}) {
      for (const auto depth : {scenes::DepthClass::gap, scenes::DepthClass::shallow, scenes::DepthClass::deep}) {
        const scenes::PointPair pair = make_pair(static_cast<scenes::PairFamily>(family), n, depth, 7);
        const ConvexShape a(hull(pair.a)), b(hull(pair.b));
        if (a.polytope()->affine_dimension() < 3 || b.polytope()->affine_dimension() < 3) continue;
        const auto hierarchy_a = *PolyhedralHierarchy::build(*a.polytope(), HierarchyKind::inner);
        const auto hierarchy_b = *PolyhedralHierarchy::build(*b.polytope(), HierarchyKind::inner);
        const DirectionalHierarchies hierarchies{&hierarchy_a, &hierarchy_b};
        for (int ray = 0; ray < 4; ++ray) {
          Vec3 d = random.direction();
          if (ray == 3) {
            d = random.integer_point(-1, 1);
            d.z() = 1;
          }
          const PosedShape posed_a{&a, pair.pose_a}, posed_b{&b, pair.pose_b};
          const auto found =
              directional_depth(posed_a, posed_b, d, scratch, DirectionalMethod::hierarchy, &hierarchies);
          const auto expected = directional_depth(posed_a, posed_b, d, scratch);
          ++rays;
          overlapping += expected->contact == ContactClass::overlapping ? 1 : 0;
          repairs += found->descent.repairs;
          ASSERT_EQ(found->contact, expected->contact) << family << " " << n;
          ASSERT_EQ(found->lower, expected->lower) << family << " " << n;
          ASSERT_EQ(found->upper, expected->upper) << family << " " << n;
          if (expected->contact != ContactClass::overlapping) continue;
          EXPECT_NEAR(found->normal.dot(expected->normal), 1, 1e-12) << family << " " << n;
        }
      }
    }
  }
  EXPECT_GT(overlapping, 300);
  // What rounding hides from the descent is the exception.
  EXPECT_LT(static_cast<double>(repairs), 0.02 * rays);
}

TEST(HierarchyDescent, TheStepThatFailsAsPrinted) {
  // [D] step 1D with P_i a block, its finer level with a tip on top, and Q above the block, about the tip. H: z = 0.05
  // separates P_i from Q. Q moves down, into P's side: it leaves P below, with its own top, at depth 2.3. But the part
  // of P above H alone lets go of it at depth 0.25, and Q has no part below H at all: the larger of both is 0.25.
  Scratch scratch;
  const scenes::Points block{{-1, -1, -2}, {1, -1, -2}, {-1, 1, -2}, {1, 1, -2},
                             {-1, -1, 0},  {1, -1, 0},  {-1, 1, 0},  {1, 1, 0}};
  scenes::Points with_tip = block;
  with_tip.emplace_back(0, 0, 0.5);
  scenes::Points tip{{0, 0, 0.5}};
  for (const double x : {-0.9, 0.9}) {
    for (const double y : {-0.9, 0.9}) tip.emplace_back(x, y, 0.05);
  }
  scenes::Points small;
  for (const Vec3& corner : scenes::box(Vec3(0.125, 0.125, 0.125))) small.push_back(corner + Vec3(0, 0, 0.25));
  const ConvexShape q(hull(small)), p(hull(with_tip)), cap(hull(tip)), coarse(hull(block));
  const auto depth = [&](const ConvexShape& fixed) {
    return directional_depth({&q, Pose()}, {&fixed, Pose()}, Vec3(0, 0, -1), scratch, DirectionalMethod::hierarchy);
  };
  EXPECT_EQ(depth(coarse)->contact, ContactClass::separated);
  EXPECT_NEAR(depth(cap)->depth, 0.375 - 0.05, 1e-15);
  EXPECT_EQ(depth(p)->depth, 2.375);
  EXPECT_EQ(directional_depth({&q, Pose()}, {&p, Pose()}, Vec3(0, 0, -1), scratch, DirectionalMethod::overlay)->depth,
            2.375);
}

TEST(HierarchyDescent, SmallBodiesAgainstEveryLevel) {
  scenes::Random random(52);
  for (const int n : {20, 200, 1000}) {
    const ConvexPolytope body = hull(n == 200 ? scenes::prism(n) : scenes::sphere_hull(n, random));
    const auto hierarchy = *PolyhedralHierarchy::build(body, HierarchyKind::inner);
    int hits = 0;
    for (int level = 0; level < static_cast<int>(hierarchy.levels().size()); ++level) {
      scenes::Points left;
      for (int v = 0; v < body.num_vertices(); ++v) {
        if (hierarchy.last_level(v) >= level) left.push_back(body.vertex(v));
      }
      ASSERT_EQ(left.size(), static_cast<std::size_t>(hierarchy.levels()[static_cast<std::size_t>(level)].vertices));
      const ConvexShape coarse(hull(left));
      for (const int vertices : {1, 2, 5}) {
        for (int i = 0; i < 10; ++i) {
          const Vec3 at = random.vector(0, 0.5);
          scenes::Points small;
          for (int k = 0; k < vertices; ++k) small.push_back(at + 0.2 * random.direction());
          const ConvexShape shape(hull(small));
          const Vec3 d = random.direction();
          const LevelCrossing found = *crossing_of_level(hierarchy, level, *shape.polytope(), d);
          const LineCrossing line = *line_in_difference({&shape, Pose()}, {&coarse, Pose()}, Vec3::Zero(), d);
          ASSERT_EQ(found.meets, line.crosses) << n << " " << level;
          if (!found.meets) continue;
          ++hits;
          EXPECT_NEAR(found.enter_lower, line.enter_lower, 1e-12);
          EXPECT_NEAR(found.leave_upper, line.leave_upper, 1e-12);
          if (level > 0) continue;
          EXPECT_LE(found.enter_lower, line.enter_upper);
          EXPECT_GE(found.enter_upper, line.enter_lower);
          EXPECT_LE(found.leave_lower, line.leave_upper);
          EXPECT_GE(found.leave_upper, line.leave_lower);
        }
      }
    }
    EXPECT_GT(hits, 50);
  }
}

TEST(HierarchyDescent, StepsGrowAsTheProductOfLogarithms) {
  scenes::Random random(53);
  Scratch scratch;
  for (const int n : {8, 64, 512, 4096}) {
    for (const int m : {8, 512, 4096}) {
      const ConvexShape a(hull(scenes::sphere_hull(n, random))), b(hull(scenes::sphere_hull(m, random)));
      const auto hierarchy_a = *PolyhedralHierarchy::build(*a.polytope(), HierarchyKind::inner);
      const auto hierarchy_b = *PolyhedralHierarchy::build(*b.polytope(), HierarchyKind::inner);
      const DirectionalHierarchies hierarchies{&hierarchy_a, &hierarchy_b};
      std::int64_t most = 0;
      for (int i = 0; i < 20; ++i) {
        const auto found = directional_depth({&a, Pose()}, {&b, Pose()}, random.direction(), scratch,
                                             DirectionalMethod::hierarchy, &hierarchies);
        ASSERT_EQ(found->contact, ContactClass::overlapping);
        most = std::max(most, found->descent.steps);
      }
      // Two rays a query: along the direction and against it.
      EXPECT_LT(static_cast<double>(most), 2000 + 200 * std::log2(n) * std::log2(m)) << n << " " << m;
    }
  }
}

TEST(HierarchyDescent, RefusesByName) {
  const ConvexPolytope box = *ConvexPolytope::box(Vec3(1, 1, 1));
  const ConvexPolytope point = hull({{0, 0, 0}});
  const auto inner = *PolyhedralHierarchy::build(box, HierarchyKind::inner);
  const auto outer = *PolyhedralHierarchy::build(box, HierarchyKind::outer);
  const auto code = [](const Expected<LevelCrossing>& e) { return e.error().code; };
  EXPECT_EQ(code(crossing_of_level(outer, 0, point, Vec3::UnitX())), ErrorCode::unsupported);
  EXPECT_EQ(code(crossing_of_level(inner, 99, point, Vec3::UnitX())), ErrorCode::out_of_range);
  EXPECT_EQ(code(crossing_of_level(inner, 0, point, Vec3::Zero())), ErrorCode::zero_direction);
  EXPECT_EQ(code(crossing_of_level(inner, 0, point, Vec3(0, NAN, 0))), ErrorCode::non_finite);
  scenes::Random random(54);
  EXPECT_EQ(code(crossing_of_level(inner, 0, hull(scenes::sphere_hull(40, random)), Vec3::UnitX())),
            ErrorCode::limit_exceeded);
  const LevelCrossing through = *crossing_of_level(inner, 0, point, Vec3(0, 0, 2));
  EXPECT_TRUE(through.meets);
  EXPECT_EQ(through.enter_lower, -1);
  EXPECT_EQ(through.leave_upper, 1);
}

// A caller may hand over null pointers, hierarchies of other bodies and outer ones; none of them has a ray.
TEST(HierarchyDescent, HierarchiesThatAreNotTheBodiesAreRefused) {
  const ConvexPolytope box = *ConvexPolytope::box(Vec3(1, 1, 1));
  const ConvexPolytope large = *ConvexPolytope::box(Vec3(2, 1, 1));
  const ConvexShape a(box), b(large);
  const PosedShape posed_a{&a, Pose()}, posed_b{&b, Pose()};
  const auto inner_a = *PolyhedralHierarchy::build(box, HierarchyKind::inner);
  const auto inner_b = *PolyhedralHierarchy::build(large, HierarchyKind::inner);
  const auto outer_b = *PolyhedralHierarchy::build(large, HierarchyKind::outer);
  // An equal body with storage of its own is the same body.
  const auto equal_a = *PolyhedralHierarchy::build(*ConvexPolytope::box(Vec3(1, 1, 1)), HierarchyKind::inner);
  Scratch scratch;
  const auto ask = [&](const PolyhedralHierarchy* of_a, const PolyhedralHierarchy* of_b) {
    const DirectionalHierarchies both{of_a, of_b};
    auto ray = directional_depth(posed_a, posed_b, Vec3::UnitX(), scratch, DirectionalMethod::hierarchy, &both);
    ApproximateSeparationSettings settings;
    settings.shot = DirectionalMethod::hierarchy;
    settings.hierarchies = &both;
    const auto rays = approximate_separation(posed_a, posed_b, 0.5, scratch, settings);
    EXPECT_EQ(ray.has_value(), rays.has_value());
    if (!ray && !rays) {
      EXPECT_EQ(ray.error().where, rays.error().where);
    }
    return ray;
  };
  const auto refused = [&](const auto* of_a, const auto* of_b, ErrorCode code, const char* where) {
    const auto found = ask(of_a, of_b);
    ASSERT_FALSE(found.has_value()) << where;
    EXPECT_EQ(found.error().code, code);
    EXPECT_EQ(found.error().where, where);
  };
  refused(static_cast<const PolyhedralHierarchy*>(nullptr), &inner_b, ErrorCode::bad_value, "hierarchies.a");
  refused(&inner_a, static_cast<const PolyhedralHierarchy*>(nullptr), ErrorCode::bad_value, "hierarchies.b");
  refused(&inner_b, &inner_a, ErrorCode::bad_value, "hierarchies.a");
  refused(&inner_a, &outer_b, ErrorCode::unsupported, "hierarchies.b");
  EXPECT_EQ(ask(&inner_a, &inner_b)->depth, 3);
  EXPECT_EQ(ask(&equal_a, &inner_b)->depth, 3);
  // A hierarchy that was moved from holds its levels on.
  PolyhedralHierarchy source = inner_a;
  const PolyhedralHierarchy target = std::move(source);
  EXPECT_EQ(ask(&source, &inner_b)->depth, 3);
  EXPECT_EQ(ask(&target, &inner_b)->depth, 3);
  TwinHierarchy twin = *TwinHierarchy::build(box);
  const TwinHierarchy other = std::move(twin);
  EXPECT_EQ(twin.num_levels(), other.num_levels());
}

}  // namespace
}  // namespace pd

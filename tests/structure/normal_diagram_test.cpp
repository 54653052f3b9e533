/// @file
/// Normal diagrams and the public walk over an overlay: counts, order, stopping, and no allocation once warm.
#include "pd/structure/normal_diagram.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "pd/structure/overlay.hpp"
#include "structure/overlay/overlay_walk.hpp"

namespace pd {
namespace {

ConvexPolytope sphere_hull(int n, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  std::vector<Vec3> points;
  for (int i = 0; i < n; ++i) points.push_back(Vec3{normal(random), normal(random), normal(random)}.normalized());
  return *ConvexPolytope::from_points(points);
}

TEST(NormalDiagram, ArcsTurnAboutTheirEdges) {
  std::mt19937_64 random(1);
  const ConvexPolytope polytope = sphere_hull(50, random);
  const NormalDiagram diagram(polytope);
  EXPECT_EQ(diagram.num_cells() - diagram.num_arcs() + diagram.num_points(), 2);
  for (int h = 0; h < polytope.num_half_edges(); ++h) {
    const NormalDiagram::Arc arc = diagram.arc(h);
    const Vec3 e = polytope.vertex(arc.left_cell) - polytope.vertex(arc.right_cell);
    EXPECT_GT(diagram.point(arc.from).cross(diagram.point(arc.to)).dot(e), 0);
  }
  for (int v = 0; v < diagram.num_cells(); ++v) {
    for (std::size_t k = 0; k < polytope.neighbours(v).size(); ++k) {
      const Vec3& n = diagram.point(diagram.corner(v, static_cast<int>(k)));
      for (int other = 0; other < polytope.num_vertices(); ++other) {
        EXPECT_LE((polytope.vertex(other) - polytope.vertex(v)).dot(n), 1e-14);
      }
    }
  }
}

TEST(NormalDiagram, LocatesTheLowestExtremeVertex) {
  std::mt19937_64 random(2);
  std::uniform_int_distribution<int> coordinate(-2, 2);
  for (int round = 0; round < 500; ++round) {
    std::vector<Vec3> points;
    for (int i = 0; i < 1 + round % 30; ++i) {
      points.push_back(Eigen::Vector3i{coordinate(random), coordinate(random), coordinate(random)}.cast<double>());
    }
    const ConvexPolytope polytope = *ConvexPolytope::from_points(points);
    Vec3 d = Eigen::Vector3i{coordinate(random), coordinate(random), coordinate(random)}.cast<double>();
    if (d.isZero(0)) d = Vec3(0, 0, 1e-300);
    int expected = 0;
    for (int v = 1; v < polytope.num_vertices(); ++v) {
      if (polytope.vertex(v).dot(d) > polytope.vertex(expected).dot(d)) expected = v;
    }
    EXPECT_EQ(NormalDiagram(polytope).locate(d), expected);
  }
}

class Collect final : public OverlayVisitor {
 public:
  explicit Collect(std::int64_t limit) : limit_(limit) {}
  bool visit(std::span<const OverlayFacet> facets) override {
    seen += static_cast<std::int64_t>(facets.size());
    return seen < limit_;
  }
  std::int64_t seen = 0;

 private:
  std::int64_t limit_;
};

TEST(OverlayDoor, CountsOfCubes) {
  const ConvexPolytope cube = *ConvexPolytope::box(Vec3(1, 1, 1));
  Overlay overlay;
  const OverlayCounts united = overlay.count(cube, Pose(), cube, Pose(), OverlayPieces::united);
  EXPECT_EQ(united.total(), 6);
  EXPECT_EQ(united.facet_vertex, 6);
  // Turned about a generic axis: 6 + 6 facets, and K obeys Euler's formula with 6 + 6 + E edge pairs.
  const Pose turned = *Pose::from_quaternion({0.9, 0.3, 0.2, 0.2449489742783178}, Vec3::Zero());
  const OverlayCounts generic = overlay.count(cube, turned, cube, Pose(), OverlayPieces::united);
  EXPECT_EQ(generic.facet_vertex, 6);
  EXPECT_EQ(generic.vertex_facet, 6);
  EXPECT_EQ(overlay.count(cube, turned, cube, Pose(), OverlayPieces::as_walked).total(), generic.total());
}

TEST(OverlayDoor, FlatPairs) {
  const ConvexPolytope square =
      *ConvexPolytope::from_points(std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}});
  const ConvexPolytope needle = *ConvexPolytope::from_points(std::vector<Vec3>{{0, 0, 0}, {0, 0, 1}});
  const ConvexPolytope point = *ConvexPolytope::from_points(std::vector<Vec3>{{3, 4, 5}});
  Overlay overlay;
  const auto count = [&](const ConvexPolytope& a, const ConvexPolytope& b) {
    return overlay.count(a, Pose(), b, Pose(), OverlayPieces::united).total();
  };
  EXPECT_EQ(count(square, needle), 6);  // a box
  EXPECT_EQ(count(needle, square), 6);
  EXPECT_EQ(count(square, square), 0);  // flat
  EXPECT_EQ(count(needle, needle), 0);
  EXPECT_EQ(count(square, point), 0);
  const ConvexPolytope cube = *ConvexPolytope::box(Vec3(1, 1, 1));
  EXPECT_EQ(count(cube, point), 6);
  EXPECT_EQ(count(point, cube), 6);
  EXPECT_EQ(count(cube, needle), 6);
  EXPECT_EQ(count(square, cube), 6);
}

TEST(OverlayDoor, AVisitorMayStop) {
  std::mt19937_64 random(3);
  const ConvexPolytope a = sphere_hull(500, random), b = sphere_hull(500, random);
  Overlay overlay;
  Collect some(1), all(1 << 30);
  overlay.walk(a, Pose(), b, Pose(), OverlayPieces::as_walked, some);
  const OverlayCounts counts = overlay.walk(a, Pose(), b, Pose(), OverlayPieces::as_walked, all);
  EXPECT_LT(some.seen, 1000);
  EXPECT_EQ(all.seen, counts.total());
}

TEST(OverlayDoor, NothingGrowsOnTheSecondWalk) {
  std::mt19937_64 random(4);
  const ConvexPolytope a = sphere_hull(300, random), b = sphere_hull(200, random);
  const Pose pose_a, pose_b;
  const detail::PosedPair pair(a, pose_a, b, pose_b);
  detail::OverlayBuffers buffers;
  const auto walk = [&] {
    std::int64_t count = 0;
    detail::OverlayWalk(pair, buffers).run([&](std::span<const detail::OverlayPiece> block) {
      count += static_cast<std::int64_t>(block.size());
      return true;
    });
    return count;
  };
  const std::int64_t first = walk();
  const std::array<const void*, 5> before{buffers.a.points.data(), buffers.a.half_edges.data(), buffers.b.facets.data(),
                                          buffers.b.cell.data(), buffers.visits.data()};
  EXPECT_EQ(walk(), first);
  const std::array<const void*, 5> after{buffers.a.points.data(), buffers.a.half_edges.data(), buffers.b.facets.data(),
                                         buffers.b.cell.data(), buffers.visits.data()};
  EXPECT_EQ(before, after);
}

}  // namespace
}  // namespace pd

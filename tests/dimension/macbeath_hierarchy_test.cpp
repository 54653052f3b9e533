#include "dimension/backends/macbeath_hierarchy.hpp"

#include <gtest/gtest.h>

#include "dimension/backends/macbeath_cover.hpp"
#include "dimension/body_families.hpp"

namespace pd::dimension::test {
namespace {

/// Round points about the origin, or the corners of a cube: O is inside, the body fat, the frame the identity.
template <int D>
std::vector<SupportPoint<D>> fat_points(Family family, int count) {
  BodySource<D> source(2);
  std::vector<SupportPoint<D>> r;
  for (const Vector<D>& p : source.points(family, count)) r.push_back({p, 0, std::int64_t(r.size())});
  return r;
}

/// Null where the budget is spent.
template <int D>
std::unique_ptr<detail::WidthStructure> build_within(const std::vector<SupportPoint<D>>& points, double epsilon,
                                                     std::int64_t most_work) {
  std::vector<detail::AnySupport> any;
  for (const SupportPoint<D>& p : points) any.push_back({p.point, p.value, p.index});
  return detail::build_macbeath_hierarchy(any, detail::identity_map(D), epsilon, most_work);
}

template <int D>
std::unique_ptr<detail::WidthStructure> build_hierarchy(const std::vector<SupportPoint<D>>& points, double epsilon) {
  constexpr std::int64_t kMuch = 1'000'000'000;
  auto built = build_within(points, epsilon, kMuch);
  EXPECT_NE(built, nullptr);
  return built;
}

struct Measured {
  StructureSize size;
  QueryCounters counters;
};

/// Every support is within epsilon h of the truth, which a scan knows.
template <int D>
Measured check(Family family, int count, double epsilon, int queries) {
  const auto points = fat_points<D>(family, count);
  const auto hierarchy = build_hierarchy(points, epsilon);
  BodySource<D> source(9);
  Measured r{hierarchy->size(), {}};
  for (int k = 0; k < queries; ++k) {
    const Vector<D> v = source.direction();
    double h = 0;
    for (const auto& p : points) h = std::max(h, p.point.dot(v));
    const detail::AnySupport found = hierarchy->support(v, r.counters);
    EXPECT_GE(found.value, (1 - epsilon) * h) << "D = " << D;
    EXPECT_EQ(found.point, points[std::size_t(found.index)].point);
  }
  return r;
}

TEST(MacbeathHierarchy, SupportsAreWithinEpsilon) {
  check<2>(Family::sphere, 2000, 1e-3, 3000);
  check<2>(Family::cube, 0, 1e-3, 3000);
  check<3>(Family::sphere, 500, 0.05, 2000);
  check<3>(Family::cube, 0, 0.01, 2000);
  check<4>(Family::sphere, 300, 0.4, 500);
  check<4>(Family::cube, 0, 0.3, 500);
  check<5>(Family::sphere, 200, 0.9, 200);
}

TEST(MacbeathHierarchy, ABudgetOfOperationsEndsTheBuild) {
  const auto points = fat_points<5>(Family::sphere, 300);
  EXPECT_EQ(build_within(points, 0.01, 100'000), nullptr);
  EXPECT_NE(build_within(points, 0.9, 100'000), nullptr);
}

TEST(MacbeathHierarchy, NodesAndVisitsGrowAsPromised) {
  // Halving epsilon three times: nodes by 2^(3 (d - 1) / 2), depth by 3, visits by less than the square of depths.
  const Measured coarse = check<2>(Family::sphere, 20000, 4e-3, 500);
  const Measured fine = check<2>(Family::sphere, 20000, 5e-4, 500);
  EXPECT_NEAR(std::log2(double(fine.size.nodes) / double(coarse.size.nodes)) / 3, 0.5, 0.15);
  EXPECT_EQ(fine.size.depth, coarse.size.depth + 3);
  const double layers = double(fine.size.depth) / double(coarse.size.depth);
  EXPECT_LE(double(fine.counters.nodes), 1.1 * layers * layers * double(coarse.counters.nodes));
  EXPECT_LE(fine.size.max_out_degree, 40);
}

TEST(MacbeathHierarchy, OutDegreesKeepToAPacking) {
  // Of these 467 and 1042 were linked when boxes met shadows by bounds alone, and they grew with 1 / epsilon.
  const Measured coarse = check<4>(Family::sphere, 3000, 0.2, 1000);
  const Measured fine = check<4>(Family::sphere, 3000, 0.05, 1000);
  EXPECT_LE(coarse.size.max_out_degree, 70);
  EXPECT_LE(fine.size.max_out_degree, 70);
  EXPECT_LE(check<5>(Family::sphere, 2000, 0.3, 500).size.max_out_degree, 180);
  // Without a scan: ten times the nodes, not four times the visits.
  EXPECT_GE(fine.size.nodes, 8 * coarse.size.nodes);
  EXPECT_LE(fine.counters.nodes, 4 * coarse.counters.nodes);
}

/// Random ellipsoids and boxes on the faces of the cube: which of them meet, a grid over the box says.
TEST(MacbeathCover, BoxesMeetShadowsWhereAGridSaysSo) {
  BodySource<3> source(4);
  int met = 0, missed_by_grid = 0;
  constexpr int kCases = 4000, kGrid = 60;
  for (int k = 0; k < kCases; ++k) {
    const Matrix<3> turn = source.rotation();
    Vector<3> axes;
    for (int i = 0; i < 3; ++i) axes[i] = std::pow(10.0, source.uniform(-1, 1.5));
    const Matrix<3> ellipsoid = turn * axes.cwiseProduct(axes).asDiagonal() * turn.transpose();
    const auto cone = detail::MacbeathRegion{0, source.direction(), ellipsoid}.shadow(0.9);
    const detail::DirectionBox face = detail::cube_face(3, k % 6);
    detail::DirectionBox box = face;
    for (int depth = k % 5; depth > 0; --depth) box = box.child(static_cast<int>(source.uniform(0, 4)));
    bool seen = false;
    for (int i = 0; i <= kGrid && !seen; ++i) {
      for (int j = 0; j <= kGrid && !seen; ++j) {
        Vector<3> v = box.low;
        v[(box.axis + 1) % 3] += box.side * i / kGrid;
        v[(box.axis + 2) % 3] += box.side * j / kGrid;
        seen = cone.contains(v);
      }
    }
    const bool said = detail::ShadowSection(cone, face).meets(box);
    EXPECT_TRUE(said || !seen) << k;
    met += seen ? 1 : 0;
    missed_by_grid += said && !seen ? 1 : 0;
  }
  EXPECT_GE(met, kCases / 10);
  EXPECT_LE(missed_by_grid, kCases / 100);
}

TEST(MacbeathHierarchy, LeavesAreAsLargeAsWhatTheirPointsAnswer) {
  // Macbeath regions of the polar body, as deep as the bound for the worst body allows, are 659 and 1270.
  EXPECT_LE(check<4>(Family::sphere, 300, 0.3, 500).size.nodes, 300);
  EXPECT_LE(check<5>(Family::sphere, 200, 0.5, 500).size.nodes, 200);
}

}  // namespace
}  // namespace pd::dimension::test

#include "dimension/macbeath_hierarchy.hpp"

#include <gtest/gtest.h>

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

template <int D>
std::unique_ptr<detail::WidthStructure<D>> build_hierarchy(const std::vector<SupportPoint<D>>& points, double epsilon) {
  auto built = detail::build_macbeath_hierarchy<D>(points, {}, epsilon);
  EXPECT_TRUE(built);
  return std::move(built).value();
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
    const SupportPoint<D> found = hierarchy->support(v, r.counters);
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

TEST(MacbeathHierarchy, LeavesAreAsLargeAsWhatTheirPointsAnswer) {
  // Macbeath regions of the polar body, as deep as the bound for the worst body allows, are 659 and 1270.
  EXPECT_LE(check<4>(Family::sphere, 300, 0.3, 500).size.nodes, 300);
  EXPECT_LE(check<5>(Family::sphere, 200, 0.5, 500).size.nodes, 200);
}

}  // namespace
}  // namespace pd::dimension::test

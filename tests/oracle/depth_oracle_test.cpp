/// @file
/// The oracle against something plainer still: every plane through three points and every cross product of two point
/// differences, all in exact integers, no hull, no filter.

#include "oracle/depth_oracle.hpp"

#include <gtest/gtest.h>

#include "scenes/shape_families.hpp"

namespace pd::oracle {
namespace {

using scenes::DepthClass;
using scenes::PairFamily;

struct Naive {
  int sign = 0;
  ExactLength depth;
};

Naive naive_depth(const ExactPair& pair) {
  const int na = static_cast<int>(pair.a().exact.size());
  const int nb = static_cast<int>(pair.b().exact.size());
  std::vector<IVec> edges_a;
  std::vector<IVec> edges_b;
  for (int i = 0; i < na; ++i) {
    for (int j = 0; j < i; ++j) edges_a.push_back(pair.point_a(i) - pair.point_a(j));
  }
  for (int i = 0; i < nb; ++i) {
    for (int j = 0; j < i; ++j) edges_b.push_back(pair.point_b(i) - pair.point_b(j));
  }
  std::vector<IVec> directions;
  const auto crosses = [&](const std::vector<IVec>& u, const std::vector<IVec>& v) {
    for (const IVec& e : u) {
      for (const IVec& f : v) {
        IVec n = cross(e, f);
        if (is_zero(n)) continue;
        directions.push_back(-n);
        directions.push_back(std::move(n));
      }
    }
  };
  crosses(edges_a, edges_a);
  crosses(edges_b, edges_b);
  crosses(edges_a, edges_b);
  Naive result;
  Integer best_h;
  Integer best_n2;
  for (const IVec& n : directions) {
    Integer high_b = dot(pair.point_b(0), n);
    for (int i = 1; i < nb; ++i) high_b = std::max(high_b, dot(pair.point_b(i), n));
    Integer low_a = dot(pair.point_a(0), n);
    for (int i = 1; i < na; ++i) low_a = std::min(low_a, dot(pair.point_a(i), n));
    Integer h = dot(pair.offset(), n) + high_b - low_a;
    Integer n2 = dot(n, n);
    // h |h| / n2, so that negative values order too.
    if (best_n2.is_zero() || h * abs(h) * best_n2 < best_h * abs(best_h) * n2) {
      best_h = std::move(h);
      best_n2 = std::move(n2);
    }
  }
  result.sign = best_h.sign();
  if (!best_n2.is_zero()) result.depth = pair.length(best_h * best_h, best_n2);
  return result;
}

TEST(DepthOracle, EqualsTheFilterFreeSearchOnSmallBodies) {
  int overlapping = 0;
  int touching = 0;
  int separated = 0;
  for (int f = 0; f < scenes::kPairFamilies; ++f) {
    for (int d = 0; d < scenes::kDepthClasses; ++d) {
      for (std::uint64_t seed = 1; seed <= 3; ++seed) {
        const auto family = static_cast<PairFamily>(f);
        const auto depth = static_cast<DepthClass>(d);
        const scenes::PointPair p = scenes::make_pair(family, 5, depth, seed);
        if (p.a.size() + p.b.size() > 13) continue;
        SCOPED_TRACE(std::string(to_string(family)) + " " + std::string(to_string(depth)) + " seed " +
                     std::to_string(seed));
        const Body a(p.a);
        const Body b(p.b);
        const ExactPair pair(a, p.pose_a, b, p.pose_b);
        const Verdict v = judge(pair);
        EXPECT_TRUE(v.contact != ContactClass::separated || v.distance_known);
        if (v.flat_difference) continue;
        const Naive n = naive_depth(pair);
        const ContactClass expected = n.sign > 0   ? ContactClass::overlapping
                                      : n.sign < 0 ? ContactClass::separated
                                                   : ContactClass::touching;
        EXPECT_EQ(v.contact, expected);
        if (n.sign > 0) {
          EXPECT_EQ(v.depth.compare(n.depth), 0);
          ++overlapping;
          EXPECT_GE(v.depth.compare(v.depth.round_down()), -1);
          EXPECT_LE(v.depth.compare(v.depth.round_down()), 0);
          EXPECT_GE(v.depth.compare(v.depth.round_up()), 0);
        } else if (n.sign == 0) {
          ++touching;
        } else {
          ++separated;
          // Any direction bounds the distance from below.
          if (v.distance_known) {
            EXPECT_GE(v.distance.compare(n.depth), 0);
          }
        }
      }
    }
  }
  std::printf("%d overlapping, %d touching, %d separated\n", overlapping, touching, separated);
  EXPECT_GT(overlapping, 50);
  EXPECT_GT(touching, 5);
  EXPECT_GT(separated, 30);
}

}  // namespace
}  // namespace pd::oracle

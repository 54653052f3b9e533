// Triangles that share an edge, and the way around a corner from one to the next.
#include "pd/union_contact/shared_edges.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <set>
#include <vector>

namespace pd::test {
namespace {

TEST(SharedEdges, GoRoundACornerWhicheverWayTrianglesRun) {
  const auto rim = [](int i) {
    const double turn = std::numbers::pi / 3 * i;
    return Vec3(std::cos(turn), 0, std::sin(turn));
  };
  const Vec3 centre(0, 1, 0);
  for (const int left_out : {-1, 2}) {
    std::vector<std::array<Vec3, 3>> fan;
    for (int i = 0; i < 6; ++i) {
      const Vec3 here = rim(i), next = i < 5 ? rim(i + 1) : rim(0);
      if (i == left_out) continue;
      // Every other one turned and begun elsewhere.
      if (i % 2 == 0) {
        fan.push_back({centre, here, next});
      } else {
        fan.push_back({here, centre, next});
      }
    }
    SharedEdges edges;
    edges.begin(fan);
    std::set<double> seen;
    const bool all = edges.round_corner(0, 0, [&](const Vec3& end) {
      seen.insert(end.x() + 3 * end.z());
      return false;
    });
    EXPECT_EQ(all, left_out < 0);
    if (all) {
      EXPECT_EQ(seen.size(), 6U);
    }
    const Vec3* const across = edges.across(0, 0);
    ASSERT_NE(across, nullptr);
    EXPECT_EQ((*across - rim(5)).norm(), 0);
    EXPECT_EQ(edges.across(0, 1), nullptr);
  }
}

}  // namespace
}  // namespace pd::test

/// @file
/// The arithmetic of a surface's planes over arrays: what stands in the lanes beyond the last plane, and which faces
/// have come near.
#include "depth/expansion/plane_kernels.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace pd::detail {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(PlaneKernels, LanesBeyondTheLastTriangleAreFree) {
  // Triangles of a fan round the z axis, the last ones beyond the count, and as good as the others.
  std::vector<double> points;
  for (int i = 0; i < 9; ++i) {
    points.insert(points.end(), {std::cos(0.7 * i), std::sin(0.7 * i), 1.0 + 0.1 * i, 0});
  }
  const std::int32_t p[8] = {0, 1, 2, 3, 4, 5, 6, 7}, q[8] = {1, 2, 3, 4, 5, 6, 7, 8}, r[8] = {2, 3, 4, 5, 6, 7, 8, 0};
  for (int count = 1; count <= 8; ++count) {
    double nx[8], ny[8], nz[8], level[8], key[8];
    triangle_planes(points.data(), {p, q, r}, 0, count, {nx, ny, nz, level, key});
    for (int i = 0; i < padded_to_lanes(count); ++i) {
      SCOPED_TRACE(testing::Message() << "plane " << i << " of " << count);
      if (i >= count) {
        EXPECT_EQ(level[i], kInfinity);
        EXPECT_EQ(key[i], kInfinity);
        continue;
      }
      EXPECT_LT(key[i], kInfinity);
      for (const std::int32_t v : {p[i], q[i], r[i]}) {
        const double* const x = points.data() + kPointStride * v;
        EXPECT_NEAR(x[0] * nx[i] + x[1] * ny[i] + x[2] * nz[i], level[i], 1e-14);
      }
    }
  }
}

}  // namespace
}  // namespace pd::detail

#include "depth/facets/line_kernels.hpp"

#include "numeric/lanes.hpp"

namespace pd::detail {

PD_CLONES void probes_beyond(const double* normals, int count, const ProbeArrays& test_points, const float* levels,
                             std::uint32_t* masks) {
  constexpr int kRows = kMaskProbes / kFloats;
  Floats x[kRows], y[kRows], z[kRows];
  for (int r = 0; r < kRows; ++r) {
    load(x[r], test_points.x.data() + kFloats * r);
    load(y[r], test_points.y.data() + kFloats * r);
    load(z[r], test_points.z.data() + kFloats * r);
  }
  for (int i = 0; i < count; ++i) {
    const float nx = static_cast<float>(normals[3 * i]);
    const float ny = static_cast<float>(normals[3 * i + 1]);
    const float nz = static_cast<float>(normals[3 * i + 2]);
    masks[i] = 0;
    for (int r = 0; r < kRows; ++r) {
      masks[i] |= mask_of_eight(x[r] * nx + y[r] * ny + z[r] * nz > levels[i]) << (kFloats * r);
    }
  }
}

PD_CLONES void lines_near(const LineArrays& a, const std::array<double, 6>& b, double radius, double rounding,
                          std::uint64_t* near) {
  // |N| <= r sqrt(1 - t^2 + 4 rounding) + rounding, squared: N^2 + (r t)^2 <= limit.
  const double limit =
      (radius * radius * (1 + 4 * rounding) + 2 * rounding * radius * (1 + 2 * rounding) + rounding * rounding) *
      (1 + 0x1p-46);
  const Lanes zero = {0, 0, 0, 0};
  const Lanes b0 = zero + b[0], b1 = zero + b[1], b2 = zero + b[2];
  const Lanes b3 = zero + b[3], b4 = zero + b[4], b5 = zero + b[5];
  const Lanes t0 = zero + radius * b[0], t1 = zero + radius * b[1], t2 = zero + radius * b[2];
  for (int block = 0; block < a.count; block += kLineBlock) {
    const int end = a.count < block + kLineBlock ? a.count : block + kLineBlock;
    std::uint64_t found = 0;
    for (int i = block; i < end; i += kLanes) {
      Lanes m0, m1, m2, d0, d1, d2;
      load(m0, a.coordinates[0] + i);
      load(m1, a.coordinates[1] + i);
      load(m2, a.coordinates[2] + i);
      load(d0, a.coordinates[3] + i);
      load(d1, a.coordinates[4] + i);
      load(d2, a.coordinates[5] + i);
      const Lanes n = ((b0 * m0 + b1 * m1) + (b2 * m2 + b3 * d0)) + (b4 * d1 + b5 * d2);
      const Lanes t = t0 * d0 + t1 * d1 + t2 * d2;
      found |= std::uint64_t{mask_of_four(n * n + t * t <= limit)} << (i - block);
    }
    near[block / kLineBlock] = found;
  }
  if (a.count % kLineBlock != 0) near[a.count / kLineBlock] &= (std::uint64_t{1} << (a.count % kLineBlock)) - 1;
}

}  // namespace pd::detail

#include "depth/line_lanes.hpp"

#include "numeric/instruction_sets.hpp"

namespace pd::detail {

namespace {

typedef double Lanes __attribute__((vector_size(32)));
typedef std::int64_t Flags __attribute__((vector_size(32)));
constexpr int kLanes = 4;

typedef float Singles __attribute__((vector_size(32)));
typedef std::int32_t SingleFlags __attribute__((vector_size(32)));
constexpr int kSingles = 8;

PD_INLINE void load(Lanes& to, const double* from) { __builtin_memcpy(&to, from, sizeof(Lanes)); }
PD_INLINE void load(Singles& to, const float* from) { __builtin_memcpy(&to, from, sizeof(Singles)); }

}  // namespace

PD_CLONES void probes_beyond(const double* normals, int count, const ProbeArrays& probes, const float* levels,
                             std::uint32_t* masks) {
  constexpr int kRows = kMaskProbes / kSingles;
  Singles x[kRows], y[kRows], z[kRows];
  for (int r = 0; r < kRows; ++r) {
    load(x[r], probes.x.data() + kSingles * r);
    load(y[r], probes.y.data() + kSingles * r);
    load(z[r], probes.z.data() + kSingles * r);
  }
  for (int i = 0; i < count; ++i) {
    const float nx = static_cast<float>(normals[3 * i]);
    const float ny = static_cast<float>(normals[3 * i + 1]);
    const float nz = static_cast<float>(normals[3 * i + 2]);
    SingleFlags found = {0, 0, 0, 0, 0, 0, 0, 0};
    SingleFlags bits = {1, 2, 4, 8, 16, 32, 64, 128};
    for (int r = 0; r < kRows; ++r) {
      found |= (x[r] * nx + y[r] * ny + z[r] * nz > levels[i]) & bits;
      bits <<= kSingles;
    }
    const SingleFlags half = found | __builtin_shufflevector(found, found, 4, 5, 6, 7, 0, 1, 2, 3);
    const SingleFlags quarter = half | __builtin_shufflevector(half, half, 2, 3, 0, 1, 6, 7, 4, 5);
    masks[i] = static_cast<std::uint32_t>(quarter[0] | quarter[1]);
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
    Flags found = {0, 0, 0, 0};
    Flags bits = {1, 2, 4, 8};
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
      found |= (n * n + t * t <= limit) & bits;
      bits <<= kLanes;
    }
    near[block / kLineBlock] = static_cast<std::uint64_t>((found[0] | found[1]) | (found[2] | found[3]));
  }
  if (a.count % kLineBlock != 0) near[a.count / kLineBlock] &= (std::uint64_t{1} << (a.count % kLineBlock)) - 1;
}

}  // namespace pd::detail

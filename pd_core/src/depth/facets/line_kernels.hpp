/// @file
/// Kernels of the search among nearly tied facets (near_facets.hpp): which of many normals lie beyond points, which of
/// many lines come near to one.
///
/// Compiled for several instruction sets and chosen at run time, each lane on its own without contraction: the same
/// bits on every instruction set.
#pragma once

#include <array>
#include <cstdint>

namespace pd::detail {

/// So many points are tried against each normal; a word holds a bit for each.
inline constexpr int kMaskProbes = 16;

struct ProbeArrays {
  std::array<float, kMaskProbes> x, y, z;
};

/// Bit k of masks[i]: <test point k, normal i> > levels[i] in single precision. `normals` has stride 3.
void probes_beyond(const double* normals, int count, const ProbeArrays& test_points, const float* levels,
                   std::uint32_t* masks);

/// Lines as arrays of Pluecker coordinates, (m', d') for those of A, padded to a multiple of kLineBlock.
struct LineArrays {
  const double* coordinates[6];
  int count;
};
inline constexpr int kLineBlock = 64;
constexpr int padded_to_lines(int count) { return (count + kLineBlock - 1) / kLineBlock * kLineBlock; }

/// Bit j % 64 of near[j / 64]: line j of A may be within `radius` of the line `b` = (d, m), that is |N| <= r sqrt(1 -
/// t^2) with N the product of the two and t = <d, d'>.
/// @param rounding  bound of the errors of N, of t^2, and of the lines themselves; it is allowed for.
void lines_near(const LineArrays& a, const std::array<double, 6>& b, double radius, double rounding,
                std::uint64_t* near);

}  // namespace pd::detail

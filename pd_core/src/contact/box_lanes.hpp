/// @file
/// What the kernels of two boxes' contacts compute with (box_axes.hpp, box_faces.hpp): one axis a lane.
#pragma once

#include <cstdint>
#include <limits>

#include "numeric/instruction_sets.hpp"

namespace pd::detail {

typedef double FourDoubles __attribute__((vector_size(32)));
/// Of comparisons: all bits of a lane, or none.
typedef std::int64_t FourFlags __attribute__((vector_size(32)));

PD_INLINE void load_four(FourDoubles& to, const double* from) { __builtin_memcpy(&to, from, sizeof(FourDoubles)); }
PD_INLINE void store_four(double* to, const FourDoubles& from) { __builtin_memcpy(to, &from, sizeof(FourDoubles)); }
PD_INLINE FourDoubles magnitude(const FourDoubles& v) {
  constexpr std::int64_t kMagnitude = std::numeric_limits<std::int64_t>::max();  // all bits but the sign's
  return (FourDoubles)((FourFlags)v & FourFlags{kMagnitude, kMagnitude, kMagnitude, kMagnitude});
}

}  // namespace pd::detail

/// @file
/// The scan behind small supports, compiled for several instruction sets and chosen at run time.
#pragma once

namespace pd::detail {

/// The lowest index among the maximisers of x[i] dx + y[i] dy + z[i] dz. Arrays are padded to a multiple of 8 with
/// copies of entry 0. Plain loops in a fixed order of lanes without contraction: the same bits on every instruction
/// set.
int farthest_vertex(const double* x, const double* y, const double* z, int n, double dx, double dy, double dz);

}  // namespace pd::detail

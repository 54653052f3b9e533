/// @file
/// The kernel of small_sat_kernels.cpp once more, for the instruction set that every machine has.
#ifndef PD_ISA_BASELINE
#define PD_ISA_BASELINE
#endif
#define nearest_of_small nearest_of_small_baseline
#define try_open_sides try_open_sides_baseline
#include "depth/facets/small_sat_kernels.cpp"
#include "depth/facets/small_sat_open_sides.cpp"

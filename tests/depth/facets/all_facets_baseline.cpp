/// @file
/// The kernel of all_facets_kernels.cpp once more, for the instruction set that every machine has.
#ifndef PD_ISA_BASELINE
#define PD_ISA_BASELINE
#endif
// The overload that poses take keeps its name.
#define nearest_of_all_facets nearest_of_all_facets_baseline
#include "depth/facets/all_facets_kernels.cpp"

/// @file
/// The kernel of gauss_sat_kernels.cpp once more, for the instruction set that every machine has.
#ifndef PD_ISA_BASELINE
#define PD_ISA_BASELINE
#endif
#define nearest_by_gauss_maps nearest_by_gauss_maps_baseline
#define bound_thin_pairs bound_thin_pairs_baseline
#include "depth/facets/gauss_sat_kernels.cpp"
#include "depth/facets/gauss_sat_slivers.cpp"

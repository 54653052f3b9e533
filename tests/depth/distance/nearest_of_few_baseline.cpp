/// @file
/// The kernels of nearest_of_few.cpp once more, for the instruction set that every machine has.
#ifndef PD_ISA_BASELINE
#define PD_ISA_BASELINE
#endif
#define nearest_of_few nearest_of_few_baseline
#define nearest_on_simplex nearest_on_simplex_baseline
#define support_of_few support_of_few_baseline
#define add_to_face add_to_face_baseline
#include "depth/distance/nearest_of_few.cpp"

/// @file
/// PD_CLONES: compiles a function for several instruction sets; the loader picks one at run time.
///
/// Only for functions of plain loops: an inline function of a library, compiled for a wider instruction set, could be
/// the copy that the linker keeps for everybody. Contraction is off everywhere and every lane computes on its own, so
/// that the bits do not depend on the machine. GCC only: Clang 14 emits the widest clone alone, which older processors
/// cannot run. Not under the thread sanitizer: its calls in the loader's resolvers come before it has started.
#pragma once

#if defined(__x86_64__) && defined(__linux__) && !defined(__clang__) && !defined(PD_ISA_BASELINE) && \
    !defined(__SANITIZE_THREAD__)
#define PD_CLONES __attribute__((target_clones("avx2", "default")))
#else
#define PD_CLONES
#endif

/// For what a cloned function calls: it must become a part of each clone.
#define PD_INLINE inline __attribute__((always_inline))

/// PD_FUSED: compiles a function for AVX2 with fused multiply-add, which `has_fused_products` must have been asked for.
/// Contraction is off there, too: nothing is fused but what asks for it (fused_products.hpp). Not defined where there
/// is no such choice to make.
#if defined(__x86_64__) && !defined(__clang__) && !defined(PD_ISA_BASELINE)
#define PD_FUSED __attribute__((target("avx2,fma")))
#endif

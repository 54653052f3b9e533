/// @file
/// The error of a product in one step where the processor has a fused multiply-add, else by Veltkamp's split: a kernel
/// is written once, as a generic lambda of the way to take, and `with_products` picks the way at run time.
///
/// Both errors are exact, so that the bits do not depend on the way, as long as no error is so small that it underflows
/// (products below 2^-900 of the lengths at hand, which no bound of this core tells from 0).
#pragma once

#include "numeric/lanes.hpp"

namespace pd::detail {

struct SplitProducts {
  /// a b - p for p = fl(a b).
  template <class Number>
  PD_INLINE static void error(Number& out, const Number& p, const Number& a, const Number& b) {
    constexpr double kSplit = 134217729.0;  // 2^27 + 1
    const Number ca = kSplit * a, cb = kSplit * b;
    const Number a_hi = ca - (ca - a), b_hi = cb - (cb - b);
    const Number a_lo = a - a_hi, b_lo = b - b_hi;
    out = ((a_hi * b_hi - p) + a_hi * b_lo + a_lo * b_hi) + a_lo * b_lo;
  }
};

#ifdef PD_FUSED

struct FusedProducts {
  PD_INLINE static void error(double& out, const double& p, const double& a, const double& b) {
    out = __builtin_fma(a, b, -p);
  }
  /// One instruction, once the compiler has put the lanes together.
  PD_INLINE static void error(Lanes& out, const Lanes& p, const Lanes& a, const Lanes& b) {
    out = Lanes{__builtin_fma(a[0], b[0], -p[0]), __builtin_fma(a[1], b[1], -p[1]), __builtin_fma(a[2], b[2], -p[2]),
                __builtin_fma(a[3], b[3], -p[3])};
  }
};

inline bool has_fused_products() { return __builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("fma") != 0; }

template <class Kernel>
PD_FUSED void run_fused(const Kernel& kernel) {
  kernel(FusedProducts{});
}

/// Processors of the last ten years never come here: small rather than fast.
template <class Kernel>
[[gnu::cold, gnu::noinline]] void run_split(const Kernel& kernel) {
  kernel(SplitProducts{});
}

#endif

/// Calls kernel(products), which must become a part of its caller (always_inline) with all that it calls.
template <class Kernel>
void with_products(const Kernel& kernel) {
#ifdef PD_FUSED
  has_fused_products() ? run_fused(kernel) : run_split(kernel);
#else
  kernel(SplitProducts{});
#endif
}

}  // namespace pd::detail

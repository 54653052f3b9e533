/// @file
/// Error bounds hold for round-to-nearest with gradual underflow. Hosts change both (game engines flush subnormals,
/// numerical hosts leave a rounding mode behind), so every query that certifies something runs under this guard.
#pragma once

#if defined(__SSE2__) || defined(_M_X64)
#include <xmmintrin.h>
#else
#include <cfenv>
#endif

namespace pd::detail {

/// Sets the floating-point environment that the proofs need, and puts the caller's back at the end of the scope.
class FloatingPointGuard {
 public:
#if defined(__SSE2__) || defined(_M_X64)
  FloatingPointGuard() : saved_(_mm_getcsr()) {
    // Rounding control (bits 13-14), flush to zero (15), denormals are zero (6).
    if ((saved_ & kMask) != 0) _mm_setcsr(saved_ & ~kMask);
  }
  ~FloatingPointGuard() {
    if ((saved_ & kMask) != 0) _mm_setcsr((_mm_getcsr() & ~kMask) | (saved_ & kMask));
  }

 private:
  static constexpr unsigned kMask = 0xE040u;
  unsigned saved_;
#else
  FloatingPointGuard() : saved_(std::fegetround()) {
    if (saved_ != FE_TONEAREST) std::fesetround(FE_TONEAREST);
  }
  ~FloatingPointGuard() {
    if (saved_ != FE_TONEAREST) std::fesetround(saved_);
  }

 private:
  int saved_;
#endif
 public:
  FloatingPointGuard(const FloatingPointGuard&) = delete;
  FloatingPointGuard& operator=(const FloatingPointGuard&) = delete;
};

}  // namespace pd::detail

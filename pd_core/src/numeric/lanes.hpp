/// @file
/// Rows of numbers that are worked on together: four in double precision, eight in single.
///
/// Vector types of GCC and Clang: on narrower machines the compiler takes two registers for one, with the same bits.
/// Everything here becomes a part of the function that uses it, for each instruction set (instruction_sets.hpp);
/// vectors go by reference, as passing them by value would depend on the instruction set.
#pragma once

#include <cstdint>
#include <limits>
#if defined(__SSE2__)
#include <emmintrin.h>
#endif

#include "numeric/instruction_sets.hpp"

namespace pd::detail {

typedef double Lanes __attribute__((vector_size(32)));
typedef std::int64_t Flags __attribute__((vector_size(32)));  ///< all bits or none, from comparisons of Lanes
inline constexpr int kLanes = 4;

typedef float Floats __attribute__((vector_size(32)));
typedef std::int32_t Ids __attribute__((vector_size(32)));  ///< also from comparisons of Floats
typedef float HalfFloats __attribute__((vector_size(16)));
typedef std::int32_t HalfIds __attribute__((vector_size(16)));
inline constexpr int kFloats = 8;

typedef std::uint8_t Bytes __attribute__((vector_size(16)));
inline constexpr int kBytes = 16;

PD_INLINE void load(Lanes& to, const double* from) { __builtin_memcpy(&to, from, sizeof(Lanes)); }
PD_INLINE void load(Floats& to, const float* from) { __builtin_memcpy(&to, from, sizeof(Floats)); }
PD_INLINE void store(double* to, const Lanes& from) { __builtin_memcpy(to, &from, sizeof(Lanes)); }

/// Returns the absolute values.
PD_INLINE Lanes magnitude(const Lanes& v) {
  constexpr std::int64_t kMagnitude = std::numeric_limits<std::int64_t>::max();  // all bits but the sign's
  return (Lanes)((Flags)v & Flags{kMagnitude, kMagnitude, kMagnitude, kMagnitude});
}

/// Rounded as std::sqrt, which the compiler leaves alone for the sake of errno.
PD_INLINE void take_roots(Lanes& v) {
#if defined(__SSE2__)
  const __m128d low = _mm_sqrt_pd(__builtin_shufflevector(v, v, 0, 1));
  const __m128d high = _mm_sqrt_pd(__builtin_shufflevector(v, v, 2, 3));
  v = __builtin_shufflevector(low, high, 0, 1, 2, 3);
#else
  v = Lanes{__builtin_sqrt(v[0]), __builtin_sqrt(v[1]), __builtin_sqrt(v[2]), __builtin_sqrt(v[3])};
#endif
}

/// Bit i of the result: the sign of lane i.
PD_INLINE unsigned half_mask(const HalfIds& flags) {
#if defined(__SSE2__)
  HalfFloats signs;
  __builtin_memcpy(&signs, &flags, sizeof(signs));
  return static_cast<unsigned>(_mm_movemask_ps(signs));
#else
  const HalfIds bits = (flags >> 31) & HalfIds{1, 2, 4, 8};
  return static_cast<unsigned>((bits[0] | bits[1]) | (bits[2] | bits[3]));
#endif
}

/// Bit i of the result: flag i is set.
PD_INLINE unsigned mask_of_four(const Flags& flags) {
  Ids halves;
  __builtin_memcpy(&halves, &flags, sizeof(halves));
  return half_mask(__builtin_shufflevector(halves, halves, 0, 2, 4, 6));
}
PD_INLINE unsigned mask_of_eight(const Ids& flags) {
  return half_mask(__builtin_shufflevector(flags, flags, 0, 1, 2, 3)) |
         half_mask(__builtin_shufflevector(flags, flags, 4, 5, 6, 7)) << 4;
}

/// Bit i of the result: byte i is 0.
PD_INLINE unsigned mask_of_zeros(const Bytes& v) {
#if defined(__SSE2__)
  __m128i bytes;
  __builtin_memcpy(&bytes, &v, sizeof(bytes));
  return static_cast<unsigned>(_mm_movemask_epi8(_mm_cmpeq_epi8(bytes, _mm_setzero_si128())));
#else
  unsigned bits = 0;
  for (int i = 0; i < kBytes; ++i) bits |= static_cast<unsigned>(v[i] == 0) << i;
  return bits;
#endif
}

/// Entries of a table by the last four bits of `at`.
PD_INLINE void look_up(Bytes& out, const Bytes& table, const Bytes& at) {
#if defined(__clang__)
  for (int i = 0; i < kBytes; ++i) out[i] = table[at[i] % kBytes];
#else
  out = __builtin_shuffle(table, at);
#endif
}

/// The greatest lane; any of them where one is not a number.
PD_INLINE double greatest(const Lanes& v) {
  const double low = v[1] > v[0] ? v[1] : v[0];
  const double high = v[3] > v[2] ? v[3] : v[2];
  return high > low ? high : low;
}
PD_INLINE double least(const Lanes& v) {
  const double low = v[1] < v[0] ? v[1] : v[0];
  const double high = v[3] < v[2] ? v[3] : v[2];
  return high < low ? high : low;
}
PD_INLINE float greatest(const Floats& v) {
  const HalfFloats low = __builtin_shufflevector(v, v, 0, 1, 2, 3);
  const HalfFloats high = __builtin_shufflevector(v, v, 4, 5, 6, 7);
  const HalfFloats top = high > low ? high : low;
  const float left = top[1] > top[0] ? top[1] : top[0];
  const float right = top[3] > top[2] ? top[3] : top[2];
  return right > left ? right : left;
}

/// Four rows of four become four columns.
PD_INLINE void transpose(Lanes& a, Lanes& b, Lanes& c, Lanes& d) {
  const Lanes ab_even = __builtin_shufflevector(a, b, 0, 4, 2, 6);
  const Lanes ab_odd = __builtin_shufflevector(a, b, 1, 5, 3, 7);
  const Lanes cd_even = __builtin_shufflevector(c, d, 0, 4, 2, 6);
  const Lanes cd_odd = __builtin_shufflevector(c, d, 1, 5, 3, 7);
  a = __builtin_shufflevector(ab_even, cd_even, 0, 1, 4, 5);
  b = __builtin_shufflevector(ab_odd, cd_odd, 0, 1, 4, 5);
  c = __builtin_shufflevector(ab_even, cd_even, 2, 3, 6, 7);
  d = __builtin_shufflevector(ab_odd, cd_odd, 2, 3, 6, 7);
}

}  // namespace pd::detail

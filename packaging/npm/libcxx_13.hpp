/// @file
/// Debian's emscripten builds with libc++ 13, and this file adds the parts of C++20 that it lacks. The file is included
/// before every source of the WebAssembly module, and where `tests/rules/libcxx.sh` reads the core with libc++ 14. Each
/// part leaves when a newer library has it. The emulation of SSE2 is completed here, too.
#pragma once

#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <compare>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <string_view>
#include <system_error>

#ifdef __EMSCRIPTEN__
/// WebAssembly rounds to nearest and keeps subnormals, so emscripten's `_mm_getcsr` never asks for a change back.
inline void _mm_setcsr(unsigned int) {}
#endif

#if _LIBCPP_VERSION < 14000
namespace std {  // NOLINT(cert-dcl58-cpp): the names are the library's own

template <class To, class From>
[[nodiscard]] constexpr To bit_cast(const From& from) noexcept {
  return __builtin_bit_cast(To, from);
}

/// The shortest digits that read back to the same bits. The only locale of WebAssembly's C library is "C".
inline to_chars_result to_chars(char* first, char* last, double value) {
  array<char, 32> text;
  int size = 0;
  for (int digits = 1; digits <= 17; ++digits) {
    size = snprintf(text.data(), text.size(), "%.*g", digits, value);
    if (strtod(text.data(), nullptr) == value) break;
  }
  if (last - first < size) return {last, errc::value_too_large};
  for (int i = 0; i < size; ++i) *first++ = text[static_cast<size_t>(i)];
  return {first, errc()};
}

/// Reads the longest decimal number. A number that no double is near leaves the value as it is.
inline from_chars_result from_chars(const char* first, const char* last, double& value) {
  const char* stop = first;
  while (stop != last && string_view("0123456789+-.eEinfatyINFATY").find(*stop) != string_view::npos) ++stop;
  const string text(first, stop);
  char* end = nullptr;
  errno = 0;
  const double read = strtod(text.c_str(), &end);
  if (end == text.c_str() || text[0] == '+') return {first, errc::invalid_argument};
  const char* const rest = first + (end - text.c_str());
  if (errno == ERANGE && (read == 0 || read == HUGE_VAL || read == -HUGE_VAL)) return {rest, errc::result_out_of_range};
  value = read;
  return {rest, errc()};
}

}  // namespace std
#endif

#if _LIBCPP_VERSION < 15000
namespace std {  // NOLINT(cert-dcl58-cpp): as above

template <class T, size_t N>
constexpr strong_ordering operator<=>(const array<T, N>& x, const array<T, N>& y) {
  for (size_t i = 0; i < N; ++i) {
    if (const strong_ordering order = x[i] <=> y[i]; order != 0) return order;
  }
  return strong_ordering::equal;
}

namespace ranges {
template <class Range, class Out>
constexpr void copy(const Range& range, Out out) {
  for (const auto& x : range) *out++ = x;
}
}  // namespace ranges

}  // namespace std
#endif

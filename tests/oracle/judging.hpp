/// @file
/// Words and allowances that the judges share.
#pragma once

#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>

namespace pd::oracle {

/// `Bracket::certified` promises this width, in units of S.
inline constexpr double kCertifiedWidth = 2e-14;

/// @param format  of printf, with up to three numbers
inline std::string text(const char* format, double x, double y, double z = 0) {
  std::array<char, 200> buffer{};
  std::snprintf(buffer.data(), buffer.size(), format, x, y, z);
  return buffer.data();
}

/// The step of doubles at x >= 0.
inline double ulp_of(double x) {
  return x > 0 ? std::ldexp(1.0, std::ilogb(x) - 52) : std::numeric_limits<double>::denorm_min();
}

}  // namespace pd::oracle

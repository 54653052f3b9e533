/// @file
/// Doubles as text in error messages: the shortest digits that read back to the same bits, whatever the locale.
#pragma once

#include <array>
#include <charconv>
#include <string>

namespace pd::detail {

inline std::string number_text(double value) {
  std::array<char, 32> buffer;
  const auto result = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
  return {buffer.data(), result.ptr};
}

inline std::string indexed(const char* name, long long index) {
  return std::string(name) + "[" + std::to_string(index) + "]";
}

}  // namespace pd::detail

/// @file
/// Decimal numbers of every text format, rounded once and correctly: to the nearest double, to 0 below the least, to
/// infinity beyond the largest, however many digits there are.
#pragma once

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string_view>
#include <system_error>

namespace pd::query {

/// Is |number| greater than 1? Decides, for a text that std::from_chars found to be out of range, between infinity
/// and 0. Both are some 300 decimal places away from 1.
[[nodiscard]] inline bool is_beyond_one(std::string_view text) {
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  if (text.starts_with('-')) text.remove_prefix(1);
  const std::size_t end = std::min(text.find_first_of("eE"), text.size());
  const std::size_t point = std::min(text.substr(0, end).find('.'), end);
  const std::size_t first = text.find_first_of("123456789");
  // Places from the leading digit up to the decimal point; 0 or negative where that digit stands behind the point.
  const auto places = first < point ? static_cast<std::int64_t>(point - first)
                                    : static_cast<std::int64_t>(point) + 1 - static_cast<std::int64_t>(first);
  constexpr std::int64_t kSaturated = std::int64_t{1} << 60;
  std::int64_t exponent = 0;
  std::size_t at = std::min(end + 1, text.size());
  const bool negative = at < text.size() && text[at] == '-';
  if (at < text.size() && !is_digit(text[at])) ++at;
  for (; at < text.size() && is_digit(text[at]); ++at) {
    exponent = std::min(exponent * 10 + (text[at] - '0'), kSaturated / 16);
  }
  return places + (negative ? -exponent : exponent) > 0;
}

/// Reads a number at the front of [first, last), which may begin with one sign; "nan" and "inf" are numbers here.
/// @return the first character behind the number, or `first` where there is none.
[[nodiscard]] inline const char* read_decimal(const char* first, const char* last, double& value) {
  const char* begin = first;
  if (begin != last && *begin == '+') {
    ++begin;
    if (begin != last && *begin == '-') return first;
  }
  const auto [rest, error] = std::from_chars(begin, last, value);
  if (error == std::errc::result_out_of_range) {
    const std::string_view text(begin, static_cast<std::size_t>(rest - begin));
    value = std::copysign(is_beyond_one(text) ? std::numeric_limits<double>::infinity() : 0.0, *begin == '-' ? -1 : 1);
    return rest;
  }
  return error == std::errc() ? rest : first;
}

/// A whole word as a number. False when the word is none.
[[nodiscard]] inline bool parse_decimal(std::string_view word, double& value) {
  const char* const end = word.data() + word.size();
  return !word.empty() && read_decimal(word.data(), end, value) == end;
}

}  // namespace pd::query

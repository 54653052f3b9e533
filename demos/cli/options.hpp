/// @file
/// What the subcommands share of their options and of their words for people.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace pd::cli {

/// Numbers between commas or blanks; a Refusal where a word is none. `option` is named in it.
[[nodiscard]] std::vector<double> parse_numbers(const std::string& text, const std::string& option);

/// A check for options: the commands write one format, whatever the file is called.
[[nodiscard]] std::string refuse_other_pictures(const std::string& file);

/// A line of an answer for people: its name and its value.
void print_row(std::string_view name, const std::string& value);

/// "850 ns", "3.1 ms".
[[nodiscard]] std::string duration_in_words(std::int64_t nanoseconds);

}  // namespace pd::cli

/// @file
/// Answers to a command that was typed wrongly: they say what is wrong, and what would be right.
#pragma once

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace pd::cli {

/// The word of `known` that is nearest to the typed one, at most two letters apart; empty where none is.
[[nodiscard]] std::string nearest_word(const std::vector<std::string>& known, std::string_view typed);

/// A check for options: a number of at least `low` and at most `high`, which help shows as `shown`.
[[nodiscard]] CLI::Validator number_check(double low, double high, const std::string& shown);

/// A check for options: a number between two limits of the option's own type, both included.
template <class Number>
[[nodiscard]] CLI::Validator number_between(Number low, Number high) {
  const char* const type = std::is_integral_v<Number> ? "INT" : "FLOAT";
  return number_check(static_cast<double>(low), static_cast<double>(high),
                      fmt::format("{} in [{}, {}]", type, low, high));
}

/// Checks for options whose numbers have no upper limit.
[[nodiscard]] CLI::Validator number_of_zero_or_more();
[[nodiscard]] CLI::Validator number_above_zero();

/// A check for options: one of these words.
[[nodiscard]] CLI::Validator one_of(std::vector<std::string> words);

/// Says on standard error what the parser refused, and where help stands. `app` has parsed the words.
void complain_of_usage(const CLI::App& app, const CLI::ParseError& error);

/// Says so where a word that was typed is empty, as a shell's variable that is not set. @return whether one is
bool complain_of_empty_word(const CLI::App& app);

}  // namespace pd::cli

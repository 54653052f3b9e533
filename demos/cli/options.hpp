/// @file
/// What the subcommands share of their options and of their words for people.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

namespace pd::cli {

/// Numbers between commas or blanks; a Refusal where a word is none. `option` is named in it.
[[nodiscard]] std::vector<double> parse_numbers(const std::string& text, const std::string& option);

/// A check for options: the commands write one format, whatever the file is called.
[[nodiscard]] std::string refuse_other_pictures(const std::string& file);

/// Says how a command that cannot draw comes to draw. @return kBadUsage
int refuse_picture(const std::string& file);

/// A check for options: hulls and parts are written as OBJ, whatever the file is called.
[[nodiscard]] std::string refuse_other_meshes(const std::string& file);

/// A file that an option names for writing. An empty name is no file.
struct Output {
  std::string_view option;
  const std::string& file;
};

/// Looks at the outputs of a command before its work. No folder is made for a file: where it is missing, or has the
/// file's name, the work cannot be finished (std::runtime_error). @throws query::Refusal where an output is one of the
/// inputs, by whatever name, where two options name one file, and for "-"
void check_outputs(std::initializer_list<std::string> inputs, std::initializer_list<Output> outputs);

/// Says why an output could not be written, by errno where its name is good. @return kFailed
int cannot_write(const Output& output);

/// Says that the page of --report, whose folder pdepth makes, cannot be written. @return kFailed
int cannot_write_page(const std::string& folder);

/// A line of an answer for people: its name and its value.
void print_row(std::string_view name, const std::string& value);

/// "850 ns", "3.1 ms".
[[nodiscard]] std::string duration_in_words(std::int64_t nanoseconds);

}  // namespace pd::cli

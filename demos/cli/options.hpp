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

/// A Refusal where a mesh's file is expected and the word names a folder.
void refuse_folder(const std::string& word);

/// Refuses to write over what is read: a Refusal where an output is one of the inputs, by whatever name. `option` is
/// named in it. An empty name is no file.
void refuse_to_overwrite(std::initializer_list<std::string> inputs, const std::string& output, const char* option);

/// A line of an answer for people: its name and its value.
void print_row(std::string_view name, const std::string& value);

/// "850 ns", "3.1 ms".
[[nodiscard]] std::string duration_in_words(std::int64_t nanoseconds);

}  // namespace pd::cli

#include "options.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <system_error>

#include "commands.hpp"
#include "files/decimal_number.hpp"
#include "support/complain.hpp"
#include "support/refusal.hpp"

namespace pd::cli {

std::vector<double> parse_numbers(const std::string& text, const std::string& option) {
  std::vector<double> numbers;
  std::size_t at = 0;
  while ((at = text.find_first_not_of(", \t", at)) != std::string::npos) {
    const std::size_t end = std::min(text.find_first_of(", \t", at), text.size());
    double value = 0;
    if (!query::parse_decimal(std::string_view(text).substr(at, end - at), value)) {
      query::refuse("bad_value", option + ": \"" + text.substr(at, end - at) + "\" is no number", "");
    }
    numbers.push_back(value);
    at = end;
  }
  return numbers;
}

std::string refuse_other_pictures(const std::string& file) {
  return std::filesystem::path(file).extension() == ".png" ? "" : file + ": pictures are written as PNG: name it *.png";
}

int refuse_picture(const std::string& file) {
  complain(
      "{}: this command draws no pictures; Debian's package pdepth-pictures, or a build with PD_WITH_RENDER and "
      "PD_WITH_BULLET, does",
      file);
  return kBadUsage;
}

std::string refuse_other_meshes(const std::string& file) {
  std::string extension = std::filesystem::path(file).extension();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension.empty() || extension == ".obj" ? "" : file + ": meshes are written as OBJ: name it *.obj";
}

void refuse_folder(const std::string& word) {
  std::error_code missing;  // a missing file is refused by its reader
  if (std::filesystem::is_directory(word, missing)) {
    query::refuse("unreadable_file", word + ": a folder; a file is expected", "");
  }
}

void refuse_to_overwrite(std::initializer_list<std::string> inputs, const std::string& output, const char* option) {
  for (const std::string& input : inputs) {
    std::error_code missing;  // equal to nothing
    if (!output.empty() && !input.empty() && std::filesystem::equivalent(input, output, missing)) {
      query::refuse("bad_value", std::string(option) + ": " + output + " is the input itself: write to another file",
                    "");
    }
  }
}

void print_row(std::string_view name, const std::string& value) { fmt::print("  {:<13} {}\n", name, printable(value)); }

std::string duration_in_words(std::int64_t nanoseconds) {
  const auto t = static_cast<double>(nanoseconds);
  if (t < 1e3) return fmt::format("{} ns", nanoseconds);
  if (t < 1e6) return fmt::format("{:.1f} us", t / 1e3);
  if (t < 1e9) return fmt::format("{:.1f} ms", t / 1e6);
  return fmt::format("{:.2f} s", t / 1e9);
}

}  // namespace pd::cli

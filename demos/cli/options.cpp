#include "options.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <stdexcept>
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
  return (extension.empty() && file != "-") || extension == ".obj"
             ? ""
             : file + ": meshes are written as OBJ: name it *.obj";
}

namespace {

/// Words for a name under which no file can be written; empty where nothing is in the way.
std::string in_the_way(const std::filesystem::path& file) {
  std::error_code missing;
  if (std::filesystem::is_directory(file, missing)) return "a folder has this name";
  const std::filesystem::path folder = file.parent_path();
  if (folder.empty() || std::filesystem::is_directory(folder, missing)) return {};
  return "there is no folder " + folder.string();
}

bool name_one_file(const std::string& a, const std::string& b) {
  std::error_code missing;
  if (std::filesystem::exists(a, missing) && !std::filesystem::is_regular_file(a, missing)) return false;
  const auto place = [&](const std::string& file) {
    return std::filesystem::weakly_canonical(std::filesystem::absolute(file, missing), missing);
  };
  return place(a) == place(b);
}

std::string not_written(const Output& output, const std::string& reason) {
  return fmt::format("{} cannot be written: {} ({})", output.file, reason, output.option);
}

void check_output(std::initializer_list<std::string> inputs, const Output& output) {
  const auto refuse = [&](const std::string& words) {
    query::refuse("bad_value", std::string(output.option) + ": " + output.file + words, "");
  };
  if (output.file == "-") refuse(" names no file; /dev/stdout is standard output");
  for (const std::string& input : inputs) {
    std::error_code missing;  // equal to nothing
    if (!input.empty() && std::filesystem::equivalent(input, output.file, missing)) {
      refuse(" is the input itself: write to another file");
    }
  }
  if (const std::string reason = in_the_way(output.file); !reason.empty()) {
    throw std::runtime_error(not_written(output, reason));
  }
}

}  // namespace

void check_outputs(std::initializer_list<std::string> inputs, std::initializer_list<Output> outputs) {
  for (const Output& output : outputs) {
    if (output.file.empty()) continue;
    check_output(inputs, output);
    for (const Output* other = outputs.begin(); other != &output; ++other) {
      if (other->file.empty() || !name_one_file(other->file, output.file)) continue;
      query::refuse("bad_value", fmt::format("{} and {} name one file, {}", other->option, output.option, output.file),
                    "");
    }
  }
}

int cannot_write(const Output& output) {
  const int number = errno;
  const std::string reason = in_the_way(output.file);
  complain("{}", not_written(output, reason.empty() ? std::strerror(number) : reason));
  return kFailed;
}

int cannot_write_page(const std::string& folder) {
  complain("{}", not_written({"--report", folder + "/report.html"}, std::strerror(errno)));
  return kFailed;
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

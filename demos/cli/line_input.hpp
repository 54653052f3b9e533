/// @file
/// What the subcommands share that read lines from a file or from standard input.
#pragma once

#include <CLI/App.hpp>
#include <string>

#include "protocol/line/limits.hpp"

namespace pd::cli {

/// --no-files, --max-line, --max-vertices. `limits` must outlive the parsing.
void add_limit_options(CLI::App& command, query::Limits& limits);

/// --threads, 0 for one a processor; `purpose` ends the sentence "Threads that ...".
void add_threads_option(CLI::App& command, int& threads, const std::string& purpose);
/// The number that `--threads` means on this machine, >= 1.
[[nodiscard]] int number_of_threads(int option);

/// A file that is read from its start, or standard input for "-".
class InputFile {
 public:
  explicit InputFile(const std::string& path);
  ~InputFile();
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  /// False where the file cannot be opened; errno says why.
  [[nodiscard]] bool good() const { return descriptor_ >= 0; }
  [[nodiscard]] int descriptor() const { return descriptor_; }
  /// True if an output is the regular file that is read here, by whatever name: what is written would be read again.
  [[nodiscard]] bool is_also(int output) const;
  [[nodiscard]] bool is_also(const std::string& output) const;

 private:
  int descriptor_;
};

/// Says on standard error why a file cannot be read. @return kBadUsage
int cannot_read(const std::string& path, int reason);

}  // namespace pd::cli

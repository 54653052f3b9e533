/// @file
/// What the demos share on the way out: the folder, progress, Ctrl-C, tables.
#pragma once

#include <chrono>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "pd/numeric/expected.hpp"
#include "pd/numeric/whole_file.hpp"
#include "support/demo_options.hpp"

namespace pd::demo {

/// Makes the demo's folder ("pdepth_out/NAME" unless told otherwise) and says on stderr why it could not.
/// @return kDemoDone; kDemoFailed where it cannot be made or read; kDemoBadUsage where it holds files and
/// `options.force` is not set.
[[nodiscard]] int open_output_folder(const DemoOptions& options, std::string_view demo, std::filesystem::path& folder);

/// From now on Ctrl-C and SIGTERM are only noted; a second one ends the program.
void note_interrupts();
[[nodiscard]] bool interrupted();

/// Progress on stderr: a bar that is redrawn on a terminal, a line every tenth elsewhere.
class Progress {
 public:
  Progress(std::string label, int total);
  /// Ends the bar's line.
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  void show(int done);

 private:
  std::string label_;
  int total_;
  bool terminal_;
  int last_shown_ = -1;
  std::chrono::steady_clock::time_point start_;
};

/// A table of numbers, there whole once it is finished.
class CsvFile {
 public:
  CsvFile(const std::filesystem::path& path, std::string_view header);
  /// Numbers are written so that they read back to the same bits.
  void row(const std::vector<double>& numbers);
  /// @return false where the file cannot be written.
  [[nodiscard]] bool finish() { return file_.finish(); }

 private:
  WholeFile file_;
};

/// A length with a fitting unit and three digits: "1.24 mm", "0.310 µm".
[[nodiscard]] std::string length_text(double metres);

/// An energy with a fitting unit and three digits: "7.03 mJ", "1.60 µJ".
[[nodiscard]] std::string energy_text(double joules);

/// Says on stderr what went wrong. @return kDemoFailed.
int report_failure(const Error& error);

}  // namespace pd::demo

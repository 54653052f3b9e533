/// @file
/// Lines kept for later: every query, or those that took long or missed their bracket, as they came.
///
/// A record is a file of the protocol: `pdepth query` replays it, and its answers have the same bits.
#pragma once

#include <cstdint>
#include <fstream>
#include <mutex>
#include <string>
#include <string_view>

namespace pd::query {

struct RecordSettings {
  std::string path;                ///< `--record`; empty: nothing is kept
  double above_milliseconds = -1;  ///< `--record-above`: lines that took longer; negative: not asked for
  bool unreached = false;          ///< `--record-unreached`: lines whose bracket was not reached, or that hit a limit
};

/// Shared by the threads that answer.
class LineRecorder {
 public:
  /// Opens the file for appending.
  explicit LineRecorder(RecordSettings settings);

  /// False when the file could not be opened or written.
  [[nodiscard]] bool good() const { return settings_.path.empty() || file_.good(); }
  [[nodiscard]] bool active() const { return !settings_.path.empty(); }

  /// Keeps the line where the settings ask for it.
  void keep(std::string_view line, std::string_view answer, double milliseconds);

 private:
  RecordSettings settings_;
  std::mutex mutex_;
  std::ofstream file_;
};

}  // namespace pd::query

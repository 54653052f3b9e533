/// @file
/// Lines kept for later: every query, or those that took long or missed their bracket, as they came.
///
/// A record is a file of the protocol: `pdepth query` replays it, and its answers have the same bits. Several processes
/// may append to one record: a line is one write.
#pragma once

#include <cstdint>
#include <mutex>
#include <string>
#include <string_view>

#include "protocol/answer_line.hpp"

namespace pd::query {

struct RecordSettings {
  std::string path;                ///< `--record`; empty: nothing is kept
  double above_milliseconds = -1;  ///< `--record-above`: lines that took longer; negative: not asked for
  bool unreached = false;          ///< `--record-unreached`: lines whose bracket was not reached, or that hit a limit
};

/// Shared by the threads that answer.
class LineRecorder {
 public:
  /// Opens the file for appending. A last line that was cut short (a full disk, a killed process) is ended first.
  explicit LineRecorder(RecordSettings settings);
  ~LineRecorder();
  LineRecorder(const LineRecorder&) = delete;
  LineRecorder& operator=(const LineRecorder&) = delete;

  /// False when the file could not be opened or written.
  [[nodiscard]] bool good() const { return reason_ == 0; }
  /// The errno of the first failure.
  [[nodiscard]] int reason() const { return reason_; }
  [[nodiscard]] bool active() const { return !settings_.path.empty(); }

  /// Keeps the line where the settings ask for it.
  void keep(std::string_view line, const LineAnswer& answer, double milliseconds);

 private:
  RecordSettings settings_;
  std::mutex mutex_;
  int file_ = -1;
  int reason_ = 0;
};

}  // namespace pd::query

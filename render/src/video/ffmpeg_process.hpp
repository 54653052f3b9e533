/// @file
/// The program ffmpeg, fed through its standard input.
#pragma once

#include <sys/types.h>

#include <span>
#include <string>
#include <vector>

#include "pd/numeric/expected.hpp"

namespace pd::render::detail {

/// Runs in a process group of its own, so that Ctrl-C reaches us first and the film is closed properly. Whatever
/// happens to us, ffmpeg sees the end of its input and finishes the file.
class FfmpegProcess {
 public:
  /// @param arguments  after the program's name; the input is "pipe:0" or "-".
  /// @return ErrorCode::unsupported where ffmpeg is not installed.
  static Expected<FfmpegProcess> start(const std::vector<std::string>& arguments);

  ~FfmpegProcess();
  FfmpegProcess(FfmpegProcess&& other) noexcept;
  FfmpegProcess& operator=(FfmpegProcess&&) = delete;

  /// @return false once ffmpeg has closed its input (`finish` tells why).
  [[nodiscard]] bool write(std::span<const std::uint8_t> bytes) const;

  /// Ends the input and waits. @return empty, or what ffmpeg said when it failed.
  std::string finish();

 private:
  FfmpegProcess(pid_t process, int input, int messages) : process_(process), input_(input), messages_(messages) {}

  pid_t process_;
  int input_;
  int messages_;
};

}  // namespace pd::render::detail

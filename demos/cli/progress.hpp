/// @file
/// A line on a terminal that says how far a command has come.
#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

namespace pd::cli {

/// While it lives, and where standard error is a terminal, a line there names the work, the share that is done and the
/// seconds so far. It appears after half a second and is gone at the end, so that quick work shows nothing.
class Progress {
 public:
  /// @param share  of the work that is done, in [0, 1], or negative where it is not known; another thread calls it
  explicit Progress(std::string work, std::function<double()> share = {});
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// Names the work that begins now.
  void begin(std::string work);
  /// Takes the line away for good, before an answer is printed. The destructor does it, too.
  void end();

 private:
  void show();

  std::mutex mutex_;
  std::condition_variable ends_;
  std::string work_;
  std::function<double()> share_;
  bool ended_ = false;
  std::thread thread_;  ///< none where nobody watches
};

/// The share of a regular file that a descriptor has been read to; negative for pipes and terminals.
[[nodiscard]] double share_read(int descriptor);

}  // namespace pd::cli

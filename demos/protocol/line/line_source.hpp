/// @file
/// Lines out of a file descriptor, as soon as they are there, never holding more than one line's limit; and text into
/// one.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace pd::query {

/// Writes the whole text, in one call where the system takes it so. False, with errno, where it cannot be written.
[[nodiscard]] bool write_all(int descriptor, std::string_view text);

class LineSource {
 public:
  /// @param descriptor  open for reading; not closed here.
  LineSource(int descriptor, std::size_t max_line) : descriptor_(descriptor), max_line_(max_line) {}

  enum class Next {
    line,       ///< a line of at most max_line bytes
    oversized,  ///< a longer one: read to its end and dropped
    end,        ///< the end of the input
    failed,     ///< the input cannot be read; errno says why
  };

  /// The next line, without its newline. The last one needs none. Blocks until it is there.
  Next next(std::string& line);

 private:
  /// False at the end of the input and on failure.
  bool refill();

  int descriptor_;
  std::size_t max_line_;
  std::vector<char> buffer_ = std::vector<char>(std::size_t{1} << 16);
  std::size_t begin_ = 0;
  std::size_t end_ = 0;
  bool failed_ = false;
};

}  // namespace pd::query

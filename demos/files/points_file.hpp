/// @file
/// Point files too large for a line: text (one point a line, blanks or commas between numbers, # starts a comment) or
/// NumPy's .npy (float32 or float64, little endian, row by row). Read in chunks, as often as wanted.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "files/regular_file.hpp"

namespace pd::query {

class PointsFile {
 public:
  /// @param max_points  more points than these are refused while the file is read
  /// @throws Refusal unreadable_file (not a regular file, malformed) or limit_exceeded, without a place: the caller
  /// knows it.
  PointsFile(const std::string& path, std::int64_t max_points);

  /// Numbers a row.
  [[nodiscard]] int dimension() const { return dimension_; }
  /// As the header says; 0 for text, which does not.
  [[nodiscard]] std::int64_t rows() const { return rows_; }
  /// Up to `rows` rows of numbers, appended to an emptied `numbers`; false at the end. Numbers may be NaN or infinite.
  /// @throws Refusal unreadable_file with the line, or limit_exceeded.
  bool next(std::vector<double>& numbers, std::size_t rows);
  void rewind();

 private:
  void open_npy();
  bool next_binary(std::vector<double>& numbers, std::size_t rows);
  bool next_text(std::vector<double>& numbers, std::size_t rows);
  bool next_line(std::string_view& line);
  bool read_text_row(std::vector<double>& numbers);
  void count_row(std::int64_t rows);

  static constexpr std::size_t kBufferBytes = 65536;

  std::string path_;
  RegularFile file_;
  std::int64_t max_points_;
  int dimension_ = 0;
  bool binary_ = false;
  bool single_ = false;
  std::uintmax_t data_offset_ = 0;
  std::int64_t rows_left_ = 0;
  std::int64_t rows_ = 0;
  std::int64_t rows_read_ = 0;
  std::int64_t line_ = 0;
  std::uintmax_t offset_ = 0;  ///< of the first byte that is not in the buffer yet
  std::string buffer_;
  std::size_t at_ = 0;  ///< of the first byte of the buffer that has not been read yet
};

}  // namespace pd::query

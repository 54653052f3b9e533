/// @file
/// Point files too large for a line: text (one point a line, blanks or commas between numbers, # starts a comment) or
/// NumPy's .npy (float32 or float64, little endian, row by row). Read in chunks, as often as wanted.
#pragma once

#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

namespace pd::query {

class PointsFile {
 public:
  /// @throws Refusal unreadable_file, without a place: the caller knows it.
  explicit PointsFile(const std::string& path);

  /// Numbers a row.
  [[nodiscard]] int dimension() const { return dimension_; }
  /// As the header says; 0 for text, which does not.
  [[nodiscard]] std::int64_t rows() const { return rows_; }
  /// Up to `rows` rows of numbers, appended to an emptied `numbers`; false at the end. Numbers may be NaN or infinite.
  /// @throws Refusal unreadable_file with the line.
  bool next(std::vector<double>& numbers, std::size_t rows);
  void rewind();

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  void open_npy();
  bool next_binary(std::vector<double>& numbers, std::size_t rows);
  bool next_text(std::vector<double>& numbers, std::size_t rows);
  bool read_text_row(std::vector<double>& numbers);

  std::string path_;
  std::unique_ptr<std::FILE, Close> file_;
  int dimension_ = 0;
  bool binary_ = false;
  bool single_ = false;
  std::int64_t data_offset_ = 0;
  std::int64_t rows_left_ = 0;
  std::int64_t rows_ = 0;
  std::int64_t line_ = 0;
};

}  // namespace pd::query

#include "files/points_file.hpp"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <limits>
#include <optional>

#include "files/decimal_number.hpp"
#include "support/refusal.hpp"

namespace pd::query {

namespace {

constexpr std::size_t kLongestLine = 4096;
constexpr std::int64_t kMostColumns = 64;
constexpr std::string_view kNpyMagic = "\x93NUMPY";
constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

[[noreturn]] void unreadable(const std::string& path, const std::string& why) {
  refuse("unreadable_file", "\"" + path + "\": " + why, "");
}

RegularFile open_named(const std::string& path) {
  try {
    return RegularFile::open(path, std::numeric_limits<std::uintmax_t>::max());
  } catch (const Refusal& refusal) {
    refuse(refusal.code, "\"" + path + "\": " + refusal.message, "");
  }
}

/// The value behind 'key': in a header of NumPy, a Python dictionary without nesting but for the shape.
std::string header_value(const std::string& header, const std::string& key) {
  const std::size_t at = header.find("'" + key + "'");
  if (at == std::string::npos) return {};
  std::size_t from = header.find(':', at);
  if (from == std::string::npos) return {};
  ++from;
  while (from < header.size() && header[from] == ' ') ++from;
  if (from == header.size()) return {};
  const bool tuple = header[from] == '(';
  const std::size_t to = tuple ? header.find(')', from) : header.find_first_of(",}", from);
  return header.substr(from, to == std::string::npos ? to : to + (tuple ? 1 : 0) - from);
}

/// Rows and columns of "(n, d)" or "(n, d,)"; nothing for any other shape.
std::optional<std::array<std::int64_t, 2>> table_shape(std::string_view text) {
  if (!text.starts_with('(') || !text.ends_with(')')) return std::nullopt;
  text = text.substr(1, text.size() - 2);
  const auto skip = [&](char c) {
    const bool found = text.starts_with(c);
    if (found) text.remove_prefix(1);
    return found;
  };
  std::array<std::int64_t, 2> shape{};
  for (std::size_t k = 0; k < 2; ++k) {
    while (skip(' ')) {
    }
    const auto [rest, error] = std::from_chars(text.data(), text.data() + text.size(), shape[k]);
    if (error != std::errc() || shape[k] < 0) return std::nullopt;
    text.remove_prefix(static_cast<std::size_t>(rest - text.data()));
    if (!skip(',') && k == 0) return std::nullopt;
  }
  while (skip(' ')) {
  }
  if (!text.empty()) return std::nullopt;
  return shape;
}

bool is_separator(char c) { return c == ' ' || c == '\t' || c == ',' || c == ';' || c == '\r'; }

}  // namespace

PointsFile::PointsFile(const std::string& path, std::int64_t max_points)
    : path_(path), file_(open_named(path)), max_points_(max_points) {
  std::array<char, kNpyMagic.size()> front{};
  const std::string_view begin(front.data(), file_.read_at(0, front.data(), front.size()));
  binary_ = begin == kNpyMagic;
  if (binary_) {
    open_npy();
  } else {
    if (begin.starts_with(kByteOrderMark)) data_offset_ = kByteOrderMark.size();
    rewind();
    std::vector<double> row;
    if (!read_text_row(row)) unreadable(path_, "holds no point");
    dimension_ = static_cast<int>(row.size());
  }
  rewind();
}

void PointsFile::open_npy() {
  std::array<char, 6> words{};  // two of the version, two or four of the header's length
  const std::size_t got = file_.read_at(kNpyMagic.size(), words.data(), words.size());
  const std::size_t length_bytes = words[0] == 1 ? 2 : 4;
  if (got < 2 + length_bytes) unreadable(path_, "ends in its header");
  std::size_t size = 0;
  for (std::size_t i = length_bytes; i-- > 0;) size = size * 256 + static_cast<unsigned char>(words[2 + i]);
  if (size > kLongestLine) unreadable(path_, "has a header longer than a table of numbers needs");
  std::string header(size, ' ');
  const std::uintmax_t header_offset = kNpyMagic.size() + 2 + length_bytes;
  if (file_.read_at(header_offset, header.data(), size) != size) unreadable(path_, "ends in its header");
  for (const std::string key : {"descr", "fortran_order", "shape"}) {
    const std::size_t at = header.find("'" + key + "'");
    if (at != std::string::npos && header.find("'" + key + "'", at + 1) != std::string::npos) {
      unreadable(path_, "names " + key + " twice in its header");
    }
  }
  const std::string type = header_value(header, "descr");
  if (type != "'<f8'" && type != "'<f4'") unreadable(path_, "must hold little-endian float64 or float32, not " + type);
  single_ = type == "'<f4'";
  if (header_value(header, "fortran_order") != "False") unreadable(path_, "must be stored row by row (C order)");
  const std::string shape = header_value(header, "shape");
  const auto table = table_shape(shape);
  if (!table || (*table)[1] < 1 || (*table)[1] > kMostColumns) {
    unreadable(path_, "must be a table of points, (n, d) with d up to " + std::to_string(kMostColumns) + ", not " +
                          (shape.empty() ? "of no shape" : shape));
  }
  rows_ = (*table)[0];
  dimension_ = static_cast<int>((*table)[1]);
  data_offset_ = header_offset + size;
  const std::uintmax_t row_bytes = static_cast<std::uintmax_t>(dimension_) * (single_ ? sizeof(float) : sizeof(double));
  // The claim is held against the file before anything is made for it.
  if (static_cast<std::uintmax_t>(rows_) > (file_.size() - data_offset_) / row_bytes) {
    unreadable(path_, "ends before its last point");
  }
  count_row(rows_);
}

void PointsFile::count_row(std::int64_t rows) {
  rows_read_ += rows;
  if (rows_read_ <= max_points_) return;
  refuse("limit_exceeded", "\"" + path_ + "\": more than " + std::to_string(max_points_) + " points (--max-vertices)",
         "");
}

void PointsFile::rewind() {
  offset_ = data_offset_;
  buffer_.clear();
  at_ = 0;
  rows_left_ = rows_;
  rows_read_ = 0;
  line_ = 0;
}

bool PointsFile::next(std::vector<double>& numbers, std::size_t rows) {
  numbers.clear();
  return binary_ ? next_binary(numbers, rows) : next_text(numbers, rows);
}

bool PointsFile::next_binary(std::vector<double>& numbers, std::size_t rows) {
  const std::size_t wanted = std::min<std::size_t>(rows, static_cast<std::size_t>(rows_left_));
  if (wanted == 0) return false;
  const std::size_t count = wanted * static_cast<std::size_t>(dimension_);
  numbers.resize(count);
  std::vector<float> narrow(single_ ? count : 0);
  char* const out = single_ ? reinterpret_cast<char*>(narrow.data()) : reinterpret_cast<char*>(numbers.data());
  const std::size_t bytes = count * (single_ ? sizeof(float) : sizeof(double));
  if (file_.read_at(offset_, out, bytes) != bytes) unreadable(path_, "ends before its last point");
  for (std::size_t i = 0; i < narrow.size(); ++i) numbers[i] = static_cast<double>(narrow[i]);
  offset_ += bytes;
  rows_left_ -= static_cast<std::int64_t>(wanted);
  return true;
}

/// The next line without its end; false at the file's end. It stands in the buffer until the next call.
bool PointsFile::next_line(std::string_view& line) {
  std::size_t end = buffer_.find('\n', at_);
  while (end == std::string::npos && buffer_.size() - at_ <= kLongestLine) {
    buffer_.erase(0, at_);
    at_ = 0;
    const std::size_t before = buffer_.size();
    buffer_.resize(before + kBufferBytes);
    const std::size_t got = file_.read_at(offset_, buffer_.data() + before, kBufferBytes);
    buffer_.resize(before + got);
    offset_ += got;
    end = buffer_.find('\n', before);
    if (got == 0) break;
  }
  if (end == std::string::npos) end = buffer_.size();
  if (at_ == buffer_.size()) return false;
  ++line_;
  if (end - at_ > kLongestLine) unreadable(path_, "line " + std::to_string(line_) + " is longer than a point needs");
  line = std::string_view(buffer_).substr(at_, end - at_);
  at_ = std::min(end + 1, buffer_.size());
  return true;
}

/// Appends the numbers of the next line that has any; false at the end.
bool PointsFile::read_text_row(std::vector<double>& numbers) {
  std::string_view line;
  while (next_line(line)) {
    const auto refuse_here = [&](const std::string& what) {
      unreadable(path_, "line " + std::to_string(line_) + " holds " + what);
    };
    if (line.find('\0') != std::string_view::npos) refuse_here("a zero byte");
    line = line.substr(0, line.find('#'));
    const std::size_t before = numbers.size();
    while (!line.empty()) {
      if (is_separator(line.front())) {
        line.remove_prefix(1);
        continue;
      }
      const char* const end = line.data() + line.size();
      double value = 0;
      const char* const rest = read_decimal(line.data(), end, value);
      if (rest == line.data() || (rest != end && !is_separator(*rest))) refuse_here("something that is no number");
      numbers.push_back(value);
      line.remove_prefix(static_cast<std::size_t>(rest - line.data()));
    }
    const std::size_t count = numbers.size() - before;
    if (count == 0) continue;
    if (dimension_ > 0 && count != static_cast<std::size_t>(dimension_)) {
      refuse_here(std::to_string(count) + " numbers, the first point " + std::to_string(dimension_));
    }
    count_row(1);
    return true;
  }
  return false;
}

bool PointsFile::next_text(std::vector<double>& numbers, std::size_t rows) {
  for (std::size_t i = 0; i < rows; ++i) {
    if (!read_text_row(numbers)) break;
  }
  return !numbers.empty();
}

}  // namespace pd::query

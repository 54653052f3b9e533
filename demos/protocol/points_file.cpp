#include "protocol/points_file.hpp"

#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <system_error>

#include "support/refusal.hpp"

namespace pd::query {

namespace {

constexpr std::size_t kLongestLine = 4096;
constexpr int kMostColumns = 64;

[[noreturn]] void unreadable(const std::string& path, const std::string& why) {
  refuse("unreadable_file", "\"" + path + "\": " + why, "");
}

/// The value behind 'key': in a header of NumPy, a Python dictionary without nesting but for the shape.
std::string header_value(const std::string& header, const std::string& key) {
  const std::size_t at = header.find("'" + key + "'");
  if (at == std::string::npos) return {};
  std::size_t from = header.find(':', at);
  if (from == std::string::npos) return {};
  ++from;
  while (from < header.size() && header[from] == ' ') ++from;
  const std::size_t to = header[from] == '(' ? header.find(')', from) : header.find_first_of(",}", from);
  return header.substr(from, to == std::string::npos ? to : to - from);
}

}  // namespace

PointsFile::PointsFile(const std::string& path) : path_(path), file_(std::fopen(path.c_str(), "rb")) {
  if (!file_) unreadable(path_, std::generic_category().message(errno));
  std::array<char, 6> magic{};
  binary_ = std::fread(magic.data(), 1, magic.size(), file_.get()) == magic.size() &&
            std::memcmp(magic.data(), "\x93NUMPY", magic.size()) == 0;
  if (binary_) {
    open_npy();
  } else {
    rewind();
    std::vector<double> row;
    if (!read_text_row(row)) unreadable(path_, "holds no point");
    dimension_ = static_cast<int>(row.size());
  }
  rewind();
}

void PointsFile::open_npy() {
  std::array<unsigned char, 2> version{};
  std::array<unsigned char, 4> length{};
  const std::size_t length_bytes = [&] {
    if (std::fread(version.data(), 1, 2, file_.get()) != 2) unreadable(path_, "ends in its header");
    return version[0] == 1 ? std::size_t{2} : std::size_t{4};
  }();
  if (std::fread(length.data(), 1, length_bytes, file_.get()) != length_bytes) unreadable(path_, "ends in its header");
  std::size_t size = 0;
  for (std::size_t i = length_bytes; i-- > 0;) size = size * 256 + length[i];
  if (size > kLongestLine) unreadable(path_, "has a header longer than a table of numbers needs");
  std::string header(size, ' ');
  if (std::fread(header.data(), 1, size, file_.get()) != size) unreadable(path_, "ends in its header");
  const std::string type = header_value(header, "descr");
  if (type != "'<f8'" && type != "'<f4'") unreadable(path_, "must hold little-endian float64 or float32, not " + type);
  single_ = type == "'<f4'";
  if (header_value(header, "fortran_order") != "False") unreadable(path_, "must be stored row by row (C order)");
  const std::string shape = header_value(header, "shape");
  long long rows = 0, columns = 0;
  if (std::sscanf(shape.c_str(), "(%lld, %lld", &rows, &columns) != 2 || rows < 0 || columns < 1 ||
      columns > kMostColumns) {
    unreadable(path_, "must be a table of points, [n, d], not " + shape + ")");
  }
  rows_ = rows;
  dimension_ = static_cast<int>(columns);
  data_offset_ = static_cast<std::int64_t>(std::ftell(file_.get()));
}

void PointsFile::rewind() {
  std::fseek(file_.get(), static_cast<long>(data_offset_), SEEK_SET);
  rows_left_ = rows_;
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
  std::size_t got = 0;
  if (single_) {
    std::vector<float> narrow(count);
    got = std::fread(narrow.data(), sizeof(float), count, file_.get());
    for (std::size_t i = 0; i < got; ++i) numbers[i] = static_cast<double>(narrow[i]);
  } else {
    got = std::fread(numbers.data(), sizeof(double), count, file_.get());
  }
  if (got != count) unreadable(path_, "ends before its last point");
  rows_left_ -= static_cast<std::int64_t>(wanted);
  return true;
}

/// Appends the numbers of the next line that has any; false at the end.
bool PointsFile::read_text_row(std::vector<double>& numbers) {
  std::array<char, kLongestLine> buffer;
  while (std::fgets(buffer.data(), static_cast<int>(buffer.size()), file_.get()) != nullptr) {
    ++line_;
    const char* at = buffer.data();
    const char* const end = at + std::strlen(at);
    if (end - at + 1 == static_cast<std::ptrdiff_t>(buffer.size()) && end[-1] != '\n') {
      unreadable(path_, "line " + std::to_string(line_) + " is longer than a point needs");
    }
    const std::size_t before = numbers.size();
    while (at != end && *at != '#') {
      if (*at == ' ' || *at == '\t' || *at == ',' || *at == ';' || *at == '\r' || *at == '\n') {
        ++at;
        continue;
      }
      if (*at == '+') ++at;
      double value = 0;
      const auto [rest, error] = std::from_chars(at, end, value);
      if (error != std::errc()) {
        unreadable(path_, "line " + std::to_string(line_) + " holds something that is no number");
      }
      numbers.push_back(value);
      at = rest;
    }
    if (numbers.size() == before) continue;
    if (dimension_ > 0 && numbers.size() - before != static_cast<std::size_t>(dimension_)) {
      unreadable(path_, "line " + std::to_string(line_) + " holds " + std::to_string(numbers.size() - before) +
                            " numbers, the first point " + std::to_string(dimension_));
    }
    return true;
  }
  if (std::ferror(file_.get()) != 0) unreadable(path_, "cannot be read to its end");
  return false;
}

bool PointsFile::next_text(std::vector<double>& numbers, std::size_t rows) {
  for (std::size_t i = 0; i < rows; ++i) {
    if (!read_text_row(numbers)) break;
  }
  return !numbers.empty();
}

}  // namespace pd::query

/// @file
/// Reads points without faces: XYZ, rows of numbers, and PCD, the format of the Point Cloud Library, as text and as
/// bytes.
#include <array>
#include <optional>

#include "mesh/binary_numbers.hpp"
#include "mesh/mesh_text.hpp"

namespace pd::query {

namespace {

/// Rows of numbers may be separated by blanks, commas and semicolons.
std::string_view next_number(std::string_view& rest) {
  const auto is_separator = [](char c) { return c == ' ' || c == '\t' || c == ',' || c == ';'; };
  while (!rest.empty() && is_separator(rest.front())) rest.remove_prefix(1);
  std::size_t length = 0;
  while (length < rest.size() && !is_separator(rest[length])) ++length;
  const std::string_view word = rest.substr(0, length);
  rest.remove_prefix(length);
  return word;
}

bool is_comment(std::string_view line) {
  const std::size_t begin = line.find_first_not_of(" \t");
  if (begin == std::string_view::npos) return true;
  return line[begin] == '#' || line.substr(begin).starts_with("//");
}

/// Returns the number of points, which stands alone in the first row of some files.
std::optional<std::int64_t> lone_count(std::string_view line) {
  std::int64_t count = 0;
  if (!parse_index(next_number(line), count) || count < 0) return std::nullopt;
  return next_number(line).empty() ? std::optional(count) : std::nullopt;
}

struct Field {
  std::string name;
  NumberType type = NumberType::float32;
  std::int64_t count = 1;
};

/// The header of a PCD file tells what the numbers of each point mean.
struct CloudHeader {
  std::vector<Field> fields;
  std::optional<std::int64_t> points;
  std::string_view data;  ///< "ascii", "binary", ...
};

std::optional<NumberType> number_type(char kind, std::int64_t bytes) {
  switch (bytes) {
    case 1:
      return kind == 'I' ? std::optional(NumberType::int8)
                         : (kind == 'U' ? std::optional(NumberType::uint8) : std::nullopt);
    case 2:
      return kind == 'I' ? std::optional(NumberType::int16)
                         : (kind == 'U' ? std::optional(NumberType::uint16) : std::nullopt);
    case 4:
      if (kind == 'F') return NumberType::float32;
      return kind == 'I' ? std::optional(NumberType::int32)
                         : (kind == 'U' ? std::optional(NumberType::uint32) : std::nullopt);
    case 8:
      return kind == 'F' ? std::optional(NumberType::float64) : std::nullopt;
    default:
      return std::nullopt;
  }
}

/// Reads the header line by line: a keyword and its words. SIZE, TYPE and COUNT follow FIELDS.
class CloudHeaderReader {
 public:
  explicit CloudHeaderReader(TextCursor& cursor) : cursor_(cursor) {}

  CloudHeader read() {
    while (header_.data.empty()) {
      if (cursor_.at_end()) refuse_line(cursor_.line_number(), "the header has no DATA line");
      std::string_view rest = cursor_.next_line();
      if (!is_comment(rest)) take(next_word(rest), rest);
    }
    set_types();
    return std::move(header_);
  }

 private:
  void take(std::string_view keyword, std::string_view rest) {
    if (keyword == "FIELDS") {
      if (!header_.fields.empty()) refuse_line(cursor_.line_number(), "a second FIELDS line");
      for (std::string_view word = next_word(rest); !word.empty(); word = next_word(rest)) {
        if (header_.fields.size() == kMostFields) refuse("limit_exceeded", "the points have more than 1024 fields", "");
        header_.fields.push_back({std::string(word)});
      }
      sizes_.assign(header_.fields.size(), 4);
      kinds_.assign(header_.fields.size(), 'F');
    } else if (header_.fields.empty() && (keyword == "SIZE" || keyword == "TYPE" || keyword == "COUNT")) {
      refuse_line(cursor_.line_number(), std::string(keyword) + " stands before FIELDS");
    } else if (keyword == "SIZE" || keyword == "COUNT") {
      for (std::size_t k = 0; k < header_.fields.size(); ++k) {
        (keyword == "SIZE" ? sizes_[k] : header_.fields[k].count) = positive(next_word(rest), keyword);
      }
    } else if (keyword == "TYPE") {
      for (char& kind : kinds_) {
        const std::string_view word = next_word(rest);
        if (word.size() != 1) refuse_line(cursor_.line_number(), "TYPE needs I, U or F for each field");
        kind = word.front();
      }
    } else if (keyword == "POINTS") {
      header_.points = positive(next_word(rest), keyword);
    } else if (keyword == "DATA") {
      header_.data = next_word(rest);
      if (header_.data.empty()) refuse_line(cursor_.line_number(), "DATA needs ascii or binary");
    } else if (keyword != "VERSION" && keyword != "WIDTH" && keyword != "HEIGHT" && keyword != "VIEWPOINT") {
      refuse_line(cursor_.line_number(), "no line of a PCD header begins with " + std::string(keyword.substr(0, 40)));
    }
  }

  std::int64_t positive(std::string_view word, std::string_view keyword) const {
    std::int64_t value = 0;
    if (!parse_index(word, value) || value < 1 || value > kMost) {
      refuse_line(cursor_.line_number(), std::string(keyword) + " needs whole numbers from 1 to 2^40");
    }
    return value;
  }

  void set_types() {
    for (std::size_t k = 0; k < header_.fields.size(); ++k) {
      const std::optional<NumberType> type = number_type(kinds_[k], sizes_[k]);
      if (!type) {
        refuse("unreadable_file", "the field " + header_.fields[k].name + " has no number of its TYPE and SIZE", "");
      }
      header_.fields[k].type = *type;
    }
  }

  static constexpr std::int64_t kMost = std::int64_t{1} << 40;
  /// A scan has some ten fields. A file of names alone must not fill the memory.
  static constexpr std::size_t kMostFields = 1024;
  TextCursor& cursor_;
  CloudHeader header_;
  std::vector<std::int64_t> sizes_;
  std::string kinds_;
};

/// A point without a measurement has NaN for each coordinate. It is left out.
void add_measured(const Vec3& point, VertexCollector& vertices) {
  if (point.array().isNaN().all()) {
    vertices.leave_out();
  } else {
    vertices.add(point);
  }
}

/// Finds the fields x, y and z by name.
std::array<std::size_t, 3> axes_of(const CloudHeader& header) {
  std::array<std::size_t, 3> at{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::string_view name = std::string_view("xyz").substr(axis, 1);
    std::size_t k = 0;
    while (k < header.fields.size() && header.fields[k].name != name) ++k;
    if (k == header.fields.size() || header.fields[k].count != 1) {
      refuse("unreadable_file", "the points have no field " + std::string(name) + " of one number", "");
    }
    at[axis] = k;
  }
  return at;
}

/// Calls next(type) for each number of each point.
template <class Numbers>
void read_points(const CloudHeader& header, Numbers next, VertexCollector& vertices) {
  const std::array<std::size_t, 3> axes = axes_of(header);
  for (std::int64_t i = 0; i < *header.points; ++i) {
    Vec3 point;
    for (std::size_t k = 0; k < header.fields.size(); ++k) {
      for (std::int64_t n = 0; n < header.fields[k].count; ++n) {
        const double value = next(header.fields[k].type);
        for (int axis = 0; axis < 3; ++axis) {
          if (axes[static_cast<std::size_t>(axis)] == k) point[axis] = value;
        }
      }
    }
    add_measured(point, vertices);
  }
}

}  // namespace

MeshPoints read_xyz(std::string_view bytes, std::int64_t max_vertices) {
  VertexCollector vertices(max_vertices);
  TextCursor cursor(bytes);
  std::optional<std::int64_t> announced;
  bool first = true;
  while (!cursor.at_end()) {
    std::string_view row = cursor.next_line();
    if (is_comment(row)) continue;
    if (std::exchange(first, false)) {
      announced = lone_count(row);
      if (announced) {
        vertices.announce(*announced);
        continue;
      }
    }
    Vec3 point;
    for (int k = 0; k < 3; ++k) {
      if (!parse_decimal(next_number(row), point[k])) {
        refuse_line(cursor.line_number(), "a point needs three numbers: x, y, z; what follows them is not read");
      }
    }
    add_measured(point, vertices);
  }
  if (announced && *announced != vertices.size() + vertices.left_out()) {
    refuse("unreadable_file",
           "the first row says " + std::to_string(*announced) + " points, and " +
               std::to_string(vertices.size() + vertices.left_out()) + " follow",
           "");
  }
  return std::move(vertices).finish();
}

MeshPoints read_pcd(std::string_view bytes, std::int64_t max_vertices) {
  VertexCollector vertices(max_vertices);
  TextCursor cursor(bytes);
  const CloudHeader header = CloudHeaderReader(cursor).read();
  if (!header.points) refuse("unreadable_file", "the header has no POINTS line", "");
  vertices.announce(*header.points);
  if (header.data == "ascii") {
    std::string_view row;
    read_points(
        header,
        [&](NumberType) {
          std::string_view word = next_word(row);
          while (word.empty()) {
            if (cursor.at_end()) refuse_line(cursor.line_number(), "the file ends too early");
            row = cursor.next_line();
            word = next_word(row);
          }
          double value = 0;
          if (!parse_decimal(word, value)) refuse_line(cursor.line_number(), "not a number");
          return value;
        },
        vertices);
  } else if (header.data == "binary") {
    BinaryNumbers numbers(cursor.rest(), false);
    read_points(
        header, [&](NumberType type) { return numbers.next(type); }, vertices);
  } else {
    refuse("unsupported",
           "DATA " + std::string(header.data.substr(0, 40)) + " is not read: save the cloud as ascii or binary", "");
  }
  return std::move(vertices).finish();
}

}  // namespace pd::query

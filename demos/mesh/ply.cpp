/// @file
/// PLY, text and binary (both byte orders): x, y, z of the element "vertex" in whatever type the file declares, and the
/// index lists of every other element that refer to them.
#include <algorithm>
#include <optional>

#include "mesh/binary_numbers.hpp"
#include "mesh/mesh_text.hpp"

namespace pd::query {

namespace {

std::optional<NumberType> parse_type(std::string_view word) {
  if (word == "char" || word == "int8") return NumberType::int8;
  if (word == "uchar" || word == "uint8") return NumberType::uint8;
  if (word == "short" || word == "int16") return NumberType::int16;
  if (word == "ushort" || word == "uint16") return NumberType::uint16;
  if (word == "int" || word == "int32") return NumberType::int32;
  if (word == "uint" || word == "uint32") return NumberType::uint32;
  if (word == "float" || word == "float32") return NumberType::float32;
  if (word == "double" || word == "float64") return NumberType::float64;
  return std::nullopt;
}

struct Property {
  std::string name;
  NumberType type = NumberType::float32;
  std::optional<NumberType> count_type;  ///< of lists

  /// Lists of vertex indices, by the names in use (a strip ends with -1).
  [[nodiscard]] bool names_vertices() const {
    return count_type && (name == "vertex_indices" || name == "vertex_index" || name == "vertex_indexes");
  }
};

struct Element {
  std::string name;
  std::int64_t count = 0;
  std::vector<Property> properties;
};

enum class Format { text, little_endian, big_endian };

struct Header {
  Format format = Format::text;
  std::vector<Element> elements;
};

Header read_header(TextCursor& cursor) {
  if (cursor.next_line() != "ply") refuse_line(1, "a PLY file begins with \"ply\"");
  Header header;
  bool has_format = false;
  for (;;) {
    if (cursor.at_end()) refuse_line(cursor.line_number(), "the header has no end_header");
    std::string_view rest = cursor.next_line();
    const std::string_view keyword = next_word(rest);
    if (keyword == "end_header") break;
    if (keyword == "format") {
      const std::string_view name = next_word(rest);
      has_format = true;
      if (name == "ascii") {
        header.format = Format::text;
      } else if (name == "binary_little_endian") {
        header.format = Format::little_endian;
      } else if (name == "binary_big_endian") {
        header.format = Format::big_endian;
      } else {
        refuse_line(cursor.line_number(), "unknown format");
      }
    } else if (keyword == "element") {
      Element element;
      element.name = next_word(rest);
      if (!parse_index(next_word(rest), element.count) || element.count < 0) {
        refuse_line(cursor.line_number(), "an element needs a name and a count");
      }
      header.elements.push_back(std::move(element));
    } else if (keyword == "property") {
      if (header.elements.empty()) refuse_line(cursor.line_number(), "a property stands before any element");
      Property property;
      std::string_view word = next_word(rest);
      if (word == "list") {
        property.count_type = parse_type(next_word(rest));
        if (!property.count_type) refuse_line(cursor.line_number(), "unknown type");
        word = next_word(rest);
      }
      const std::optional<NumberType> type = parse_type(word);
      if (!type) refuse_line(cursor.line_number(), "unknown type");
      property.type = *type;
      property.name = next_word(rest);
      header.elements.back().properties.push_back(std::move(property));
    }
  }
  if (!has_format) refuse_line(cursor.line_number(), "the header names no format");
  return header;
}

/// The numbers behind the header, one after the other.
class TextBody {
 public:
  explicit TextBody(TextCursor cursor) : cursor_(cursor) {}
  double next(NumberType /*type*/) {
    std::string_view word = next_word(line_);
    while (word.empty()) {
      if (cursor_.at_end()) refuse_line(cursor_.line_number(), "the file ends too early");
      line_ = cursor_.next_line();
      word = next_word(line_);
    }
    double value = 0;
    if (!parse_decimal(word, value)) refuse_line(cursor_.line_number(), "not a number");
    return value;
  }

 private:
  TextCursor cursor_;
  std::string_view line_;
};

template <class Body>
MeshPoints read_body(const Header& header, Body body, std::int64_t max_vertices) {
  VertexCollector vertices(max_vertices);
  for (const Element& element : header.elements) {
    const bool is_vertex = element.name == "vertex";
    if (is_vertex) {
      vertices.announce(element.count);
      for (const char* axis : {"x", "y", "z"}) {
        const bool there = std::any_of(element.properties.begin(), element.properties.end(),
                                       [&](const Property& p) { return p.name == axis && !p.count_type; });
        if (!there) refuse("unreadable_file", std::string("the vertices have no property ") + axis, "");
      }
    }
    if (element.properties.empty()) continue;
    for (std::int64_t i = 0; i < element.count; ++i) {
      Vec3 point = Vec3::Zero();
      for (const Property& property : element.properties) {
        if (property.count_type) {
          const double length = body.next(*property.count_type);
          for (double k = 0; k < length; ++k) {
            const double index = body.next(property.type);
            if (property.names_vertices() && !is_vertex && index != -1) {
              // A value that is no index becomes one that no vertex has.
              vertices.corner(index >= 0 && index < 9e15 ? static_cast<std::int64_t>(index) : -1);
            }
          }
          vertices.end_element(element.name == "face", 0);
        } else {
          const double value = body.next(property.type);
          if (property.name == "x") point.x() = value;
          if (property.name == "y") point.y() = value;
          if (property.name == "z") point.z() = value;
        }
      }
      if (is_vertex) vertices.add(point);
    }
  }
  return std::move(vertices).finish();
}

}  // namespace

MeshPoints read_ply(std::string_view bytes, std::int64_t max_vertices) {
  TextCursor cursor(bytes);
  const Header header = read_header(cursor);
  if (header.format == Format::text) return read_body(header, TextBody(cursor), max_vertices);
  return read_body(header, BinaryNumbers(cursor.rest(), header.format == Format::big_endian), max_vertices);
}

}  // namespace pd::query

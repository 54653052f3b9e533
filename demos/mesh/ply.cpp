/// @file
/// PLY, text and binary (both byte orders): x, y, z of the element "vertex" in whatever type the file declares, and the
/// index lists of every other element that refer to them.
#include <algorithm>
#include <bit>
#include <optional>

#include "mesh/mesh_text.hpp"

namespace pd::query {

namespace {

enum class Type { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

std::optional<Type> parse_type(std::string_view word) {
  if (word == "char" || word == "int8") return Type::int8;
  if (word == "uchar" || word == "uint8") return Type::uint8;
  if (word == "short" || word == "int16") return Type::int16;
  if (word == "ushort" || word == "uint16") return Type::uint16;
  if (word == "int" || word == "int32") return Type::int32;
  if (word == "uint" || word == "uint32") return Type::uint32;
  if (word == "float" || word == "float32") return Type::float32;
  if (word == "double" || word == "float64") return Type::float64;
  return std::nullopt;
}

int size_of(Type type) {
  switch (type) {
    case Type::int8:
    case Type::uint8:
      return 1;
    case Type::int16:
    case Type::uint16:
      return 2;
    case Type::int32:
    case Type::uint32:
    case Type::float32:
      return 4;
    case Type::float64:
      return 8;
  }
  return 0;
}

struct Property {
  std::string name;
  Type type = Type::float32;
  std::optional<Type> count_type;  ///< of lists

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
      const std::optional<Type> type = parse_type(word);
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
  double next(Type /*type*/) {
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

class BinaryBody {
 public:
  BinaryBody(std::string_view bytes, bool big_endian) : rest_(bytes), big_endian_(big_endian) {}
  double next(Type type) {
    const auto size = static_cast<std::size_t>(size_of(type));
    if (rest_.size() < size) refuse("unreadable_file", "the file ends too early", "");
    std::uint64_t word = 0;
    for (std::size_t i = 0; i < size; ++i) {
      const std::size_t at = big_endian_ ? i : size - 1 - i;
      word = word << 8 | static_cast<unsigned char>(rest_[at]);
    }
    rest_.remove_prefix(size);
    switch (type) {
      case Type::int8:
        return static_cast<std::int8_t>(word);
      case Type::uint8:
        return static_cast<std::uint8_t>(word);
      case Type::int16:
        return static_cast<std::int16_t>(word);
      case Type::uint16:
        return static_cast<std::uint16_t>(word);
      case Type::int32:
        return static_cast<std::int32_t>(word);
      case Type::uint32:
        return static_cast<std::uint32_t>(word);
      case Type::float32:
        return double{std::bit_cast<float>(static_cast<std::uint32_t>(word))};
      case Type::float64:
        return std::bit_cast<double>(word);
    }
    return 0;
  }

 private:
  std::string_view rest_;
  bool big_endian_;
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
  return read_body(header, BinaryBody(cursor.rest(), header.format == Format::big_endian), max_vertices);
}

}  // namespace pd::query

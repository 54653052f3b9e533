/// @file
/// Wavefront OBJ: `v` lines, and the elements f, l and p that refer to them.
#include "mesh/mesh_text.hpp"

namespace pd::query {

namespace {

/// OBJ lines may go on after a backslash.
std::string_view logical_line(TextCursor& cursor, std::string& joined) {
  std::string_view line = cursor.next_line();
  if (!line.ends_with('\\')) return line;
  joined.clear();
  while (line.ends_with('\\')) {
    joined += line.substr(0, line.size() - 1);
    joined += ' ';
    if (cursor.at_end()) return joined;
    line = cursor.next_line();
  }
  joined += line;
  return joined;
}

std::string trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r");
  return first == text.npos ? "" : std::string(text.substr(first, text.find_last_not_of(" \t\r") + 1 - first));
}

}  // namespace

MeshPoints read_obj(std::string_view bytes, std::int64_t max_vertices) {
  VertexCollector vertices(max_vertices);
  TextCursor cursor(bytes);
  std::string joined, object, group;
  while (!cursor.at_end()) {
    std::string_view rest = logical_line(cursor, joined);
    const std::string_view keyword = next_word(rest);
    if (keyword == "v") {
      vertices.add(read_point(rest, cursor.line_number()));  // a fourth number is a weight, further ones a colour
    } else if (keyword == "o" || keyword == "g") {
      (keyword == "o" ? object : group) = trimmed(rest);
      if (keyword == "o") group.clear();
      vertices.begin_group(object, group);
    } else if (keyword == "f" || keyword == "l" || keyword == "p") {
      for (std::string_view word = next_word(rest); !word.empty(); word = next_word(rest)) {
        std::int64_t index = 0;
        if (word.starts_with('#')) break;
        if (!parse_index(word.substr(0, word.find('/')), index) || index == 0) {
          refuse_line(cursor.line_number(), "an element needs vertex numbers from 1, or from -1 downwards");
        }
        vertices.corner(index > 0 ? index - 1 : vertices.size() + index);
      }
      vertices.end_element(keyword == "f", cursor.line_number());
    }
  }
  return std::move(vertices).finish();
}

}  // namespace pd::query

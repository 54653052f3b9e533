/// @file
/// STL, binary and text. Every corner of every triangle is a vertex; the hull drops the duplicates.
#include <bit>
#include <cstring>

#include "mesh/mesh_text.hpp"

namespace pd::query {

namespace {

constexpr std::size_t kHeaderBytes = 84;    ///< 80 of comment, 4 of count
constexpr std::size_t kTriangleBytes = 50;  ///< normal, three corners, 2 of attributes

std::uint32_t little_endian_word(const char* bytes) {
  std::uint32_t value = 0;
  for (int i = 3; i >= 0; --i) value = value << 8 | static_cast<unsigned char>(bytes[i]);
  return value;
}

MeshPoints read_binary(std::string_view bytes, std::int64_t max_vertices) {
  const std::uint32_t triangles = little_endian_word(bytes.data() + 80);
  if (bytes.size() < kHeaderBytes + kTriangleBytes * std::size_t{triangles}) {
    refuse("unreadable_file",
           "neither a text STL, which begins with \"solid\", nor a whole binary one: for its " +
               std::to_string(triangles) + " triangles " +
               std::to_string(kHeaderBytes + kTriangleBytes * std::size_t{triangles}) +
               " bytes are needed, the file has " + std::to_string(bytes.size()),
           "");
  }
  VertexCollector vertices(max_vertices);
  vertices.announce(std::int64_t{triangles} * 3);
  for (std::size_t t = 0; t < triangles; ++t) {
    const char* corner = bytes.data() + kHeaderBytes + t * kTriangleBytes + 12;
    for (int c = 0; c < 3; ++c) {
      Vec3 point;
      for (int k = 0; k < 3; ++k, corner += 4) point[k] = double{std::bit_cast<float>(little_endian_word(corner))};
      vertices.corner(vertices.size());
      vertices.add(point);
    }
    vertices.end_element(true, 0);
  }
  return std::move(vertices).finish();
}

MeshPoints read_text(std::string_view bytes, std::int64_t max_vertices) {
  VertexCollector vertices(max_vertices);
  TextCursor cursor(bytes);
  bool closed = false;
  while (!cursor.at_end()) {
    std::string_view rest = cursor.next_line();
    const std::string_view keyword = next_word(rest);
    if (is_word(keyword, "endsolid")) closed = true;
    if (!is_word(keyword, "vertex")) continue;
    vertices.corner(vertices.size());
    vertices.add(read_point(rest, cursor.line_number()));
    if (vertices.size() % 3 == 0) vertices.end_element(true, cursor.line_number());
  }
  if (vertices.size() % 3 != 0 || !closed) {
    refuse_line(cursor.line_number(), "the file ends before its last triangle or its \"endsolid\"");
  }
  return std::move(vertices).finish();
}

}  // namespace

MeshPoints read_stl(std::string_view bytes, std::int64_t max_vertices) {
  // Binary files may begin with "solid" too; their length tells.
  const bool fits_binary =
      bytes.size() >= kHeaderBytes &&
      bytes.size() == kHeaderBytes + kTriangleBytes * std::size_t{little_endian_word(bytes.data() + 80)};
  const std::size_t mark = bytes.starts_with("\xEF\xBB\xBF") ? 3 : 0;
  const bool says_text = is_word(bytes.substr(mark, 5), "solid");
  if (!fits_binary && says_text) return read_text(bytes, max_vertices);
  if (bytes.size() < kHeaderBytes) refuse("unreadable_file", "neither a text nor a binary STL", "");
  return read_binary(bytes, max_vertices);
}

}  // namespace pd::query

/// @file
/// Object File Format, text: [ST][C][N]OFF, counts, vertices, faces.
#include "mesh/mesh_text.hpp"

namespace pd::query {

namespace {

/// Words of an OFF file; a comment runs from # to the end of its line.
class OffWords {
 public:
  explicit OffWords(std::string_view bytes) : cursor_(bytes) {}

  std::string_view next() {
    for (;;) {
      const std::string_view word = next_word(line_);
      if (!word.empty()) return word;
      if (cursor_.at_end()) refuse_line(cursor_.line_number(), "the file ends too early");
      line_ = cursor_.next_line();
      line_ = line_.substr(0, line_.find('#'));
    }
  }
  void skip_line() { line_ = {}; }
  double number(const char* meaning) {
    double value = 0;
    if (!parse_decimal(next(), value)) refuse_line(cursor_.line_number(), std::string(meaning) + " must be a number");
    return value;
  }
  std::int64_t count(const char* meaning) {
    std::int64_t value = 0;
    if (!parse_index(next(), value) || value < 0) {
      refuse_line(cursor_.line_number(), std::string(meaning) + " must be a whole number from 0");
    }
    return value;
  }
  [[nodiscard]] int line_number() const { return cursor_.line_number(); }

 private:
  TextCursor cursor_;
  std::string_view line_;
};

}  // namespace

MeshPoints read_off(std::string_view bytes, std::int64_t max_vertices) {
  VertexCollector vertices(max_vertices);
  OffWords words(bytes);
  const std::string_view header = words.next();
  static constexpr std::string_view kHeaders[] = {"OFF",   "COFF",   "NOFF",   "CNOFF",
                                                  "STOFF", "STCOFF", "STNOFF", "STCNOFF"};
  bool known = false;
  for (const std::string_view name : kHeaders) known = known || header == name;
  if (!known) refuse_line(words.line_number(), "the file must begin with OFF, COFF, NOFF or another text form of OFF");

  const std::int64_t num_vertices = words.count("the number of vertices");
  const std::int64_t num_faces = words.count("the number of faces");
  words.skip_line();  // the number of edges is often wrong and never needed
  vertices.announce(num_vertices);
  for (std::int64_t i = 0; i < num_vertices; ++i) {
    Vec3 point;
    for (int k = 0; k < 3; ++k) point[k] = words.number("a coordinate");
    vertices.add(point);
    words.skip_line();  // normals, colours and texture coordinates follow on the vertex's line
  }
  for (std::int64_t f = 0; f < num_faces; ++f) {
    const std::int64_t corners = words.count("the number of a face's corners");
    for (std::int64_t k = 0; k < corners; ++k) vertices.corner(words.count("a vertex index"));
    vertices.end_element(true, words.line_number());
    words.skip_line();  // a colour may follow
  }
  return std::move(vertices).finish();
}

}  // namespace pd::query

/// @file
/// What the readers of mesh formats share: vertices being collected, and a cursor over text.
#pragma once

#include <charconv>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "mesh/mesh_file.hpp"
#include "support/refusal.hpp"

namespace pd::query {

/// Vertices in file order and which of them an element names.
class VertexCollector {
 public:
  explicit VertexCollector(std::int64_t limit) : limit_(limit) {}

  void add(const Vec3& point) {
    if (static_cast<std::int64_t>(points_.size()) >= limit_) {
      refuse("limit_exceeded", "the mesh has more than " + std::to_string(limit_) + " vertices (--max-vertices)", "");
    }
    points_.push_back(point);
  }
  [[nodiscard]] std::int64_t size() const { return static_cast<std::int64_t>(points_.size()); }
  /// Refuses early what a header announces.
  void announce(std::int64_t count) const {
    if (count > limit_) {
      refuse("limit_exceeded",
             "the mesh has " + std::to_string(count) + " vertices; the limit is " + std::to_string(limit_) +
                 " (--max-vertices)",
             "");
    }
  }
  /// An element names a vertex. Returns false when there is no such vertex.
  [[nodiscard]] bool reference(std::int64_t index) {
    if (index < 0 || index >= size()) return false;
    if (referenced_.size() < points_.size()) referenced_.resize(points_.size(), 0);
    referenced_[static_cast<std::size_t>(index)] = 1;
    any_element_ = true;
    return true;
  }

  [[nodiscard]] MeshPoints finish() && {
    MeshPoints mesh;
    if (!any_element_) {
      mesh.points = std::move(points_);
      return mesh;
    }
    referenced_.resize(points_.size(), 0);
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (referenced_[i] == 0) continue;
      mesh.points.push_back(points_[i]);
      mesh.ids.push_back(static_cast<std::int32_t>(i));
    }
    if (mesh.points.size() == points_.size()) mesh.ids.clear();
    return mesh;
  }

 private:
  std::int64_t limit_;
  std::vector<Vec3> points_;
  std::vector<char> referenced_;
  bool any_element_ = false;
};

[[noreturn]] inline void refuse_line(int line, const std::string& what) {
  refuse("unreadable_file", "line " + std::to_string(line) + ": " + what, "");
}

/// Words and lines of a text.
class TextCursor {
 public:
  explicit TextCursor(std::string_view text) : rest_(text) {}

  [[nodiscard]] int line_number() const { return line_; }
  [[nodiscard]] bool at_end() const { return rest_.empty(); }
  [[nodiscard]] std::string_view rest() const { return rest_; }

  /// The next line without its end (\n, \r\n or \r).
  std::string_view next_line() {
    ++line_;
    const std::size_t end = rest_.find_first_of("\r\n");
    const std::string_view line = rest_.substr(0, end);
    rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
    if (end != std::string_view::npos && rest_.starts_with('\n') && line.data()[line.size()] == '\r') {
      rest_.remove_prefix(1);
    }
    return line;
  }

 private:
  std::string_view rest_;
  int line_ = 0;
};

/// The first word of `rest`, which is then shortened; empty at the end.
inline std::string_view next_word(std::string_view& rest) {
  const std::size_t begin = rest.find_first_not_of(" \t\v\f");
  if (begin == std::string_view::npos) {
    rest = {};
    return {};
  }
  rest.remove_prefix(begin);
  const std::string_view word = rest.substr(0, rest.find_first_of(" \t\v\f"));
  rest.remove_prefix(word.size());
  return word;
}

/// A whole word as a number, correctly rounded; "nan" and "inf" are numbers here. False when it is none.
inline bool parse_number(std::string_view word, double& value) {
  if (word.starts_with('+')) word.remove_prefix(1);
  const auto result = std::from_chars(word.data(), word.data() + word.size(), value);
  if (result.ptr != word.data() + word.size()) return false;
  // Too small is 0 to the precision of a double, too large is no number.
  if (result.ec == std::errc::result_out_of_range) {
    const bool tiny = word.find("e-") != std::string_view::npos || word.find("E-") != std::string_view::npos;
    value = tiny ? 0 : std::numeric_limits<double>::infinity();
    return true;
  }
  return result.ec == std::errc();
}

inline bool parse_index(std::string_view word, std::int64_t& value) {
  if (word.starts_with('+')) word.remove_prefix(1);
  const auto result = std::from_chars(word.data(), word.data() + word.size(), value);
  return result.ec == std::errc() && result.ptr == word.data() + word.size();
}

/// The readers, one a format. `bytes` is the whole file.
MeshPoints read_obj(std::string_view bytes, std::int64_t max_vertices);
MeshPoints read_off(std::string_view bytes, std::int64_t max_vertices);
MeshPoints read_ply(std::string_view bytes, std::int64_t max_vertices);
MeshPoints read_stl(std::string_view bytes, std::int64_t max_vertices);
/// glTF names further files beside itself, so that Assimp opens it by its path.
MeshPoints read_gltf(const std::string& path, std::int64_t max_vertices);

}  // namespace pd::query

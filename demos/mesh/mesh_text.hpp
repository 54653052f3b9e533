/// @file
/// The readers of mesh formats share this: vertices and faces being collected, and a cursor over text.
#pragma once

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <limits>
#include <map>
#include <numeric>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "files/decimal_number.hpp"
#include "mesh/mesh_file.hpp"
#include "support/refusal.hpp"

namespace pd::query {

[[noreturn]] inline void refuse_line(int line, const std::string& what) {
  refuse("unreadable_file", "line " + std::to_string(line) + ": " + what, "");
}

/// True for a word of a format that is written in small letters, in capitals or mixed. `small` is in small letters.
[[nodiscard]] inline bool is_word(std::string_view word, std::string_view small) {
  return std::equal(word.begin(), word.end(), small.begin(), small.end(), [](char written, char letter) {
    return written == letter || (written >= 'A' && written <= 'Z' && written - 'A' + 'a' == letter);
  });
}

/// Vertices in file order, and the elements that name them. Elements may stand before the vertices that they name:
/// whether those are there is asked at the end.
class VertexCollector {
 public:
  explicit VertexCollector(std::int64_t limit) : limit_(limit) {}

  void add(const Vec3& point) {
    if (static_cast<std::int64_t>(points_.size()) >= limit_) {
      refuse("limit_exceeded", "the mesh has more than " + std::to_string(limit_) + " vertices (--max-vertices)", "");
    }
    if (left_out_ > 0) ids_.push_back(static_cast<std::int32_t>(size() + left_out_));
    points_.push_back(point);
  }
  /// Counts a point without a measurement, which is in the file and not in the mesh.
  void leave_out() {
    if (left_out_++ > 0) return;
    ids_.resize(points_.size());
    std::iota(ids_.begin(), ids_.end(), 0);
  }
  [[nodiscard]] std::int64_t size() const { return static_cast<std::int64_t>(points_.size()); }
  [[nodiscard]] std::int64_t left_out() const { return left_out_; }
  /// Refuses early what a header announces.
  void announce(std::int64_t count) const {
    if (count > limit_) {
      refuse("limit_exceeded",
             "the mesh has " + std::to_string(count) + " vertices; the limit is " + std::to_string(limit_) +
                 " (--max-vertices)",
             "");
    }
  }

  /// Refuses early what further elements will name.
  void announce_corners(std::int64_t count) const {
    const std::int64_t most = std::min(kCornersPerVertex * limit_, kMostCorners);
    if (count <= most - static_cast<std::int64_t>(faces_.corners.size())) return;
    refuse("limit_exceeded",
           "the mesh has more than " + std::to_string(most) + " corners of faces, which follows from --max-vertices",
           "");
  }

  /// An element names a vertex. An index that no vertex can have is refused at the end.
  void corner(std::int64_t index) {
    announce_corners(1);
    const bool possible = index >= 0 && index < std::numeric_limits<std::int32_t>::max();
    faces_.corners.push_back(possible ? static_cast<std::int32_t>(index) : -1);
  }
  /// The corners since the last element were a polygon, or else (lines, points, strips) mere references.
  /// @param line  of the file, from 1; 0: the format has no lines
  void end_element(bool is_face, int line) {
    const auto end = static_cast<std::int32_t>(faces_.corners.size());
    if (end == faces_.offsets.back()) return;
    faces_.offsets.push_back(end);
    is_face_.push_back(static_cast<char>(is_face));
    if (line > 0) faces_.lines.push_back(line);
  }

  /// Elements from here on belong to the group of an object, which may go on with an earlier group of the same names.
  void begin_group(const std::string& object, const std::string& group) {
    // Elements before the first name are a group without a name.
    if (faces_.group_names.empty() && faces_.size() > 0) group_ = number_of_group("", "");
    faces_.groups.resize(static_cast<std::size_t>(faces_.size()), group_);
    group_ = number_of_group(object, group);
  }

  [[nodiscard]] MeshPoints finish() && {
    if (!faces_.group_names.empty()) faces_.groups.resize(static_cast<std::size_t>(faces_.size()), group_);
    MeshPoints mesh;
    mesh.left_out = left_out_;
    mesh.faces.lines = {};
    if (faces_.size() == 0) {
      mesh.points = std::move(points_);
      mesh.ids = std::move(ids_);
      return mesh;
    }
    // New number of each vertex that an element names; -1: none does.
    std::vector<std::int32_t> number(points_.size(), -1);
    for (std::int64_t f = 0; f < faces_.size(); ++f) mark(static_cast<std::size_t>(f), number);
    std::int32_t used = 0;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (number[i] < 0) continue;
      number[i] = used++;
      mesh.points.push_back(points_[i]);
      mesh.ids.push_back(static_cast<std::int32_t>(i));
    }
    if (mesh.points.size() == points_.size()) mesh.ids.clear();
    keep_polygons(number, mesh.faces);
    return mesh;
  }

 private:
  /// A closed surface of n vertices has some 6 n corners; open and broken ones, and many handles, may have more.
  static constexpr std::int64_t kCornersPerVertex = 16;
  static constexpr std::int64_t kMostCorners = std::numeric_limits<std::int32_t>::max();

  std::int32_t number_of_group(const std::string& object, const std::string& group) {
    const auto own = object_numbers_.try_emplace(object, static_cast<std::int32_t>(object_numbers_.size())).first;
    const auto next = static_cast<std::int32_t>(faces_.group_names.size());
    const auto [place, fresh] = group_numbers_.try_emplace({own->second, group}, next);
    if (fresh) {
      // A long name of an object is not held once for each of its groups.
      constexpr std::size_t kShown = 40;
      const std::string first = object.substr(0, kShown), second = group.substr(0, kShown);
      faces_.group_names.push_back(first.empty() || second.empty() ? first + second : first + "/" + second);
    }
    return place->second;
  }
  void mark(std::size_t f, std::vector<std::int32_t>& number) const {
    for (auto k = static_cast<std::size_t>(faces_.offsets[f]); k < static_cast<std::size_t>(faces_.offsets[f + 1]);
         ++k) {
      const std::int32_t index = faces_.corners[k];
      if (index < 0 || static_cast<std::size_t>(index) >= points_.size()) {
        const char* const what = "an element names a vertex that is not there";
        if (!faces_.lines.empty()) refuse_line(faces_.lines[f], what);
        refuse("unreadable_file", what, "");
      }
      number[static_cast<std::size_t>(index)] = 0;
    }
  }
  void keep_polygons(const std::vector<std::int32_t>& number, MeshFaces& kept) const {
    for (std::size_t f = 0; f + 1 < faces_.offsets.size(); ++f) {
      if (is_face_[f] == 0) continue;
      for (std::int32_t k = faces_.offsets[f]; k < faces_.offsets[f + 1]; ++k) {
        kept.corners.push_back(number[static_cast<std::size_t>(faces_.corners[static_cast<std::size_t>(k)])]);
      }
      kept.offsets.push_back(static_cast<std::int32_t>(kept.corners.size()));
      if (!faces_.lines.empty()) kept.lines.push_back(faces_.lines[f]);
      if (!faces_.groups.empty()) kept.groups.push_back(faces_.groups[f]);
    }
    kept.group_names = faces_.group_names;
  }

  std::int64_t limit_;
  std::int64_t left_out_ = 0;
  std::int32_t group_ = 0;
  std::map<std::string, std::int32_t> object_numbers_;
  std::map<std::pair<std::int32_t, std::string>, std::int32_t> group_numbers_;
  std::vector<Vec3> points_;
  std::vector<std::int32_t> ids_;  ///< of the points in the file, where some are left out
  MeshFaces faces_;                ///< all elements
  std::vector<char> is_face_;      ///< of each element
};

/// Words and lines of a text.
class TextCursor {
 public:
  /// A byte order mark in front is no part of the text.
  explicit TextCursor(std::string_view text) : rest_(text) {
    if (rest_.starts_with("\xEF\xBB\xBF")) rest_.remove_prefix(3);
  }

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

inline bool parse_index(std::string_view word, std::int64_t& value) {
  if (word.starts_with('+')) word.remove_prefix(1);
  const auto result = std::from_chars(word.data(), word.data() + word.size(), value);
  return result.ec == std::errc() && result.ptr == word.data() + word.size();
}

/// A line's next three words as a point. @throws Refusal at that line.
inline Vec3 read_point(std::string_view& rest, int line) {
  Vec3 point;
  for (int k = 0; k < 3; ++k) {
    if (!parse_decimal(next_word(rest), point[k])) refuse_line(line, "a vertex needs three numbers");
  }
  return point;
}

/// The readers, one a format. `bytes` is the whole file.
MeshPoints read_obj(std::string_view bytes, std::int64_t max_vertices);
MeshPoints read_off(std::string_view bytes, std::int64_t max_vertices);
MeshPoints read_ply(std::string_view bytes, std::int64_t max_vertices);
MeshPoints read_stl(std::string_view bytes, std::int64_t max_vertices);
MeshPoints read_xyz(std::string_view bytes, std::int64_t max_vertices);
MeshPoints read_pcd(std::string_view bytes, std::int64_t max_vertices);
/// glTF names further files: those beside `path`, with `bytes` no more than `max_bytes` in all.
MeshPoints read_gltf(const std::string& path, std::string bytes, std::int64_t max_vertices, std::uintmax_t max_bytes);

}  // namespace pd::query

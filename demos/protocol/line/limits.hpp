/// @file
/// What one line may ask for, so that untrusted input cannot exhaust the machine.
#pragma once

#include <cstddef>
#include <cstdint>

namespace pd::query {

struct Limits {
  /// Longest line in bytes, its newline not counted (`--max-line`). A million points at full precision fit in the
  /// default.
  std::size_t max_line = std::size_t{64} << 20;
  /// Most vertices of one shape, and most facets of one answer (`--max-vertices`).
  std::int64_t max_vertices = 1'000'000;
  /// Most points of a file of points. Such files are for clouds that fit in no line, most of which are never held as a
  /// whole: they may hold a hundred times a shape's vertices, as long as `--max-vertices` is left at its default.
  [[nodiscard]] std::int64_t max_file_points() const {
    return max_vertices == Limits().max_vertices ? 100 * max_vertices : max_vertices;
  }
  /// False: a shape that names a file is refused (`--no-files`).
  bool files = true;
};

/// Deepest nesting of arrays and objects in a line. Compounds may nest 8 deep, which takes about 30.
inline constexpr int kMaxNesting = 100;
/// Deepest nesting of compounds.
inline constexpr int kMaxCompoundNesting = 8;
/// Largest mesh file in bytes: as much as a million triangles take in any of the formats that are read.
inline constexpr std::uintmax_t kMaxMeshBytes = std::uintmax_t{1} << 30;

}  // namespace pd::query

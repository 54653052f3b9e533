/// @file
/// A line read within limits: what it may hold is counted while it is read, so that memory stays a few times the
/// line's.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string_view>
#include <vector>

#include "pd/numeric/vector.hpp"
#include "protocol/line/json_text.hpp"

namespace pd::query {

/// Called with the caller's id as it stands in the line, once it is read, before what follows it is.
using IdSeen = std::function<void(std::string_view id_text)>;

/// `parse_line` with --max-vertices: a longer list under a key "vertices" ends the reading there (limit_exceeded), and
/// so do more JSON values than a line within that limit can need, and values that together take much more memory than
/// the line itself.
///
/// A list of rows of equally many numbers under "vertices", "faces", "outer" or "points" is kept as bytes, which
/// `packed_rows` reads; every other list is an array.
[[nodiscard]] ParsedLine parse_line_within(std::string_view line, std::int64_t max_points, const IdSeen& id_seen = {});

/// The caller's id as it stands in the line's first megabyte, or "null". Keeps nothing of the line in memory.
[[nodiscard]] std::string_view id_of_line(std::string_view line);

/// A list of rows that the reader has packed. Refers to the value.
struct PackedRows {
  const std::uint8_t* bytes;
  std::size_t count;
  std::size_t length;  ///< of each row
  bool of_indices;     ///< whole numbers

  /// A row as JSON.
  [[nodiscard]] Json row(std::size_t index) const;
};

/// Nothing where the value is any other JSON.
[[nodiscard]] std::optional<PackedRows> packed_rows(const Json& value);

/// The points of a packed list of triples of numbers; nothing where the value is any other JSON.
[[nodiscard]] std::optional<std::vector<Vec3>> packed_points(const Json& value);

}  // namespace pd::query

/// @file
/// A line read within limits: what it may hold is counted while it is read, so that memory stays a few times the
/// line's.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "pd/numeric/vector.hpp"
#include "protocol/json_text.hpp"

namespace pd::query {

/// `parse_line` with --max-vertices: a longer list under a key "vertices" ends the reading there (limit_exceeded), and
/// so do more JSON values than a line within that limit can need.
///
/// A list of triples of numbers under that key is kept as bytes, which `packed_points` reads; every other list is an
/// array.
[[nodiscard]] ParsedLine parse_line_within(std::string_view line, std::int64_t max_points);

/// The points of a list that the reader has packed; nothing where the value is any other JSON.
[[nodiscard]] std::optional<std::vector<Vec3>> packed_points(const Json& value);

}  // namespace pd::query

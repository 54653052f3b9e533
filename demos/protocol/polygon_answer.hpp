/// @file
/// The fields of a planar answer, for the protocol and for `pdepth polygon --json`.
#pragma once

#include <cstdint>
#include <vector>

#include "pd/planar/polygon_depth.hpp"
#include "protocol/line/json_writer.hpp"

namespace pd::query {

void write_point2(const Point2& x, JsonWriter& answer);
/// From "class" to "seat"; with `list` every field holds an array ("depths" for "depth", ...). `seats`: of every
/// answer, whether Q fits exactly.
void write_polygon_answers(const std::vector<PolygonDepth>& answers, const std::vector<bool>& seats, bool list,
                           JsonWriter& answer);
/// The fields "slots" and "seat_points".
void write_seats(const PolygonDifference::Seats& seats, JsonWriter& answer);
/// The fields "method" and "stats".
void write_polygon_statistics(const PolygonDifference& r, std::int64_t nanoseconds, JsonWriter& answer);

}  // namespace pd::query

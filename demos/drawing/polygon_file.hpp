/// @file
/// A polygon out of a file: an outline of an SVG drawing, its curves flattened to a stated distance, or the protocol's
/// polygon as JSON.
#pragma once

#include <optional>
#include <string>

#include "pd/planar/polygon.hpp"
#include "protocol/line/limits.hpp"

namespace pd::drawing {

struct PolygonFile {
  Polygon polygon;
  std::string unit;      ///< of SVG drawings that have one: "mm", ...; else empty
  bool drawing = false;  ///< an SVG: y points down
  /// Every point of a curve lies within this distance of an edge of the polygon; 0 where all pieces are straight.
  double flatness = 0;
  double margin = 0;  ///< of a JSON polygon that has one
};

/// @param path      FILE.json, FILE.svg, or FILE.svg#ID for one element of several
/// @param flatness  greatest distance of a curve from its chords, in the file's unit; nothing: 1e-4 of the diagonal of
///                  the outline's box
/// @param unit      coordinates are turned into this one where both are known; empty: the file's own
/// @throws query::Refusal; of a ring at fault it names the edge with its ends.
[[nodiscard]] PolygonFile read_polygon_file(const std::string& path, std::optional<double> flatness,
                                            const std::string& unit, const query::Limits& limits);

}  // namespace pd::drawing

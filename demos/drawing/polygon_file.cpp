#include "drawing/polygon_file.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <utility>

#include "drawing/svg_file.hpp"
#include "files/regular_file.hpp"
#include "protocol/line/json_text.hpp"
#include "protocol/line/json_writer.hpp"
#include "protocol/polygon_reader.hpp"

namespace pd::drawing {

namespace {

constexpr std::uintmax_t kMaxBytes = 256u << 20;
constexpr double kUsualFlatness = 1e-4;  // of the outline's diagonal: below a pixel of a large screen

std::string read_text(const std::string& path) { return query::RegularFile::open(path, kMaxBytes).read_all(); }

/// Twice the area of a ring, positive where it runs counter-clockwise (x right, y up). In a double, from its first
/// point: for the choice of the outer ring, which is then checked exactly.
double twice_area(const std::vector<Point2>& ring) {
  double sum = 0;
  for (std::size_t i = 1; i + 1 < ring.size(); ++i) {
    sum += (ring[i][0] - ring[0][0]) * (ring[i + 1][1] - ring[0][1]) -
           (ring[i][1] - ring[0][1]) * (ring[i + 1][0] - ring[0][0]);
  }
  return sum;
}

std::string point_text(const Point2& p) {
  std::string text = "(";
  query::append_number(text, p[0]);
  text += ", ";
  query::append_number(text, p[1]);
  return text + ")";
}

/// " (from (1, 2) to (3, 4))" for "outer[3]" or "holes[0][2]"; empty for other words.
std::string edge_ends(const query::PolygonRings& rings, std::string_view where) {
  const std::vector<Point2>* ring = nullptr;
  const auto index = [&]() -> std::optional<std::size_t> {
    std::size_t value = 0;
    if (!where.starts_with("[")) return std::nullopt;
    const auto read = std::from_chars(where.data() + 1, where.data() + where.size(), value);
    if (read.ec != std::errc() || read.ptr == where.data() + where.size() || *read.ptr != ']') return std::nullopt;
    where.remove_prefix(static_cast<std::size_t>(read.ptr - where.data()) + 1);
    return value;
  };
  if (where.starts_with("outer")) {
    where.remove_prefix(5);
    ring = &rings.outer;
  } else if (where.starts_with("holes")) {
    where.remove_prefix(5);
    const auto hole = index();
    if (hole && *hole < rings.holes.size()) ring = &rings.holes[*hole];
  }
  if (ring == nullptr) return {};
  const auto vertex = index();
  if (!vertex || *vertex >= ring->size()) return {};
  return ", the edge from " + point_text((*ring)[*vertex]) + " to " + point_text((*ring)[(*vertex + 1) % ring->size()]);
}

Polygon checked(const query::PolygonRings& rings) {
  Expected<Polygon> polygon = query::polygon_of(rings);
  if (!polygon) {
    const Error& error = polygon.error();
    const std::string place = error.where + edge_ends(rings, error.where);
    query::refuse(to_string(error.code), place.empty() ? error.message : place + ": " + error.message, "");
  }
  return std::move(polygon).value();
}

query::PolygonRings read_json(const std::string& text, const query::Limits& limits) {
  const query::ParsedLine parsed = query::parse_line(text);
  if (parsed.refusal) throw *parsed.refusal;
  return query::read_polygon_rings(query::Node(parsed.object), limits);
}

/// Largest |coordinate| differences of the outline's control points.
double diagonal(const SvgOutline& outline) {
  std::vector<Point2> points;
  for (const SvgRing& ring : outline.rings) {
    for (const PlaneCurve& curve : ring) append_bounds(curve, points);
  }
  Point2 low = points.front(), high = points.front();
  for (const Point2& p : points) {
    for (std::size_t k = 0; k < 2; ++k) {
      low[k] = std::min(low[k], p[k]);
      high[k] = std::max(high[k], p[k]);
    }
  }
  return std::hypot(high[0] - low[0], high[1] - low[1]);
}

/// Which side of the outer ring's line is filled follows from the fill rule: of rings that run the same way round, the
/// inner one is no hole under "nonzero".
query::PolygonRings sorted_rings(std::vector<std::vector<Point2>> all, const SvgOutline& outline) {
  std::size_t outer = 0;
  for (std::size_t i = 1; i < all.size(); ++i) {
    if (std::abs(twice_area(all[i])) > std::abs(twice_area(all[outer]))) outer = i;
  }
  query::PolygonRings rings{all[outer], {}, 0};
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (i == outer) continue;
    if (!outline.even_odd && (twice_area(all[i]) > 0) == (twice_area(all[outer]) > 0)) {
      query::refuse(
          "bad_value",
          "subpath " + std::to_string(i + 1) +
              " runs the same way round as the outer one, so that fill-rule nonzero fills it; turn it round, or "
              "say fill-rule=\"evenodd\"",
          "");
    }
    rings.holes.push_back(std::move(all[i]));
  }
  return rings;
}

query::PolygonRings flatten(const SvgOutline& outline, double distance, const query::Limits& limits) {
  std::vector<std::vector<Point2>> all;
  std::size_t left = static_cast<std::size_t>(limits.max_vertices);
  for (const SvgRing& ring : outline.rings) {
    std::vector<Point2> points = {ring.front().from};
    for (const PlaneCurve& curve : ring) {
      if (!append_flattened(curve, distance, left - std::min(left, points.size()), points)) {
        query::refuse("limit_exceeded",
                      "more than " + std::to_string(limits.max_vertices) + " vertices at this --flatness; ask for less",
                      "");
      }
    }
    points.pop_back();  // the first one again
    left -= std::min(left, points.size());
    all.push_back(std::move(points));
  }
  return sorted_rings(std::move(all), outline);
}

PolygonFile read_drawing(const std::string& text, const std::string& id, std::optional<double> flatness,
                         const std::string& unit, const query::Limits& limits) {
  SvgOutline outline = read_svg(text, id);
  if (!unit.empty() && unit != outline.unit) {
    if (outline.unit.empty()) {
      query::refuse(
          "bad_value",
          "the page has no width or height, so that its lengths have no unit; the other drawing's are in " + unit, "");
    }
    const double scale = pixels_of(outline.unit) / pixels_of(unit);
    for (SvgRing& ring : outline.rings) {
      for (PlaneCurve& curve : ring) curve = curve.mapped({scale, 0, 0, scale, 0, 0});
    }
    outline.unit = unit;
  }
  bool curved = false;
  for (const SvgRing& ring : outline.rings) {
    curved = curved || std::any_of(ring.begin(), ring.end(),
                                   [](const PlaneCurve& c) { return c.kind != PlaneCurve::Kind::line; });
  }
  const double distance = flatness ? *flatness : kUsualFlatness * diagonal(outline);
  try {
    return {checked(flatten(outline, distance, limits)), outline.unit, true, curved ? distance : 0, 0};
  } catch (const query::Refusal& refusal) {
    query::refuse(refusal.code, outline.element + ": " + refusal.message, refusal.where);
  }
}

/// The file's ending, in small letters.
std::string ending_of(const std::string& file) {
  std::string ending = std::filesystem::path(file).extension();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return ending;
}

}  // namespace

PolygonFile read_polygon_file(const std::string& path, std::optional<double> flatness, const std::string& unit,
                              const query::Limits& limits) {
  const std::size_t hash = path.rfind('#');
  const bool has_id = hash != std::string::npos && ending_of(path.substr(0, hash)) == ".svg";
  const std::string file = has_id ? path.substr(0, hash) : path;
  try {
    if (ending_of(file) == ".svg") {
      return read_drawing(read_text(file), has_id ? path.substr(hash + 1) : "", flatness, unit, limits);
    }
    if (ending_of(file) != ".json") {
      query::refuse("unreadable_file", "the file ending must be .svg or .json", "");
    }
    const query::PolygonRings rings = read_json(read_text(file), limits);
    return {checked(rings), "", false, 0, rings.margin};
  } catch (const query::Refusal& refusal) {
    // The reader of lines says what a line of queries holds.
    const bool no_object = refusal.message.starts_with("a line must be one JSON object");
    const char* const right = "the file must be one JSON object, {\"outer\": [[x,y],...]}";
    const std::string place = refusal.where.empty() ? "" : refusal.where + ": ";
    query::refuse(refusal.code, path + ": " + place + (no_object ? right : refusal.message), "");
  }
}

}  // namespace pd::drawing

/// @file
/// The lines of a contact record ("pdepth-contacts/1"): the first line, shapes, contacts. One JSON object a line;
/// unknown keys are errors.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "audit/recorded_shape.hpp"

namespace pd::audit {

struct RecordHeader {
  std::string engine;
  bool single_precision = false;  ///< "scalar":"float32"
  std::string unit;               ///< "m" unless the record says otherwise
};

/// What an engine said of a pair that it found in contact.
struct Report {
  struct Point {
    std::optional<Vec3> position_a;
    std::optional<Vec3> position_b;
  };
  double depth = 0;            ///< > 0 overlapping by that much, < 0 a gap
  std::optional<Vec3> normal;  ///< from B to A, any length but zero
  std::vector<Point> points;
};

struct RecordedContact {
  std::string id_text;  ///< the caller's id as JSON
  const RecordedShape* a = nullptr;
  const RecordedShape* b = nullptr;
  Pose pose_a;
  Pose pose_b;
  std::optional<Report> report;  ///< empty: the engine saw no contact
};

/// The shapes of a record by their ids; no entry moves once it is there.
class ShapeTable {
 public:
  /// Keeps the shape of a line {"shape":id,...}. @throws query::Refusal bad_value where the id is taken.
  void define(const query::Node& line, RecordedShape shape);
  /// The shape that is named there, defined on a line before `line_number`.
  /// @throws query::Refusal bad_value where there is none.
  [[nodiscard]] const RecordedShape& named(const query::Node& node, std::int64_t line_number) const;
  [[nodiscard]] std::size_t size() const { return shapes_.size(); }

 private:
  std::unordered_map<std::string, RecordedShape> shapes_;
};

/// The shape of a line {"shape":id,"is":shape}, which `text` holds. @throws query::Refusal.
[[nodiscard]] RecordedShape read_shape_line(const query::Node& line, std::string_view text, std::int64_t line_number,
                                            const query::Limits& limits);

/// @throws query::Refusal; unsupported for a record of another version.
[[nodiscard]] RecordHeader read_header(const query::Node& line);

/// @param text  the line that `line` was parsed from.
/// @throws query::Refusal.
[[nodiscard]] RecordedContact read_contact(const query::Node& line, std::string_view text, std::int64_t line_number,
                                           const ShapeTable& shapes);

/// The text of a member of the object that a line holds, as it stands there; empty where there is none. Requires valid
/// JSON.
[[nodiscard]] std::string_view member_text(std::string_view line, std::string_view key);

}  // namespace pd::audit

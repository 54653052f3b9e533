/// @file
/// A shape of a contact record: any body of the line protocol, or a half-space (an engine's static plane).
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "pd/shape/compound.hpp"
#include "pd/shape/halfspaces.hpp"
#include "protocol/line/field_reader.hpp"
#include "protocol/line/limits.hpp"

namespace pd::audit {

struct RecordedShape {
  std::string kind;                     ///< the protocol's word for its type
  std::optional<Compound> body;         ///< empty for a half-space
  std::optional<Halfspace3> halfspace;  ///< {x : <normal, x> <= offset}, in the shape's own frame
  bool is_union = false;                ///< a compound or a star-shaped body
  /// The longest side of its bounding box in its own frame, margins included; infinite for a half-space.
  double extent = 0;
  std::int64_t line = 0;  ///< where the record defines it
  std::string text;       ///< as the record writes it, JSON

  /// The convex body. Requires one.
  [[nodiscard]] const ConvexShape& convex() const { return body->parts().front().shape; }
};

/// Reads the value of "is".
/// @throws query::Refusal as the protocol says.
[[nodiscard]] RecordedShape read_recorded_shape(const query::Node& node, const query::Limits& limits);

}  // namespace pd::audit

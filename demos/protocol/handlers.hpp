/// @file
/// The queries of the protocol, one function each: reads its fields, writes its answer's fields behind the id.
#pragma once

#include <span>
#include <string_view>

#include "protocol/answer_line.hpp"
#include "protocol/line/field_reader.hpp"
#include "protocol/line/json_writer.hpp"
#include "protocol/shape_reader.hpp"

namespace pd::query {

/// @throws Refusal when the line cannot be answered; what was written by then is dropped.
using Handler = void (*)(const Node& line, Session& session, JsonWriter& answer);

struct QueryEntry {
  std::string_view name;
  Handler handler;
};

/// Every query that the protocol names.
[[nodiscard]] std::span<const QueryEntry> queries();

void answer_depth(const Node& line, Session& session, JsonWriter& answer);
void answer_distance(const Node& line, Session& session, JsonWriter& answer);
void answer_intersect(const Node& line, Session& session, JsonWriter& answer);
void answer_hull(const Node& line, Session& session, JsonWriter& answer);
void answer_support_of_difference(const Node& line, Session& session, JsonWriter& answer);
void answer_point_in_difference(const Node& line, Session& session, JsonWriter& answer);
void answer_contact_manifold(const Node& line, Session& session, JsonWriter& answer);
void answer_time_of_impact(const Node& line, Session& session, JsonWriter& answer);
void answer_directional_depth(const Node& line, Session& session, JsonWriter& answer);
void answer_decomposition(const Node& line, Session& session, JsonWriter& answer);
void answer_minkowski_difference(const Node& line, Session& session, JsonWriter& answer);
void answer_width(const Node& line, Session& session, JsonWriter& answer);
void answer_hierarchy(const Node& line, Session& session, JsonWriter& answer);
void answer_approx_directional_width(const Node& line, Session& session, JsonWriter& answer);
void answer_approx_intersect(const Node& line, Session& session, JsonWriter& answer);
void answer_approx_membership(const Node& line, Session& session, JsonWriter& answer);
void answer_approx_minkowski_sum(const Node& line, Session& session, JsonWriter& answer);
void answer_approx_width(const Node& line, Session& session, JsonWriter& answer);
void answer_approximate(const Node& line, Session& session, JsonWriter& answer);
void answer_epsilon_kernel(const Node& line, Session& session, JsonWriter& answer);
void answer_polygon_depth(const Node& line, Session& session, JsonWriter& answer);

}  // namespace pd::query

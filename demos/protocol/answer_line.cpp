#include "protocol/answer_line.hpp"

#include <algorithm>
#include <array>
#include <new>

#include "protocol/body_reader.hpp"
#include "protocol/bounded_line.hpp"
#include "protocol/handlers.hpp"
#include "protocol/union_queries.hpp"

namespace pd::query {

namespace {

constexpr std::array kQueries{
    QueryEntry{"depth", answer_depth},
    QueryEntry{"distance", answer_distance},
    QueryEntry{"intersect", answer_intersect},
    QueryEntry{"hull", answer_hull},
    QueryEntry{"directional_depth", answer_directional_depth},
    QueryEntry{"support_of_difference", answer_support_of_difference},
    QueryEntry{"point_in_difference", answer_point_in_difference},
    QueryEntry{"width", answer_width},
    QueryEntry{"minkowski_difference", answer_minkowski_difference},
    QueryEntry{"contact_manifold", answer_contact_manifold},
    QueryEntry{"time_of_impact", answer_time_of_impact},
    QueryEntry{"hierarchy", answer_hierarchy},
    QueryEntry{"decomposition", answer_decomposition},
    QueryEntry{"polygon_depth", answer_polygon_depth},
    QueryEntry{"approx_directional_width", answer_approx_directional_width},
    QueryEntry{"approx_intersect", answer_approx_intersect},
    QueryEntry{"approx_minkowski_sum", answer_approx_minkowski_sum},
    QueryEntry{"approx_width", answer_approx_width},
    QueryEntry{"approximate", answer_approximate},
    QueryEntry{"epsilon_kernel", answer_epsilon_kernel},
    QueryEntry{"approx_membership", answer_approx_membership},
};

std::string error_answer(std::string_view id_text, const Refusal& refusal) {
  std::string out;
  JsonWriter writer(out);
  writer.begin_object().key("id").raw(id_text).key("error").begin_object();
  writer.key("code").string(refusal.code);
  writer.key("message").string(refusal.message);
  writer.key("where").string(refusal.where);
  writer.end_object().end_object();
  return out;
}

Handler find_handler(const Node& line) {
  const Node name_node = line.at("query");
  const std::string name = read_string(name_node);
  std::string known;
  for (const QueryEntry& entry : kQueries) {
    if (entry.name == name) {
      const Handler non_convex = names_non_convex(line) ? find_union_handler(name) : nullptr;
      return non_convex ? non_convex : entry.handler;
    }
    known += (known.empty() ? "" : ", ") + std::string(entry.name);
  }
  name_node.refuse("unknown_query", "there is no query \"" + shortened(name) + "\"; known: " + known);
}

/// "a_is":"hull" where a body, or a part of it, is a mesh that is answered as its convex hull.
void write_remarks(const std::vector<Remark>& remarks, JsonWriter& answer) {
  for (const std::string_view body : {"a", "b"}) {
    const auto found = std::find_if(remarks.begin(), remarks.end(), [&](const Remark& remark) {
      const std::string_view path = remark.path;
      return path.starts_with(body) && (path.size() == 1 || path[1] == '.');
    });
    if (found != remarks.end()) answer.key(std::string(body) + "_is").string(found->word);
  }
}

}  // namespace

std::span<const QueryEntry> queries() { return kQueries; }

std::string answer_line(std::string_view line, Session& session) {
  ParsedLine parsed;
  try {
    parsed = parse_line_within(line, session.limits.max_vertices);
    if (parsed.refusal) return error_answer(parsed.id_text, *parsed.refusal);
    std::vector<Remark> remarks;
    const Node root(parsed.object, &remarks);
    std::string out;
    JsonWriter writer(out);
    writer.begin_object().key("id").raw(parsed.id_text);
    find_handler(root)(root, session, writer);
    write_remarks(remarks, writer);
    writer.end_object();
    return out;
  } catch (const Refusal& refusal) {
    return error_answer(parsed.id_text, refusal);
  } catch (const std::bad_alloc&) {
    return error_answer(parsed.id_text, {"limit_exceeded", "this line needs more memory than there is", ""});
  }
}

std::string answer_oversized_line(const Limits& limits) {
  return error_answer(
      "null",
      {"limit_exceeded", "the line is longer than " + std::to_string(limits.max_line) + " bytes (--max-line)", ""});
}

}  // namespace pd::query

#include "protocol/answer_line.hpp"

#include <algorithm>
#include <array>
#include <exception>
#include <functional>
#include <new>
#include <stdexcept>
#include <utility>

#include "protocol/body_reader.hpp"
#include "protocol/handlers.hpp"
#include "protocol/line/bounded_line.hpp"
#include "protocol/line/line_notes.hpp"
#include "protocol/pair_reader.hpp"
#include "protocol/solid_queries.hpp"
#include "protocol/solid_reader.hpp"
#include "protocol/union_queries.hpp"

namespace pd::query {

namespace {

/// Words of an answer to what no reader has refused and no engine could take: a fault of this program.
constexpr const char* kUnforeseen = "this line could not be answered: ";

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

LineAnswer error_answer(std::string_view id_text, const Refusal& refusal) {
  LineAnswer answer{.text = {}, .unreached = false, .limit_exceeded = refusal.code == "limit_exceeded"};
  JsonWriter writer(answer.text);
  writer.begin_object().key("id").raw(id_text).key("error").begin_object();
  writer.key("code").string(refusal.code);
  writer.key("message").string(refusal.message);
  writer.key("where").string(refusal.where);
  writer.end_object().end_object();
  return answer;
}

/// A text of many lines is read line by line, and none of them is JSON.
Refusal refusal_of_line(Refusal refusal, std::string_view line) {
  constexpr std::string_view kBlanks = " \t\r";
  const std::size_t first = line.find_first_not_of(kBlanks), last = line.find_last_not_of(kBlanks);
  const bool whole = first != line.npos && line[first] == '{' && line[last] == '}';
  if (!whole && refusal.message.starts_with("not JSON")) refusal.message += "; a line must be one whole JSON object";
  return refusal;
}

Handler find_handler(const Node& line, const Limits& limits) {
  const Node name_node = line.at("query");
  const std::string name = read_string(name_node);
  std::string known;
  for (const QueryEntry& entry : kQueries) {
    if (entry.name == name) {
      const Handler of_unions = find_union_handler(name);
      if (of_unions == answer_union_contact_manifold && names_sheet(line)) return of_unions;
      if (of_unions != nullptr && names_solid(line, limits)) return find_solid_handler(name);
      return of_unions != nullptr && names_non_convex(line) ? of_unions : entry.handler;
    }
    known += (known.empty() ? "" : ", ") + std::string(entry.name);
  }
  name_node.refuse("unknown_query", "there is no query \"" + shortened(name) + "\"; known: " + known);
}

/// Writes "a_is" where a body, or a part of it, is a mesh, and how many points of its files are left out.
void write_remarks(const std::vector<Remark>& remarks, JsonWriter& answer) {
  for (const std::string_view body : {"a", "b"}) {
    std::string_view word;
    std::int64_t left_out = 0;
    for (const Remark& remark : remarks) {
      const std::string_view path = remark.path;
      if (!path.starts_with(body) || (path.size() > 1 && path[1] != '.')) continue;
      if (word.empty()) word = remark.word;
      left_out += remark.left_out;
    }
    if (!word.empty()) write_body_note(body, word, left_out, answer);
  }
}

LineAnswer answer_parsed(const ParsedLine& parsed, Session& session, Care care) {
  LineAnswer answer;
  LineNotes notes;
  const Node root(parsed.object, &notes);
  JsonWriter writer(answer.text);
  writer.begin_object().key("id").raw(parsed.id_text);
  find_handler(root, session.limits)(root, session, writer);
  write_remarks(notes.remarks, writer);
  if (care == Care::coarse) writer.bracket_unreached();
  writer.end_object();
  answer.unreached = writer.is_bracket_unreached();
  return answer;
}

/// Runs `answer`, and makes an error object of whatever it throws.
LineAnswer answered(const std::string& id_text, const std::function<LineAnswer()>& answer) {
  try {
    return answer();
  } catch (const Refusal& refusal) {
    return error_answer(id_text, refusal);
  } catch (const std::bad_alloc&) {
    return refuse_line(id_text, "this line needs more memory than there is");
  } catch (const std::length_error&) {
    return refuse_line(id_text, "this line needs more memory than there is");
  } catch (const std::exception& error) {
    return error_answer(id_text, {"unsupported", kUnforeseen + std::string(error.what()), ""});
  }
}

/// Asks for two rays of a grid, or for a union's widest bracket. False where the line asks for no depth.
bool coarsen(Json& line) {
  const auto query = line.find("query");
  if (query == line.end() || *query != "depth" || line.contains("metric")) return false;
  const auto convex = [&](const char* body) {
    const auto shape = line.find(body);
    if (shape == line.end() || !shape->is_object()) return true;
    const auto type = shape->find("type");
    return type == shape->end() || (*type != "compound" && *type != "star");
  };
  if (convex("a") && convex("b")) {
    line["method"] = "grid";
    line["delta"] = 0.5;
  } else {
    line["delta"] = 1;
  }
  return true;
}

}  // namespace

std::span<const QueryEntry> queries() { return kQueries; }

LineAnswer answer_line(std::string_view line, Session& session, const IdSeen& id_seen) {
  std::string id = "null";
  const auto keep_id = [&](std::string_view text) {
    id = text;
    if (id_seen) id_seen(text);
  };
  return answered(id, [&] {
    const ParsedLine parsed = parse_line_within(line, session.limits.max_vertices, keep_id);
    id = parsed.id_text;
    if (parsed.refusal) return error_answer(id, refusal_of_line(*parsed.refusal, line));
    return answer_parsed(parsed, session, Care::full);
  });
}

std::optional<LineAnswer> answer_coarsely(std::string_view line, Session& session) {
  std::optional<LineAnswer> coarse;
  (void)answered("null", [&]() -> LineAnswer {
    ParsedLine parsed = parse_line_within(line, session.limits.max_vertices);
    if (!parsed.refusal && coarsen(parsed.object)) coarse = answer_parsed(parsed, session, Care::coarse);
    return {};
  });
  return coarse;
}

LineAnswer refuse_line(std::string_view id_text, std::string message) {
  return error_answer(id_text, {"limit_exceeded", std::move(message), ""});
}

LineAnswer answer_oversized_line(const Limits& limits) {
  return refuse_line("null", "the line is longer than " + std::to_string(limits.max_line) + " bytes (--max-line)");
}

}  // namespace pd::query

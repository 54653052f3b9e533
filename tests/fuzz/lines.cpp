/// @file
/// Any bytes as a line of the protocol: the answer is strict JSON with finite numbers and the caller's id, and never an
/// exception; in full, coarsely, and for one line in 64 in a process of its own under limits of time and memory.
#include <functional>
#include <nlohmann/json.hpp>
#include <string_view>

#include "fuzz/input.hpp"
#include "protocol/answer_line.hpp"
#include "protocol/line/json_text.hpp"
#include "protocol/stream/line_budget.hpp"

namespace {

/// An id comes back byte for byte, also where it holds numbers that no double holds and this parser refuses.
void check_answer(const std::string& text, const std::string& id_text) {
  const std::string start = "{\"id\":" + id_text + ",";
  const bool with_id = text.starts_with(start);
  const nlohmann::json parsed =
      nlohmann::json::parse(with_id ? "{\"id\":null," + text.substr(start.size()) : text, nullptr, false);
  PD_LAW(parsed.is_object() && parsed.contains("id"));
  // Words for what no reader has refused and no engine could take.
  PD_LAW(!parsed.contains("error") ||
         !parsed["error"]["message"].get<std::string>().starts_with("this line could not be answered"));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace pd::query;
  const std::string_view line(reinterpret_cast<const char*>(data), size);
  if (line.find('\n') != std::string_view::npos || is_blank(line)) return 0;
  Session session;
  session.limits.files = false;
  session.limits.max_vertices = 64;
  const LineAnswer answer = answer_line(line, session);
  const ParsedLine parsed = parse_line_within(line, session.limits.max_vertices);
  check_answer(answer.text, parsed.id_text);
  PD_LAW(answer.text.starts_with("{\"id\":" + parsed.id_text + ","));
  if (const auto coarse = answer_coarsely(line, session)) {
    check_answer(coarse->text, parsed.id_text);
    PD_LAW(coarse->unreached);
  }
  if (std::hash<std::string_view>()(line) % 64 == 0) {
    check_answer(answer_within(line, session, {.milliseconds = 20, .megabytes = 200}).text, parsed.id_text);
  }
  return 0;
}

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

void check_answer(const std::string& text) {
  const nlohmann::json parsed = nlohmann::json::parse(text, nullptr, false);
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
  check_answer(answer.text);
  const ParsedLine parsed = parse_line_within(line, session.limits.max_vertices);
  PD_LAW(answer.text.starts_with("{\"id\":" + parsed.id_text + ","));
  if (const auto coarse = answer_coarsely(line, session)) {
    check_answer(coarse->text);
    PD_LAW(coarse->unreached);
  }
  if (std::hash<std::string_view>()(line) % 64 == 0) {
    check_answer(answer_within(line, session, {.milliseconds = 20, .megabytes = 200}).text);
  }
  return 0;
}

/// @file
/// Any bytes as a line of the protocol: the answer is strict JSON with finite numbers, and never an exception.
#include <nlohmann/json.hpp>
#include <string_view>

#include "fuzz/input.hpp"
#include "protocol/answer_line.hpp"
#include "protocol/json_text.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace pd::query;
  const std::string_view line(reinterpret_cast<const char*>(data), size);
  if (line.find('\n') != std::string_view::npos || is_blank(line)) return 0;
  Session session;
  session.limits.files = false;
  session.limits.max_vertices = 64;
  const std::string answer = answer_line(line, session);
  const nlohmann::json parsed = nlohmann::json::parse(answer, nullptr, false);
  PD_LAW(parsed.is_object() && parsed.contains("id"));
  return 0;
}

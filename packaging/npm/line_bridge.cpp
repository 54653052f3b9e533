/// @file
/// The line protocol for the script of the npm package: a line in, the command's answer out. A module of its own holds
/// it, since most programs never ask one.
#include <cstdint>
#include <string>
#include <string_view>

#include "protocol/answer_line.hpp"

namespace {

/// The session that the module keeps between lines.
pd::query::Session& session() {
  static pd::query::Session kept{.limits = {.files = false}};
  return kept;
}

}  // namespace

/// Answers a line, without files.
/// @param length  receives the bytes of the answer, which lives until the next call.
extern "C" const char* pdepth_web_answer_line(const char* line, std::int32_t bytes, std::int32_t* length) {
  static std::string text;
  text = pd::query::answer_line(std::string_view(line, static_cast<std::size_t>(bytes)), session()).text;
  *length = static_cast<std::int32_t>(text.size());
  return text.data();
}

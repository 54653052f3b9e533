/// @file
/// Why a line of the protocol was refused. A refusal leaves a reader as an exception and is caught in one place
/// (`answer_line`), where it becomes an error object; the stream goes on.
#pragma once

#include <string>
#include <string_view>
#include <utility>

namespace pd::query {

struct Refusal {
  std::string code;     ///< a word of the protocol: "bad_value", "missing_field", ...
  std::string message;  ///< what is wrong, and what would be right
  std::string where;    ///< path below the line's object, e.g. "a.vertices[3]"; may be empty
};

[[noreturn]] inline void refuse(std::string_view code, std::string message, std::string where) {
  throw Refusal{std::string(code), std::move(message), std::move(where)};
}

}  // namespace pd::query

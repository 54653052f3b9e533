/// @file
/// One line of JSON, read strictly: RFC 8259 and no more, no key twice in an object, no number past the double range.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "support/refusal.hpp"

namespace pd::query {

using Json = nlohmann::json;

struct ParsedLine {
  ParsedLine() = default;
  ParsedLine(ParsedLine&&) = default;
  ParsedLine& operator=(ParsedLine&&) = default;
  ~ParsedLine();

  Json object;                     ///< the line's object, whole only where `refusal` is empty
  std::string id_text = "null";    ///< the caller's id, byte for byte; null where there is none or it cannot be read
  std::optional<Refusal> refusal;  ///< bad_json, or limit_exceeded for nesting deeper than kMaxNesting
};

/// Parses a line that holds one JSON object. Never throws; the id is kept when it stands before what is wrong.
[[nodiscard]] ParsedLine parse_line(std::string_view line);

/// True when the line holds nothing but the white space of JSON.
[[nodiscard]] bool is_blank(std::string_view line);

}  // namespace pd::query

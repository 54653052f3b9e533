/// @file
/// JSON Schema (2020-12) of the protocol's lines, its answers and contact records: protocol/schema.json, which the
/// build puts into the program.
#pragma once

#include <string_view>

namespace pd::query {

/// Definitions: "line" and "line.NAME", "answer" and "answer.NAME" for each query, "error" and "error_code", "record".
extern const std::string_view kSchema;

}  // namespace pd::query

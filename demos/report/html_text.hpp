/// @file
/// Text of pages: markup escaped, numbers and lengths as people read them.
#pragma once

#include <string>
#include <string_view>

namespace pd::report {

/// Text for HTML and XML, also within double quotes: markup escaped, control characters and bytes that are no UTF-8
/// replaced.
[[nodiscard]] std::string escaped(std::string_view text);

/// Text for a script element within XML or HTML: the same JSON, without '<', '>' and '&'. Requires valid JSON.
[[nodiscard]] std::string script_json(std::string_view json);

/// Three digits: "0", "0.0123", "1.2e-07".
[[nodiscard]] std::string short_number(double value);

/// With a prefix of the unit where it has one ("m", "J", "s"): "1.24 mm"; other units follow the number.
[[nodiscard]] std::string quantity(double value, std::string_view unit);

}  // namespace pd::report

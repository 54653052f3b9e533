#include "report/html_text.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

namespace pd::report {

std::string escaped(std::string_view text) {
  // The writer of JSON replaces what is no UTF-8.
  const std::string clean =
      nlohmann::json::parse(nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
  std::string result;
  for (const char c : clean) {
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        result += static_cast<unsigned char>(c) >= 0x20 || c == '\n' || c == '\t' ? c : '?';
    }
  }
  return result;
}

std::string script_json(std::string_view json) {
  std::string result;
  result.reserve(json.size());
  for (const char c : json) {
    // They can only stand in strings.
    if (c == '<' || c == '>' || c == '&') {
      result += fmt::format("\\u{:04x}", static_cast<unsigned>(c));
    } else {
      result += c;
    }
  }
  return result;
}

std::string short_number(double value) {
  if (value == 0) return "0";
  const double size = std::abs(value);
  if (size >= 1e3 && size < 1e4) return fmt::format("{:.0f}", value);
  return size >= 1e-3 && size < 1e4 ? fmt::format("{:.3g}", value) : fmt::format("{:.1e}", value);
}

std::string quantity(double value, std::string_view unit) {
  if (unit != "m" && unit != "J" && unit != "s") {
    return unit.empty() ? short_number(value) : fmt::format("{} {}", short_number(value), unit);
  }
  struct Prefix {
    double size;
    const char* name;
  };
  constexpr std::array kPrefixes{Prefix{1, ""}, Prefix{1e-3, "m"}, Prefix{1e-6, "\u00b5"}, Prefix{1e-9, "n"}};
  if (value == 0 || std::abs(value) < 1e-10 || std::abs(value) >= 1e4) {
    return fmt::format("{} {}", short_number(value), unit);
  }
  for (const Prefix& prefix : kPrefixes) {
    if (std::abs(value) >= prefix.size) return fmt::format("{:.3g} {}{}", value / prefix.size, prefix.name, unit);
  }
  return fmt::format("{:.3g} n{}", value / 1e-9, unit);
}

}  // namespace pd::report

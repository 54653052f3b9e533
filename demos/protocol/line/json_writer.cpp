#include "protocol/line/json_writer.hpp"

#include <cassert>
#include <charconv>
#include <cmath>

#include "pd/contact/finite_answer.hpp"
#include "support/refusal.hpp"

namespace pd::query {

void append_number(std::string& out, double value) {
  assert(std::isfinite(value));
  char digits[32];
  const auto end = std::to_chars(digits, digits + sizeof(digits), value).ptr;
  const std::string_view text(digits, static_cast<std::size_t>(end - digits));
  out += text;
  if (text.find_first_of(".e") == std::string_view::npos) out += ".0";
}

void append_string(std::string& out, std::string_view text) {
  const std::string json = nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  for (std::size_t i = 0; i < json.size(); ++i) {
    const auto byte_at = [&](std::size_t k) { return k < json.size() ? static_cast<unsigned char>(json[k]) : 0U; };
    // DEL, and U+0080 to U+009F: JSON takes them as they stand, and so do terminals.
    const bool beyond_ascii = byte_at(i) == 0xC2 && byte_at(i + 1) < 0xA0;
    if (byte_at(i) != 0x7F && !beyond_ascii) {
      out += json[i];
      continue;
    }
    const unsigned code = byte_at(beyond_ascii ? ++i : i);
    constexpr const char* kDigits = "0123456789abcdef";
    out += "\\u00";
    out += {kDigits[code / 16], kDigits[code % 16]};
  }
}

void append_json(std::string& out, const nlohmann::json& value) {
  switch (value.type()) {
    case nlohmann::json::value_t::number_float:
      append_number(out, value.get<double>());
      return;
    case nlohmann::json::value_t::array: {
      out += '[';
      bool first = true;
      for (const auto& element : value) {
        if (!first) out += ',';
        first = false;
        append_json(out, element);
      }
      out += ']';
      return;
    }
    case nlohmann::json::value_t::object: {
      out += '{';
      bool first = true;
      for (const auto& [name, element] : value.items()) {
        if (!first) out += ',';
        first = false;
        append_string(out, name);
        out += ':';
        append_json(out, element);
      }
      out += '}';
      return;
    }
    case nlohmann::json::value_t::string:
      append_string(out, value.get_ref<const std::string&>());
      return;
    default:
      out += value.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  }
}

std::string shortened(std::string_view text, std::size_t limit) {
  if (text.size() <= limit) return std::string(text);
  return std::string(text.substr(0, limit)) + "...";
}

void JsonWriter::separate() {
  if (needs_comma_) out_ += ',';
  needs_comma_ = true;
}

JsonWriter& JsonWriter::begin_object() {
  separate();
  out_ += '{';
  needs_comma_ = false;
  return *this;
}

JsonWriter& JsonWriter::end_object() {
  out_ += '}';
  needs_comma_ = true;
  return *this;
}

JsonWriter& JsonWriter::begin_array() {
  separate();
  out_ += '[';
  needs_comma_ = false;
  return *this;
}

JsonWriter& JsonWriter::end_array() {
  out_ += ']';
  needs_comma_ = true;
  return *this;
}

JsonWriter& JsonWriter::key(std::string_view name) {
  separate();
  append_string(out_, name);
  out_ += ':';
  needs_comma_ = false;
  return *this;
}

JsonWriter& JsonWriter::number(double value) {
  if (!std::isfinite(value)) {
    const Error error = past_doubles("");
    refuse(to_string(error.code), error.message, error.where);
  }
  separate();
  append_number(out_, value);
  return *this;
}

JsonWriter& JsonWriter::integer(std::int64_t value) {
  separate();
  out_ += std::to_string(value);
  return *this;
}

JsonWriter& JsonWriter::string(std::string_view text) {
  separate();
  append_string(out_, text);
  return *this;
}

JsonWriter& JsonWriter::boolean(bool value) {
  separate();
  out_ += value ? "true" : "false";
  return *this;
}

JsonWriter& JsonWriter::null() {
  separate();
  out_ += "null";
  return *this;
}

JsonWriter& JsonWriter::vector(const Vec3& value) {
  begin_array();
  for (int i = 0; i < 3; ++i) number(value[i]);
  return end_array();
}

JsonWriter& JsonWriter::bracket_unreached() {
  if (unreached_) return *this;
  unreached_ = true;
  return key("bracket_reached").boolean(false);
}

JsonWriter& JsonWriter::raw(std::string_view json) {
  separate();
  out_ += json;
  return *this;
}

}  // namespace pd::query

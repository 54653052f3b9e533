/// @file
/// JSON text out: keys in the order of writing, doubles in the fewest digits that read back to the same bits.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "pd/numeric/vector.hpp"

namespace pd::query {

/// Appends a finite double. A whole number keeps its ".0", so that -0 and large values stay doubles for every reader.
void append_number(std::string& out, double value);
/// Appends a quoted string; bytes that are no UTF-8 are replaced.
void append_string(std::string& out, std::string_view text);
/// Appends any JSON value, objects with their keys in sorted order.
void append_json(std::string& out, const nlohmann::json& value);

/// At most `limit` bytes of a text that a caller sent, for messages.
[[nodiscard]] std::string shortened(std::string_view text, std::size_t limit = 80);

/// Writes one JSON text; commas are its own business.
class JsonWriter {
 public:
  explicit JsonWriter(std::string& out) : out_(out) {}

  JsonWriter& begin_object();
  JsonWriter& end_object();
  JsonWriter& begin_array();
  JsonWriter& end_array();
  JsonWriter& key(std::string_view name);

  /// @throws Refusal out_of_range for a value that is not finite: JSON has no word for it.
  JsonWriter& number(double value);
  JsonWriter& integer(std::int64_t value);
  JsonWriter& string(std::string_view text);
  JsonWriter& boolean(bool value);
  JsonWriter& null();
  /// [x,y,z]
  JsonWriter& vector(const Vec3& value);
  /// Text that is JSON already.
  JsonWriter& raw(std::string_view json);

  /// "bracket_reached": false, once in a text: the answer's bracket is certified, but wider than asked.
  JsonWriter& bracket_unreached();
  [[nodiscard]] bool is_bracket_unreached() const { return unreached_; }

 private:
  void separate();

  std::string& out_;
  bool needs_comma_ = false;
  bool unreached_ = false;
};

}  // namespace pd::query

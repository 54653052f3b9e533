#include "protocol/json_text.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "protocol/json_writer.hpp"
#include "protocol/limits.hpp"

namespace pd::query {

namespace {

/// Builds the document from the parser's events, so that duplicate keys are seen and nesting is bounded before memory
/// is spent.
///
/// Invariant: `open_` holds the containers that are not yet closed, outermost first; each is the last element of the
/// one before it, so none moves while it is open.
class StrictBuilder final : public nlohmann::json_sax<Json> {
 public:
  bool null() override { return add(Json(nullptr)); }
  bool boolean(bool value) override { return add(Json(value)); }
  bool number_integer(number_integer_t value) override { return add(Json(value)); }
  bool number_unsigned(number_unsigned_t value) override { return add(Json(value)); }
  bool number_float(number_float_t value, const string_t& text) override {
    // An id may be an integer of any length: it goes back as it came.
    if (open_.size() == 1 && open_.back()->is_object() && key_ == "id") id_number_ = text;
    return add(Json(value));
  }
  bool string(string_t& value) override { return add(Json(std::move(value))); }
  bool binary(binary_t& /*value*/) override { return false; }

  bool start_object(std::size_t /*size*/) override { return open(Json(Json::value_t::object)); }
  bool start_array(std::size_t /*size*/) override { return open(Json(Json::value_t::array)); }
  bool end_object() override {
    if (open_.size() == 1) id_read_ = true;
    return close();
  }
  bool end_array() override { return close(); }

  bool key(string_t& value) override {
    if (open_.back()->contains(value)) {
      if (!refusal) {
        refusal = Refusal{"bad_json", "the key \"" + shortened(value) + "\" stands twice in one object", ""};
      }
      // The first "id" is no more the caller's than the second.
      if (open_.size() == 1 && value == "id") id_twice_ = true;
    }
    if (open_.size() == 1 && open_.back()->contains("id")) id_read_ = true;
    key_ = std::move(value);
    return true;
  }

  bool parse_error(std::size_t position, const std::string& /*last_token*/,
                   const nlohmann::detail::exception& error) override {
    // The parser's words carry a library tag in brackets in front: the caller needs what follows.
    std::string words = error.what();
    if (const std::size_t tag = words.find("] "); tag != std::string::npos) words.erase(0, tag + 2);
    refusal = Refusal{"bad_json", "not JSON at byte " + std::to_string(position) + ": " + shortened(words, 300), ""};
    return false;
  }

  [[nodiscard]] std::string id_text() const {
    if (id_twice_ || !id_read_) return "null";
    const auto id = root.find("id");
    if (id == root.end()) return "null";
    if (id->is_number_float()) return id_number_;
    std::string text;
    append_json(text, *id);
    return text;
  }

  Json root;
  std::optional<Refusal> refusal;

 private:
  Json* place(Json&& value) {
    if (open_.empty()) {
      root = std::move(value);
      return &root;
    }
    Json& container = *open_.back();
    if (container.is_array()) {
      container.push_back(std::move(value));
      return &container.back();
    }
    Json& slot = container[key_];
    slot = std::move(value);
    return &slot;
  }
  bool add(Json&& value) {
    place(std::move(value));
    return true;
  }
  bool open(Json&& container) {
    if (open_.size() >= static_cast<std::size_t>(kMaxNesting)) {
      refusal = Refusal{"limit_exceeded",
                        "arrays and objects nest deeper than " + std::to_string(kMaxNesting) + " levels", ""};
      return false;
    }
    open_.push_back(place(std::move(container)));
    return true;
  }
  bool close() {
    open_.pop_back();
    return true;
  }

  std::vector<Json*> open_;
  std::string key_;
  std::string id_number_;
  bool id_twice_ = false;
  bool id_read_ = false;  ///< what follows the id's value is JSON, so that its text is not cut short
};

}  // namespace

bool is_blank(std::string_view line) { return line.find_first_not_of(" \t\r\n") == std::string_view::npos; }

ParsedLine parse_line(std::string_view line) {
  ParsedLine parsed;
  StrictBuilder builder;
  // The parser would take a zero byte for the end of the text and a byte order mark for nothing.
  if (line.find('\0') != std::string_view::npos) {
    parsed.refusal = Refusal{"bad_json", "a zero byte is no JSON", ""};
    return parsed;
  }
  if (line.starts_with("\xEF\xBB\xBF")) {
    parsed.refusal = Refusal{"bad_json", "the line begins with a byte order mark; JSON text has none", ""};
    return parsed;
  }
  Json::sax_parse(line.begin(), line.end(), &builder);
  parsed.id_text = builder.id_text();
  if (builder.refusal) {
    parsed.refusal = std::move(builder.refusal);
  } else if (!builder.root.is_object()) {
    parsed.refusal = Refusal{"bad_json", "a line must be one JSON object, {\"query\": ...}", ""};
  }
  parsed.object = std::move(builder.root);
  return parsed;
}

}  // namespace pd::query

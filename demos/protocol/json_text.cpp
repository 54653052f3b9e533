#include "protocol/json_text.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <utility>
#include <vector>

#include "protocol/bounded_line.hpp"
#include "protocol/json_writer.hpp"
#include "protocol/limits.hpp"
#include "protocol/quick_json.hpp"

namespace pd::query {

namespace {

/// Doubles as one JSON value of bytes.
Json pack(const std::vector<double>& numbers) {
  Json::binary_t::container_type bytes(numbers.size() * sizeof(double));
  std::memcpy(bytes.data(), numbers.data(), bytes.size());
  return Json::binary(std::move(bytes));
}

/// Builds the document from the parser's events, so that duplicate keys are seen and nesting is bounded before memory
/// is spent.
///
/// Invariant: `open_` holds the containers that are not yet closed, outermost first; each is the last element of the
/// one before it, so none moves while it is open.
///
/// What takes memory is counted as it comes: values, and the points under a key "vertices", which are kept as bare
/// doubles for as long as they are triples of numbers (a Json of each would take sixteen times its shortest text).
class StrictBuilder final : public nlohmann::json_sax<Json> {
 public:
  explicit StrictBuilder(std::int64_t max_points) : max_points_(max_points) {}

  bool null() override { return add(Json(nullptr)); }
  bool boolean(bool value) override { return add(Json(value)); }
  bool number_integer(number_integer_t value) override {
    return take_coordinate(static_cast<double>(value)) || add(Json(value));
  }
  bool number_unsigned(number_unsigned_t value) override {
    return take_coordinate(static_cast<double>(value)) || add(Json(value));
  }
  bool number_float(number_float_t value, const string_t& text) override {
    if (take_coordinate(value)) return true;
    // An id may be an integer of any length: it goes back as it came.
    if (open_.size() == 1 && open_.back()->is_object() && key_ == "id") id_number_ = text;
    return add(Json(value));
  }
  bool string(string_t& value) override { return add(Json(std::move(value))); }
  bool binary(binary_t& /*value*/) override { return false; }

  bool start_object(std::size_t /*size*/) override { return open(Json(Json::value_t::object)); }
  bool start_array(std::size_t /*size*/) override {
    if (in_list() && !in_point_) {
      in_point_ = true;
      return true;
    }
    // An id goes back as it came, whatever it holds.
    const bool list = !open_.empty() && open_.back()->is_object() && key_ == "vertices" && !in_id_;
    if (!open(Json(Json::value_t::array))) return false;
    if (list) list_level_ = open_.size();
    return true;
  }
  bool end_object() override {
    if (open_.size() == 1) id_read_ = true;
    return close();
  }
  bool end_array() override {
    if (in_point_) return end_point();
    if (in_list()) {
      if (!coordinates_.empty()) *open_.back() = pack(coordinates_);
      coordinates_ = {};
      list_level_ = 0;
    }
    return close();
  }

  bool key(string_t& value) override {
    if (open_.back()->contains(value)) {
      if (!refusal) {
        refusal = Refusal{"bad_json", "the key \"" + shortened(value) + "\" stands twice in one object", ""};
      }
      // The first "id" is no more the caller's than the second.
      if (open_.size() == 1 && value == "id") id_twice_ = true;
    }
    if (open_.size() == 1 && open_.back()->contains("id")) id_read_ = true;
    if (open_.size() == 1) in_id_ = value == "id";
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
  [[nodiscard]] bool in_list() const { return list_level_ != 0 && open_.size() == list_level_; }

  bool take_coordinate(double value) {
    if (!in_point_ || point_size_ == 3) return false;
    point_[point_size_++] = value;
    return true;
  }
  bool end_point() {
    if (point_size_ != 3) {
      unpack();
      return close();
    }
    coordinates_.insert(coordinates_.end(), point_.begin(), point_.end());
    in_point_ = false;
    point_size_ = 0;
    if (coordinates_.size() <= 3 * static_cast<std::size_t>(max_points_)) return true;
    refusal = Refusal{"limit_exceeded",
                      "more than " + std::to_string(max_points_) + " points; the limit is " +
                          std::to_string(max_points_) + " (--max-vertices)",
                      path()};
    return false;
  }
  /// The list holds something else than triples of numbers: from here on it is JSON like any other.
  void unpack() {
    list_level_ = 0;
    Json& list = *open_.back();
    for (std::size_t i = 0; i + 2 < coordinates_.size(); i += 3) {
      list.push_back({coordinates_[i], coordinates_[i + 1], coordinates_[i + 2]});
    }
    coordinates_ = {};
    if (!in_point_) return;
    in_point_ = false;
    list.push_back(Json(Json::value_t::array));
    for (std::size_t k = 0; k < point_size_; ++k) list.back().push_back(point_[k]);
    point_size_ = 0;
    open_.push_back(&list.back());
  }
  /// Where the innermost open container stands.
  [[nodiscard]] std::string path() const {
    std::string text;
    for (std::size_t i = 1; i < open_.size(); ++i) {
      const Json& parent = *open_[i - 1];
      if (parent.is_array()) {
        text += "[" + std::to_string(parent.size() - 1) + "]";
        continue;
      }
      for (const auto& [name, member] : parent.items()) {
        if (&member == open_[i]) text += (text.empty() ? "" : ".") + shortened(name);
      }
    }
    return text;
  }
  [[nodiscard]] bool too_many_values() {
    // A surface of n points has fewer than 2n faces and 6n corners; as much again for what else a line may hold.
    const std::int64_t limit = 12 * max_points_ + kOtherValues;
    if (++values_ <= limit) return false;
    refusal = Refusal{"limit_exceeded",
                      "more than " + std::to_string(limit) + " JSON values, which follows from --max-vertices", path()};
    return true;
  }

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
    if (in_list()) unpack();
    if (too_many_values()) return false;
    place(std::move(value));
    return true;
  }
  bool open(Json&& container) {
    if (in_list()) unpack();
    if (too_many_values()) return false;
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

  static constexpr std::int64_t kOtherValues = 100'000;

  std::int64_t max_points_;
  std::int64_t values_ = 0;
  std::vector<double> coordinates_;  ///< of the points read so far, in a list of nothing else
  std::array<double, 3> point_{};
  std::size_t point_size_ = 0;
  std::size_t list_level_ = 0;  ///< open containers where such a list is the innermost; 0: there is none
  bool in_point_ = false;

  std::vector<Json*> open_;
  std::string key_;
  std::string id_number_;
  bool in_id_ = false;
  bool id_twice_ = false;
  bool id_read_ = false;  ///< what follows the id's value is JSON, so that its text is not cut short
};

}  // namespace

bool is_blank(std::string_view line) { return line.find_first_not_of(" \t\r\n") == std::string_view::npos; }

ParsedLine parse_line(std::string_view line) { return parse_line_within(line, Limits().max_vertices); }

ParsedLine parse_line_within(std::string_view line, std::int64_t max_points) {
  ParsedLine parsed;
  // The parser would take a zero byte for the end of the text and a byte order mark for nothing.
  if (line.find('\0') != std::string_view::npos) {
    parsed.refusal = Refusal{"bad_json", "a zero byte is no JSON", ""};
    return parsed;
  }
  if (line.starts_with("\xEF\xBB\xBF")) {
    parsed.refusal = Refusal{"bad_json", "the line begins with a byte order mark; JSON text has none", ""};
    return parsed;
  }
  std::optional<StrictBuilder> read(std::in_place, max_points);
  if (read_json_quickly(line, *read) == QuickJson::declined) {
    read.emplace(max_points);
    Json::sax_parse(line.begin(), line.end(), &*read);
  }
  StrictBuilder& builder = *read;
  parsed.id_text = builder.id_text();
  if (builder.refusal) {
    parsed.refusal = std::move(builder.refusal);
  } else if (!builder.root.is_object()) {
    parsed.refusal = Refusal{"bad_json", "a line must be one JSON object, {\"query\": ...}", ""};
  }
  parsed.object = std::move(builder.root);
  return parsed;
}

std::optional<std::vector<Vec3>> packed_points(const Json& value) {
  if (!value.is_binary()) return std::nullopt;
  const Json::binary_t& bytes = value.get_binary();
  std::vector<Vec3> points(bytes.size() / (3 * sizeof(double)));
  for (std::size_t i = 0; i < points.size(); ++i) {
    std::memcpy(points[i].data(), bytes.data() + i * 3 * sizeof(double), 3 * sizeof(double));
  }
  return points;
}

}  // namespace pd::query

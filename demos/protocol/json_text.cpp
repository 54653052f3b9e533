#include "protocol/json_text.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <utility>
#include <vector>

#include "protocol/bounded_line.hpp"
#include "protocol/json_reader.hpp"
#include "protocol/json_writer.hpp"
#include "protocol/limits.hpp"

namespace pd::query {

namespace {

/// Builds the document from the reader's events, so that duplicate keys are seen and nesting is bounded before memory
/// is spent.
///
/// Invariant: `open_` holds the containers that are not yet closed, outermost first; each is the last element of the
/// one before it, so none moves while it is open.
///
/// What takes memory is counted as it comes: values, their bytes, and the points under a key "vertices", which are kept
/// as bare doubles for as long as they are triples of numbers (a Json of each would take sixteen times its shortest
/// text).
class StrictBuilder {
 public:
  StrictBuilder(std::size_t line_size, std::int64_t max_points, const IdSeen& id_seen)
      : max_bytes_(kAnyLine + kBytesPerLetter * line_size), max_points_(max_points), id_seen_(id_seen) {}

  bool null() { return add(Json(nullptr)); }
  bool boolean(bool value) { return add(Json(value)); }
  bool number_integer(std::int64_t value) { return take_coordinate(static_cast<double>(value)) || add(Json(value)); }
  bool number_unsigned(std::uint64_t value) { return take_coordinate(static_cast<double>(value)) || add(Json(value)); }
  bool number_float(double value) { return take_coordinate(value) || add(Json(value)); }
  bool string(std::string& value) {
    bytes_ += kBytesPerString + value.capacity();
    return add(Json(std::move(value)));
  }

  bool start_object() { return open(Json(Json::value_t::object)); }
  bool start_array() {
    if (in_list() && !in_point_) {
      in_point_ = true;
      return true;
    }
    // The caller's id is no shape, whatever it holds.
    const bool list = !open_.empty() && open_.back()->is_object() && key_ == "vertices" && !in_id_;
    if (!open(Json(Json::value_t::array))) return false;
    if (list) list_level_ = open_.size();
    return true;
  }
  bool end_object() { return close(); }
  bool end_array() {
    if (in_point_) return end_point();
    if (in_list()) {
      if (!packed_.empty()) *open_.back() = Json::binary(std::move(packed_));
      packed_ = {};
      list_level_ = 0;
    }
    return close();
  }

  bool key(std::string& value) {
    if (open_.back()->contains(value)) {
      if (!refusal) {
        refusal = Refusal{"bad_json", "the key \"" + shortened(value) + "\" stands twice in one object", ""};
      }
      // The first "id" is no more the caller's than the second.
      if (open_.size() == 1 && value == "id") id_text_.reset();
    }
    if (open_.size() == 1) in_id_ = value == "id";
    bytes_ += kBytesPerMember + value.size();
    key_ = std::move(value);
    return true;
  }
  /// The caller's id goes back as it stands, byte for byte.
  bool member(std::string_view text) {
    if (!in_id_ || open_.size() != 1) return true;
    in_id_ = false;
    if (ids_++ > 0) return true;
    id_text_ = text;
    if (id_seen_) id_seen_(text);
    return true;
  }

  [[nodiscard]] std::string id_text() const { return std::string(id_text_.value_or("null")); }

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
    if (point_size_ != 3) return unpack() && close();
    const std::size_t held = packed_.capacity();
    const auto* const bytes = reinterpret_cast<const std::uint8_t*>(point_.data());
    packed_.insert(packed_.end(), bytes, bytes + sizeof point_);
    bytes_ += packed_.capacity() - held;
    in_point_ = false;
    point_size_ = 0;
    if (packed_.size() > sizeof point_ * static_cast<std::size_t>(max_points_)) {
      refusal = Refusal{"limit_exceeded",
                        "more than " + std::to_string(max_points_) + " points; the limit is " +
                            std::to_string(max_points_) + " (--max-vertices)",
                        path()};
      return false;
    }
    return !too_many_bytes();
  }
  /// The list holds something else than triples of numbers: from here on it is JSON like any other.
  bool unpack() {
    list_level_ = 0;
    const std::size_t count = packed_.size() / sizeof point_;
    bytes_ += (count + 1) * (kBytesPerArray + 7 * sizeof(Json));
    if (too_many_bytes()) return false;
    Json& list = *open_.back();
    for (std::size_t i = 0; i < count; ++i) {
      std::array<double, 3> point;
      std::memcpy(point.data(), packed_.data() + i * sizeof point, sizeof point);
      list.push_back(point);
    }
    packed_ = {};
    if (!in_point_) return true;
    in_point_ = false;
    list.push_back(Json(Json::value_t::array));
    for (std::size_t k = 0; k < point_size_; ++k) list.back().push_back(point_[k]);
    point_size_ = 0;
    open_.push_back(&list.back());
    return true;
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
  [[nodiscard]] bool too_many_bytes() {
    if (bytes_ <= max_bytes_) return false;
    refusal = Refusal{"limit_exceeded",
                      "the values of this line take more than " + std::to_string(max_bytes_ >> 20) +
                          " MB, which no query of its length needs",
                      path()};
    return true;
  }
  /// Counts a value that is about to be placed.
  [[nodiscard]] bool too_many_values(const Json& value) {
    if (value.is_object()) bytes_ += kBytesPerObject;
    if (value.is_array()) bytes_ += kBytesPerArray;
    if (!open_.empty() && open_.back()->is_array()) {
      const auto& list = open_.back()->get_ref<const Json::array_t&>();
      // Such a list doubles when it is full.
      if (list.size() == list.capacity()) bytes_ += sizeof(Json) * std::max<std::size_t>(1, list.size());
    }
    if (too_many_bytes()) return true;
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
    if (in_list() && !unpack()) return false;
    if (too_many_values(value)) return false;
    place(std::move(value));
    return true;
  }
  bool open(Json&& container) {
    if (in_list() && !unpack()) return false;
    if (too_many_values(container)) return false;
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
  // What glibc's allocator takes on a 64-bit machine: a node of std::map with a key and a value, an empty map, an empty
  // vector, a string without its letters.
  static constexpr std::size_t kBytesPerMember = 96, kBytesPerObject = 64, kBytesPerArray = 32, kBytesPerString = 48;
  // Faces take some five times their text and are half of a line with short coordinates, which take half of their text.
  static constexpr std::size_t kAnyLine = std::size_t{32} << 20, kBytesPerLetter = 4;

  std::size_t bytes_ = 0;
  std::size_t max_bytes_;
  std::int64_t max_points_;
  const IdSeen& id_seen_;
  std::int64_t values_ = 0;
  Json::binary_t::container_type packed_;  ///< the points read so far, in a list of nothing else
  std::array<double, 3> point_{};
  std::size_t point_size_ = 0;
  std::size_t list_level_ = 0;  ///< open containers where such a list is the innermost; 0: there is none
  bool in_point_ = false;

  std::vector<Json*> open_;
  std::string key_;
  std::optional<std::string_view> id_text_;
  int ids_ = 0;
  bool in_id_ = false;
};

}  // namespace

bool is_blank(std::string_view line) { return line.find_first_not_of(" \t\r\n") == std::string_view::npos; }

ParsedLine parse_line(std::string_view line) { return parse_line_within(line, Limits().max_vertices); }

ParsedLine parse_line_within(std::string_view line, std::int64_t max_points, const IdSeen& id_seen) {
  ParsedLine parsed;
  if (line.starts_with("\xEF\xBB\xBF")) {
    parsed.refusal = Refusal{"bad_json", "the line begins with a byte order mark; JSON text has none", ""};
    return parsed;
  }
  StrictBuilder builder(line.size(), max_points, id_seen);
  JsonReader<StrictBuilder> reader(line, builder);
  const JsonEnd end = reader.read();
  parsed.id_text = builder.id_text();
  if (end == JsonEnd::broken) {
    parsed.refusal =
        Refusal{"bad_json",
                "not JSON at byte " + std::to_string(reader.error_position()) + ": " + std::string(reader.error()), ""};
  } else if (builder.refusal) {
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

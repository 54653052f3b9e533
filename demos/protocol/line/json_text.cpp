#include "protocol/line/json_text.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <utility>
#include <vector>

#include "protocol/line/bounded_line.hpp"
#include "protocol/line/json_reader.hpp"
#include "protocol/line/json_writer.hpp"
#include "protocol/line/limits.hpp"

namespace pd::query {

namespace {

/// How the bytes of a packed list are to be read.
std::uint64_t packed_rows_subtype(std::size_t row_length, bool of_indices) {
  return 2 * row_length + (of_indices ? 1 : 0);
}

/// Builds the document from the reader's events, so that duplicate keys are seen and nesting is bounded before memory
/// is spent.
///
/// Invariant: `open_` holds the containers that are not yet closed, outermost first; each is the last element of the
/// one before it, so none moves while it is open.
///
/// Builds a document and counts the memory as it comes: values, their bytes, and the rows under the keys of kRowKeys.
/// These are kept as bare doubles for as long as they are equally many numbers each (a Json of each would take sixteen
/// times its shortest text).
class StrictBuilder {
 public:
  StrictBuilder(std::size_t line_size, std::int64_t max_points, const IdSeen& id_seen)
      : max_bytes_(kAnyLine + kBytesPerLetter * line_size), max_points_(max_points), id_seen_(id_seen) {}

  bool null() { return add(Json(nullptr)); }
  bool boolean(bool value) { return add(Json(value)); }
  bool number_integer(std::int64_t value) {
    return take_number(static_cast<double>(value), value >= -kMostIndex && value <= kMostIndex) || add(Json(value));
  }
  bool number_unsigned(std::uint64_t value) {
    return take_number(static_cast<double>(value), value <= kMostIndex) || add(Json(value));
  }
  bool number_float(double value) { return take_number(value, false) || add(Json(value)); }
  /// The caller's id goes back as it stands; nobody reads its numbers.
  [[nodiscard]] bool takes_any_number() const { return in_id_; }
  bool string(std::string& value) {
    bytes_ += kBytesPerString + value.capacity();
    return add(Json(std::move(value)));
  }

  bool start_object() { return open(Json(Json::value_t::object)); }
  bool start_array() {
    if (in_list() && !in_row_) {
      in_row_ = true;
      return true;
    }
    // The caller's id is no shape, whatever it holds.
    const bool list = !open_.empty() && open_.back()->is_object() && is_row_key(key_) && !in_id_;
    if (!open(Json(Json::value_t::array))) return false;
    if (list) {
      list_level_ = open_.size();
      of_indices_ = key_ == "faces";
      max_rows_ = key_ == "vertices" || key_ == "outer" ? max_points_ : 2 * max_points_;
      row_length_ = 0;
    }
    return true;
  }
  bool end_object() { return close(); }
  bool end_array() {
    if (in_row_) return end_row();
    if (in_list()) {
      if (!packed_.empty()) {
        *open_.back() = Json::binary(std::move(packed_), packed_rows_subtype(row_length_, of_indices_));
      }
      packed_ = {};
      list_level_ = 0;
    }
    return close();
  }

  bool key(std::string& value) {
    if (open_.back()->contains(value)) {
      if (!refusal) {
        const std::string name = shortened(value), inside = path();
        refusal = Refusal{"bad_json", "the key \"" + name + "\" stands twice in one object",
                          inside.empty() ? name : inside + "." + name};
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

  static bool is_row_key(std::string_view key) {
    return key == "vertices" || key == "faces" || key == "outer" || key == "points";
  }

  bool take_number(double value, bool index) {
    if (!in_row_ || row_size_ == kLongestRow || (of_indices_ && !index)) return false;
    row_[row_size_++] = value;
    return true;
  }
  bool end_row() {
    if (packed_.empty()) row_length_ = row_size_;
    if (row_size_ != row_length_ || row_length_ < 2) return unpack() && close();
    const std::size_t held = packed_.capacity(), bytes_of_row = row_size_ * sizeof(double);
    const auto* const bytes = reinterpret_cast<const std::uint8_t*>(row_.data());
    if (packed_.size() + bytes_of_row > held && too_many_bytes(2 * held)) return false;  // while it is copied
    packed_.insert(packed_.end(), bytes, bytes + bytes_of_row);
    bytes_ += packed_.capacity() - held;
    in_row_ = false;
    row_size_ = 0;
    if (packed_.size() > bytes_of_row * static_cast<std::size_t>(max_rows_)) {
      refusal = Refusal{"limit_exceeded",
                        "more than " + std::to_string(max_rows_) + (of_indices_ ? " faces" : " points") +
                            "; the limit is " + std::to_string(max_rows_) + " (--max-vertices)",
                        path()};
      return false;
    }
    return true;
  }
  [[nodiscard]] Json number(double value) const {
    return of_indices_ ? Json(static_cast<std::int64_t>(value)) : Json(value);
  }
  /// The list holds something else than rows of equally many numbers: from here on it is JSON like any other.
  bool unpack() {
    list_level_ = 0;
    const std::size_t bytes_of_row = row_length_ * sizeof(double);
    const std::size_t count = packed_.empty() ? 0 : packed_.size() / bytes_of_row;
    bytes_ += (count + 1) * (kBytesPerArray + 2 * sizeof(Json) + 2 * row_length_ * sizeof(Json));
    if (too_many_bytes()) return false;
    Json& list = *open_.back();
    for (std::size_t i = 0; i < count; ++i) {
      std::array<double, kLongestRow> row;
      std::memcpy(row.data(), packed_.data() + i * bytes_of_row, bytes_of_row);
      Json::array_t numbers;
      for (std::size_t k = 0; k < row_length_; ++k) numbers.push_back(number(row[k]));
      list.push_back(std::move(numbers));
    }
    packed_ = {};
    if (!in_row_) return true;
    in_row_ = false;
    list.push_back(Json(Json::value_t::array));
    for (std::size_t k = 0; k < row_size_; ++k) list.back().push_back(number(row_[k]));
    row_size_ = 0;
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
  /// @param more  what is needed for a moment besides
  [[nodiscard]] bool too_many_bytes(std::size_t more = 0) {
    if (bytes_ + more <= max_bytes_) return false;
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
    std::size_t copied = 0;
    if (!open_.empty() && open_.back()->is_array()) {
      const auto& list = open_.back()->get_ref<const Json::array_t&>();
      // Such a list doubles when it is full, and for a moment there are both.
      if (list.size() == list.capacity()) {
        copied = sizeof(Json) * list.size();
        bytes_ += std::max(kLeastAllocation, copied);
      }
    }
    if (too_many_bytes(copied)) return true;
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
  static constexpr std::size_t kBytesPerMember = 96, kBytesPerObject = 64, kBytesPerArray = 32, kBytesPerString = 48,
                               kLeastAllocation = 32;
  // Rows of numbers take at most three times their shortest text, and half of it with all digits. What else a long line
  // may hold is short.
  static constexpr std::size_t kAnyLine = std::size_t{32} << 20, kBytesPerLetter = 2;
  static constexpr std::size_t kLongestRow = 8;
  static constexpr std::int64_t kMostIndex = std::int64_t{1} << 31;

  std::size_t bytes_ = 0;
  std::size_t max_bytes_;
  std::int64_t max_points_;
  const IdSeen& id_seen_;
  std::int64_t values_ = 0;
  Json::binary_t::container_type packed_;  ///< the rows read so far, in a list of nothing else
  std::array<double, kLongestRow> row_{};
  std::size_t row_size_ = 0;
  std::size_t row_length_ = 0;  ///< of the rows read so far
  std::int64_t max_rows_ = 0;
  std::size_t list_level_ = 0;  ///< open containers where such a list is the innermost; 0: there is none
  bool in_row_ = false;
  bool of_indices_ = false;  ///< a list of faces: whole numbers only

  std::vector<Json*> open_;
  std::string key_;
  std::optional<std::string_view> id_text_;
  int ids_ = 0;
  bool in_id_ = false;
};

/// Looks for the caller's id and keeps nothing else.
class IdFinder {
 public:
  static bool null() { return true; }
  static bool boolean(bool /*value*/) { return true; }
  static bool number_integer(std::int64_t /*value*/) { return true; }
  static bool number_unsigned(std::uint64_t /*value*/) { return true; }
  static bool number_float(double /*value*/) { return true; }
  static bool takes_any_number() { return true; }
  static bool string(const std::string& /*value*/) { return true; }
  bool start_object() { return ++level_ <= kMaxNesting; }
  bool start_array() { return ++level_ <= kMaxNesting; }
  bool end_object() { return --level_ >= 0; }
  bool end_array() { return --level_ >= 0; }
  bool key(std::string_view name) {
    if (level_ == 1) at_id_ = name == "id";
    return true;
  }
  bool member(std::string_view text) {
    if (level_ != 1 || !at_id_) return true;
    found = text;
    return false;
  }

  std::string_view found = "null";

 private:
  int level_ = 0;
  bool at_id_ = false;
};

/// Ends the values inside one by one. Json's own end copies every list first, which takes as much memory again.
void release(Json& value) {
  if (!value.is_structured()) return;
  for (Json& inner : value) {
    release(inner);
    inner = nullptr;
  }
  if (value.is_array()) value.get_ref<Json::array_t&>().clear();
}

/// By its byte order mark, or because one of the first two bytes is zero.
bool is_utf16(std::string_view line) {
  return line.starts_with("\xFF\xFE") || line.starts_with("\xFE\xFF") || line.substr(0, 2).find('\0') != line.npos;
}

}  // namespace

bool is_blank(std::string_view line) { return line.find_first_not_of(" \t\r\n") == std::string_view::npos; }

ParsedLine parse_line(std::string_view line) { return parse_line_within(line, Limits().max_vertices); }

ParsedLine parse_line_within(std::string_view line, std::int64_t max_points, const IdSeen& id_seen) {
  ParsedLine parsed;
  if (line.starts_with("\xEF\xBB\xBF")) {
    parsed.refusal = Refusal{"bad_json", "the line begins with a byte order mark; JSON text has none", ""};
    return parsed;
  }
  if (is_utf16(line)) {
    parsed.refusal = Refusal{"bad_json", "the line is UTF-16; UTF-8 is read", ""};
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

std::string_view id_of_line(std::string_view line) {
  constexpr std::size_t kLookedAt = std::size_t{1} << 20;
  IdFinder finder;
  (void)JsonReader<IdFinder>(line.substr(0, kLookedAt), finder).read();
  return finder.found;
}

ParsedLine::~ParsedLine() { release(object); }

std::optional<PackedRows> packed_rows(const Json& value) {
  if (!value.is_binary()) return std::nullopt;
  const Json::binary_t& bytes = value.get_binary();
  const std::size_t length = static_cast<std::size_t>(bytes.subtype() / 2);
  return PackedRows{bytes.data(), bytes.size() / (length * sizeof(double)), length, bytes.subtype() % 2 == 1};
}

Json PackedRows::row(std::size_t index) const {
  Json::array_t numbers;
  for (std::size_t k = 0; k < length; ++k) {
    double value = 0;
    std::memcpy(&value, bytes + (index * length + k) * sizeof value, sizeof value);
    numbers.push_back(of_indices ? Json(static_cast<std::int64_t>(value)) : Json(value));
  }
  return numbers;
}

std::optional<std::vector<Vec3>> packed_points(const Json& value) {
  const auto rows = packed_rows(value);
  if (!rows || rows->length != 3 || rows->of_indices) return std::nullopt;
  const Json::binary_t& bytes = value.get_binary();
  std::vector<Vec3> points(bytes.size() / (3 * sizeof(double)));
  for (std::size_t i = 0; i < points.size(); ++i) {
    std::memcpy(points[i].data(), bytes.data() + i * 3 * sizeof(double), 3 * sizeof(double));
  }
  return points;
}

}  // namespace pd::query

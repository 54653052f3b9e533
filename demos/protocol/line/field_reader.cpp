#include "protocol/line/field_reader.hpp"

#include <algorithm>
#include <cmath>

#include "protocol/line/bounded_line.hpp"
#include "protocol/line/json_writer.hpp"
#include "protocol/line/line_notes.hpp"

namespace pd::query {

namespace {

/// What stands in the line, for messages.
std::string shown(const Json& value) {
  if (value.is_array()) return "an array of " + std::to_string(value.size());
  if (value.is_object()) return "an object";
  if (const auto rows = packed_rows(value)) return "an array of " + std::to_string(rows->count);
  std::string text;
  if (value.is_string()) {
    append_string(text, shortened(value.get_ref<const std::string&>()));
  } else {
    append_json(text, value);
  }
  return text;
}

bool is_non_finite_word(const Json& value) {
  if (!value.is_string()) return false;
  const auto& word = value.get_ref<const std::string&>();
  return word == "nan" || word == "inf" || word == "-inf";
}

}  // namespace

std::string Node::path() const {
  if (parent_ == nullptr) return {};
  std::string text = parent_->path();
  if (key_.data() != nullptr) {
    if (!text.empty()) text += '.';
    text += shortened(key_);
  } else {
    text += '[';
    text += std::to_string(index_);
    text += ']';
  }
  return text;
}

std::optional<Node> Node::find(std::string_view key) const {
  const auto member = value_->find(key);
  if (member == value_->end()) return std::nullopt;
  return Node(*member, this, member.key(), 0);
}

Node Node::at(std::string_view key) const {
  const auto member = value_->find(key);
  if (member == value_->end()) {
    const std::string here = path();
    query::refuse("missing_field", "\"" + std::string(key) + "\" is missing",
                  here.empty() ? std::string(key) : here + "." + std::string(key));
  }
  return {*member, this, member.key(), 0};
}

Node Node::element(std::size_t index) const {
  const auto rows = packed_rows(*value_);
  if (!rows) return {(*value_)[index], this, {}, index};
  auto made = std::make_shared<const Json>(rows->row(index));
  Node node(*made, this, {}, index);
  node.made_ = std::move(made);
  return node;
}

std::size_t Node::size() const {
  const auto rows = packed_rows(*value_);
  return rows ? rows->count : value_->size();
}

LineNotes* Node::notes() const {
  const Node* root = this;
  while (root->parent_ != nullptr) root = root->parent_;
  return root->notes_;
}

void Node::remark(std::string word, std::int64_t left_out) const {
  LineNotes* const line = notes();
  if (line == nullptr) return;
  const std::string here = path();
  const bool said = std::any_of(line->remarks.begin(), line->remarks.end(),
                                [&](const Remark& remark) { return remark.path == here; });
  if (!said) line->remarks.push_back({here, std::move(word), left_out});
}

void Node::refuse(std::string_view code, std::string message) const { query::refuse(code, std::move(message), path()); }

void Node::refuse(const Error& error) const {
  std::string where = path();
  if (!where.empty() && !error.where.empty()) where += '.';
  query::refuse(to_string(error.code), error.message, where + error.where);
}

void require_object(const Node& node) {
  if (!node.json().is_object()) node.refuse("bad_value", "must be an object, is " + shown(node.json()));
}

void require_array(const Node& node, std::string_view meaning) {
  if (!node.is_array()) {
    node.refuse("bad_value", "must be " + std::string(meaning) + ", is " + shown(node.json()));
  }
}

void allow_only(const Node& object, std::initializer_list<std::string_view> keys) {
  for (const auto& [name, value] : object.json().items()) {
    if (std::find(keys.begin(), keys.end(), name) != keys.end()) continue;
    std::string known;
    for (const std::string_view key : keys) known += (known.empty() ? "" : ", ") + std::string(key);
    object.find(name)->refuse("bad_value", "unknown key \"" + shortened(name) + "\"; known here: " + known);
  }
}

double read_number(const Node& node) {
  const Json& value = node.json();
  if (value.is_number()) return value.get<double>();  // the parser refuses what is past the double range
  if (is_non_finite_word(value)) node.refuse("non_finite", "must be a finite number, is " + shown(value));
  node.refuse("bad_value", "must be a number, is " + shown(value));
}

std::int64_t read_integer(const Node& node, std::int64_t low, std::int64_t high) {
  const double value = read_number(node);
  if (std::floor(value) != value) node.refuse("bad_value", "must be a whole number, is " + shown(node.json()));
  if (value < static_cast<double>(low) || value > static_cast<double>(high)) {
    node.refuse("bad_value",
                "must lie in [" + std::to_string(low) + ", " + std::to_string(high) + "], is " + shown(node.json()));
  }
  return static_cast<std::int64_t>(value);
}

bool read_flag(const Node& object, std::string_view key) {
  const auto node = object.find(key);
  if (!node) return false;
  if (!node->json().is_boolean()) node->refuse("bad_value", "must be true or false");
  return node->json().get<bool>();
}

std::string read_string(const Node& node) {
  if (!node.json().is_string()) node.refuse("bad_value", "must be a string, is " + shown(node.json()));
  return node.json().get<std::string>();
}

std::vector<double> read_numbers(const Node& node, std::size_t count) {
  const std::string meaning = "an array of " + std::to_string(count) + " numbers";
  require_array(node, meaning);
  if (node.size() != count) node.refuse("bad_value", "must be " + meaning + ", has " + std::to_string(node.size()));
  std::vector<double> numbers(count);
  for (std::size_t i = 0; i < count; ++i) numbers[i] = read_number(node.element(i));
  return numbers;
}

Vec3 read_vector(const Node& node) {
  const std::vector<double> numbers = read_numbers(node, 3);
  return {numbers[0], numbers[1], numbers[2]};
}

std::vector<Vec3> read_points(const Node& node, std::int64_t limit) {
  auto packed = packed_points(node.json());
  if (!packed) require_array(node, "an array of points [x,y,z]");
  const std::size_t size = packed ? packed->size() : node.size();
  if (size > static_cast<std::size_t>(limit)) {
    node.refuse("limit_exceeded",
                std::to_string(size) + " points; the limit is " + std::to_string(limit) + " (--max-vertices)");
  }
  if (packed) return *std::move(packed);
  std::vector<Vec3> points;
  points.reserve(node.size());
  for (std::size_t i = 0; i < node.size(); ++i) {
    const Node point = node.element(i);
    const Json& value = point.json();
    if (!value.is_array() || value.size() != 3) {
      point.refuse("bad_value", "must be a point [x,y,z], is " + shown(value));
    }
    Vec3 coordinates;
    for (std::size_t k = 0; k < 3; ++k) {
      const Json& number = value[k];
      if (number.is_number()) {
        coordinates[static_cast<int>(k)] = number.get<double>();
      } else if (is_non_finite_word(number)) {
        point.refuse("non_finite", "coordinates must be finite numbers, one is " + shown(number));
      } else {
        point.refuse("bad_value", "coordinates must be numbers, one is " + shown(number));
      }
    }
    points.push_back(coordinates);
  }
  return points;
}

}  // namespace pd::query

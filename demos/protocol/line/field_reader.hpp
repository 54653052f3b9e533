/// @file
/// Values out of a parsed line, each with the path by which the caller finds it: a refusal says where.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pd/numeric/expected.hpp"
#include "pd/numeric/vector.hpp"
#include "protocol/line/json_text.hpp"

namespace pd::query {

struct LineNotes;

/// A JSON value and its place in the line. Refers to its parent, which must outlive it; no path is built before a
/// refusal. A list that the reader has packed is an array here: its rows are made on demand.
class Node {
 public:
  /// @param notes  of the line; may be null
  explicit Node(const Json& root, LineNotes* notes = nullptr) : value_(&root), notes_(notes) {}

  [[nodiscard]] const Json& json() const { return *value_; }
  /// "a.vertices[3]"; empty for the line itself.
  [[nodiscard]] std::string path() const;

  /// The member of that name, or nothing. Requires an object.
  [[nodiscard]] std::optional<Node> find(std::string_view key) const;
  /// The member of that name; refused as missing_field where there is none. Requires an object.
  [[nodiscard]] Node at(std::string_view key) const;
  [[nodiscard]] bool is_array() const { return value_->is_array() || value_->is_binary(); }
  [[nodiscard]] Node element(std::size_t index) const;
  [[nodiscard]] std::size_t size() const;

  /// The notes of the line that this node is a part of, or null.
  [[nodiscard]] LineNotes* notes() const;
  /// Has the answer say a word about this node, once for each node. @param left_out  as in Remark
  void remark(std::string word, std::int64_t left_out = 0) const;
  [[noreturn]] void refuse(std::string_view code, std::string message) const;
  /// Passes a factory's refusal on, its `where` taken as a path below this node.
  [[noreturn]] void refuse(const Error& error) const;

 private:
  Node(const Json& value, const Node* parent, std::string_view key, std::size_t index)
      : value_(&value), parent_(parent), key_(key), index_(index) {}

  std::shared_ptr<const Json> made_;  ///< a row of a packed list
  const Json* value_;
  const Node* parent_ = nullptr;
  std::string_view key_;
  std::size_t index_ = 0;
  LineNotes* notes_ = nullptr;  ///< of the root
};

/// Refuses a value that is no object (bad_value).
void require_object(const Node& node);
/// Refuses any key that is not listed (bad_value, at the key).
void allow_only(const Node& object, std::initializer_list<std::string_view> keys);
/// Refuses a value that is no array (bad_value).
void require_array(const Node& node, std::string_view meaning);

/// Unwraps a factory's answer.
template <class T>
T value_or_refuse(Expected<T> expected, const Node& node) {
  if (!expected) node.refuse(expected.error());
  return std::move(expected).value();
}

/// A finite number. "nan", "inf" and "-inf" as strings are refused as non_finite, anything else as bad_value.
[[nodiscard]] double read_number(const Node& node);
/// A whole number in [low, high]; 3.0 is one.
[[nodiscard]] std::int64_t read_integer(const Node& node, std::int64_t low, std::int64_t high);
[[nodiscard]] std::string read_string(const Node& node);
/// The member of that name, true or false; false where there is none.
[[nodiscard]] bool read_flag(const Node& object, std::string_view key);
/// `count` numbers; a refusal names the component.
[[nodiscard]] std::vector<double> read_numbers(const Node& node, std::size_t count);
[[nodiscard]] Vec3 read_vector(const Node& node);
/// A list of points; a refusal names the point ("a.vertices[3]"). More than `limit` are limit_exceeded.
[[nodiscard]] std::vector<Vec3> read_points(const Node& node, std::int64_t limit);

}  // namespace pd::query

/// @file
/// A value, or a named reason why there is none. Only factories return it: a query on validated types cannot fail.
///
/// std::expected is C++23; this is the small part of it that the library needs, with the same names. Other than there,
/// `*` and `->` throw, too, where there is no value.
#pragma once

#include <cassert>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

#include "pd/numeric/language.hpp"

namespace pd {

/// Why an input was refused. The names are those of the line protocol (`to_string`).
enum class ErrorCode {
  bad_value,
  non_finite,
  out_of_range,
  too_few_points,
  not_full_dimensional,
  not_convex,
  bad_faces,
  not_closed,
  not_a_rotation,
  zero_direction,
  unbounded,
  unsupported,
  limit_exceeded,
};

/// The protocol's word for a code, e.g. "not_convex".
[[nodiscard]] std::string_view to_string(ErrorCode code);

/// A refusal: what is wrong and what would be right, and where (a path below the input, e.g. "vertices[3]").
struct Error {
  ErrorCode code;
  std::string message;
  std::string where;
};

/// Thrown where the value of a refusal is read. `what()` names the code, the place and the message.
class RefusedValue : public std::logic_error {
 public:
  explicit RefusedValue(const Error& refusal);
  [[noreturn]] static void raise(const Error& refusal);
  [[nodiscard]] const Error& error() const { return error_; }

 private:
  Error error_;
};

template <class T>
class [[nodiscard]] Expected {
 public:
  Expected(T value) : state_(std::move(value)) {}      // NOLINT(google-explicit-constructor): mirrors std::expected
  Expected(Error error) : state_(std::move(error)) {}  // NOLINT(google-explicit-constructor)

  [[nodiscard]] bool has_value() const { return state_.index() == 0; }
  explicit operator bool() const { return has_value(); }

  /// Throws RefusedValue without a value; so do `*` and `->`.
  [[nodiscard]] const T& value() const& {
    if (!has_value()) RefusedValue::raise(error());
    return *std::get_if<0>(&state_);
  }
  [[nodiscard]] T&& value() && {
    if (!has_value()) RefusedValue::raise(error());
    return std::move(*std::get_if<0>(&state_));
  }
  const T& operator*() const& { return value(); }
  T&& operator*() && { return std::move(*this).value(); }
  const T* operator->() const { return &value(); }

  [[nodiscard]] const Error& error() const {
    assert(!has_value());
    return *std::get_if<1>(&state_);
  }

 private:
  std::variant<T, Error> state_;
};

}  // namespace pd

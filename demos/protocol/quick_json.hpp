/// @file
/// JSON text to events, the way most lines are written: the events that nlohmann::json's parser makes of the same text,
/// at a fifth of its instructions. Text that needs care (escapes, letters beyond ASCII, numbers past 64 bits or the
/// range of doubles, anything that is no JSON) is declined, for that parser to read from its first byte.
#pragma once

#include <charconv>
#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>
#include <system_error>
#include <type_traits>

namespace pd::query {

enum class QuickJson : std::uint8_t {
  done,
  stopped,   ///< by the handler, which returned false
  declined,  ///< the handler has got some events of a text that another parser must read
};

/// @tparam Handler  has the functions of nlohmann::json_sax; nesting is as deep as it allows
template <class Handler>
class QuickJsonReader {
 public:
  QuickJsonReader(std::string_view text, Handler& handler)
      : at_(text.data()), end_(text.data() + text.size()), handler_(handler) {}

  QuickJson read() {
    skip_blanks();
    if (!value()) return outcome_;
    skip_blanks();
    return at_ == end_ ? QuickJson::done : QuickJson::declined;
  }

 private:
  bool declined() {
    outcome_ = QuickJson::declined;
    return false;
  }
  bool told(bool goes_on) {
    if (!goes_on) outcome_ = QuickJson::stopped;
    return goes_on;
  }
  void skip_blanks() {
    while (at_ != end_ && (*at_ == ' ' || *at_ == '\t' || *at_ == '\r' || *at_ == '\n')) ++at_;
  }
  [[nodiscard]] bool next_is(char c) const { return at_ != end_ && *at_ == c; }
  [[nodiscard]] bool next_is_digit() const { return at_ != end_ && *at_ >= '0' && *at_ <= '9'; }

  bool value() {
    if (at_ == end_) return declined();
    switch (*at_) {
      case '{':
        return object();
      case '[':
        return array();
      case '"':
        return text() && told(handler_.string(text_));
      case 't':
        return word("true") && told(handler_.boolean(true));
      case 'f':
        return word("false") && told(handler_.boolean(false));
      case 'n':
        return word("null") && told(handler_.null());
      default:
        return number();
    }
  }

  bool word(std::string_view letters) {
    if (!std::string_view(at_, static_cast<std::size_t>(end_ - at_)).starts_with(letters)) return declined();
    at_ += letters.size();
    return true;
  }

  /// A string without escapes, of printable ASCII, into `text_`.
  bool text() {
    const char* const first = ++at_;
    while (at_ != end_ && *at_ != '"' && *at_ != '\\' && *at_ >= 0x20 && *at_ < 0x7F) ++at_;
    if (!next_is('"')) return declined();
    text_.assign(first, at_);
    ++at_;
    return true;
  }

  bool digits() {
    if (!next_is_digit()) return declined();
    while (next_is_digit()) ++at_;
    return true;
  }
  bool number() {
    const char* const first = at_;
    if (next_is('-')) ++at_;
    if (next_is('0')) {
      ++at_;
    } else if (!digits()) {
      return false;
    }
    const char* const whole = at_;
    if (next_is('.')) {
      ++at_;
      if (!digits()) return false;
    }
    if (next_is('e') || next_is('E')) {
      ++at_;
      if (next_is('+') || next_is('-')) ++at_;
      if (!digits()) return false;
    }
    if (at_ != whole) return real(first);
    return *first == '-' ? integer<std::int64_t>(first) : integer<std::uint64_t>(first);
  }
  template <class Integer>
  bool integer(const char* first) {
    Integer value = 0;
    if (std::from_chars(first, at_, value).ec != std::errc()) return declined();
    if constexpr (std::is_signed_v<Integer>) return told(handler_.number_integer(value));
    if constexpr (!std::is_signed_v<Integer>) return told(handler_.number_unsigned(value));
  }
  bool real(const char* first) {
    double value = 0;
    if (std::from_chars(first, at_, value).ec != std::errc() || !std::isfinite(value)) return declined();
    text_.assign(first, at_);
    return told(handler_.number_float(value, text_));
  }

  bool array() {
    ++at_;
    if (!told(handler_.start_array(static_cast<std::size_t>(-1)))) return false;
    skip_blanks();
    if (!next_is(']')) {
      for (;; ++at_) {
        skip_blanks();
        if (!value()) return false;
        skip_blanks();
        if (!next_is(',')) break;
      }
    }
    return closed(']') && told(handler_.end_array());
  }
  bool object() {
    ++at_;
    if (!told(handler_.start_object(static_cast<std::size_t>(-1)))) return false;
    skip_blanks();
    if (!next_is('}')) {
      for (;; ++at_) {
        skip_blanks();
        if (!next_is('"')) return declined();
        if (!text() || !told(handler_.key(text_))) return false;
        skip_blanks();
        if (!closed(':')) return false;
        skip_blanks();
        if (!value()) return false;
        skip_blanks();
        if (!next_is(',')) break;
      }
    }
    return closed('}') && told(handler_.end_object());
  }
  bool closed(char c) {
    if (!next_is(c)) return declined();
    ++at_;
    return true;
  }

  const char* at_;
  const char* const end_;
  Handler& handler_;
  std::string text_;
  QuickJson outcome_ = QuickJson::done;
};

template <class Handler>
QuickJson read_json_quickly(std::string_view text, Handler& handler) {
  return QuickJsonReader<Handler>(text, handler).read();
}

}  // namespace pd::query

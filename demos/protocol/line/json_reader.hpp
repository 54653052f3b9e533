/// @file
/// JSON text (RFC 8259, UTF-8) to events, in one pass that holds no more than one string at a time.
///
/// A number is the double nearest to its digits; an integer within 64 bits stays an integer. A number past the range of
/// doubles is an error where the handler does not take it, and one too small for it is zero.
#pragma once

#include <charconv>
#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>
#include <system_error>

#include "files/decimal_number.hpp"

namespace pd::query {

enum class JsonEnd : std::uint8_t {
  done,
  stopped,  ///< by the handler, which returned false
  broken,   ///< the text is no JSON: `error` and `error_position` say why
};

/// @tparam Handler  has null, boolean(bool), number_integer(int64), number_unsigned(uint64), number_float(double),
/// string(std::string&), start_object, key(std::string&), member(std::string_view), end_object, start_array and
/// end_array. Each returns false to stop the reading. takes_any_number() says whether a number past the range of
/// doubles is no error now: it comes as an infinity. `member` gets the text of a member's value as it stands, once that
/// text is known to be whole; `string` and `key` may move their argument away. Nesting is as deep as the handler
/// allows.
template <class Handler>
class JsonReader {
 public:
  JsonReader(std::string_view text, Handler& handler)
      : begin_(text.data()), at_(begin_), end_(begin_ + text.size()), handler_(handler) {}

  JsonEnd read() {
    skip_blanks();
    if (!value()) return outcome_;
    skip_blanks();
    if (at_ != end_) (void)broken("the text goes on behind its value");
    return outcome_;
  }

  /// Requires that the text is broken.
  [[nodiscard]] std::string_view error() const { return error_; }
  /// Number of the byte that cannot stand where it stands, counted from 1; the byte behind the last where text is
  /// missing.
  [[nodiscard]] std::size_t error_position() const { return static_cast<std::size_t>(at_ - begin_) + 1; }

 private:
  bool broken(const char* why) {
    outcome_ = JsonEnd::broken;
    error_ = why;
    return false;
  }
  bool told(bool goes_on) {
    if (!goes_on) outcome_ = JsonEnd::stopped;
    return goes_on;
  }
  void skip_blanks() {
    while (at_ != end_ && (*at_ == ' ' || *at_ == '\t' || *at_ == '\r' || *at_ == '\n')) ++at_;
  }
  [[nodiscard]] bool next_is(char c) const { return at_ != end_ && *at_ == c; }
  [[nodiscard]] bool next_is_digit() const { return at_ != end_ && *at_ >= '0' && *at_ <= '9'; }

  bool value() {
    if (at_ == end_) return broken("a value is missing");
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
    if (!std::string_view(at_, static_cast<std::size_t>(end_ - at_)).starts_with(letters)) {
      return broken("the words of JSON are true, false and null");
    }
    at_ += letters.size();
    return true;
  }

  // ---- strings ---------------------------------------------------------------------------------------------------

  /// ASCII without its control characters below the space.
  static bool is_plain(char c) { return static_cast<unsigned char>(c) >= 0x20 && static_cast<unsigned char>(c) < 0x80; }

  /// A string into `text_`, its escapes resolved.
  bool text() {
    text_.clear();
    ++at_;
    for (;;) {
      const char* const first = at_;
      while (at_ != end_ && *at_ != '"' && *at_ != '\\' && is_plain(*at_)) ++at_;
      text_.append(first, at_);
      if (at_ == end_) return broken("a string has no end");
      if (*at_ == '"') break;
      if (!(*at_ == '\\' ? escape() : letter_beyond_ascii())) return false;
    }
    ++at_;
    return true;
  }

  bool escape() {
    if (end_ - at_ < 2) return broken("a string has no end");
    const char kind = at_[1];
    if (kind == 'u') return unicode_escape();
    constexpr std::string_view kKinds = "\"\\/bfnrt", kMeanings = "\"\\/\b\f\n\r\t";
    const std::size_t place = kKinds.find(kind);
    if (place == std::string_view::npos) return broken("a backslash stands before one of \"\\/bfnrtu");
    text_ += kMeanings[place];
    at_ += 2;
    return true;
  }

  /// The four digits of \uXXXX at `at_`, or -1.
  [[nodiscard]] std::int32_t code_unit() const {
    if (end_ - at_ < 6 || at_[0] != '\\' || at_[1] != 'u') return -1;
    std::int32_t unit = 0;
    for (const char* digit = at_ + 2; digit != at_ + 6; ++digit) {
      const char low = static_cast<char>(*digit | 0x20);
      const bool decimal = *digit >= '0' && *digit <= '9';
      if (!decimal && !(low >= 'a' && low <= 'f')) return -1;
      unit = 16 * unit + (decimal ? *digit - '0' : low - 'a' + 10);
    }
    return unit;
  }
  bool unicode_escape() {
    std::int32_t code = code_unit();
    if (code < 0) return broken("\\u stands before four hexadecimal digits");
    if (code >= 0xDC00 && code <= 0xDFFF) return broken("a low surrogate stands alone");
    if (code >= 0xD800 && code <= 0xDBFF) {
      at_ += 6;
      const std::int32_t low = code_unit();
      if (low < 0xDC00 || low > 0xDFFF) return broken("a high surrogate needs a low one behind it");
      code = 0x10000 + ((code - 0xD800) << 10) + (low - 0xDC00);
    }
    at_ += 6;
    append_utf8(code);
    return true;
  }
  void append_utf8(std::int32_t code) {
    const auto byte = [&](std::int32_t bits) { text_ += static_cast<char>(bits); };
    const auto rest = [&](int shift) { byte(0x80 | ((code >> shift) & 0x3F)); };
    if (code < 0x80) {
      byte(code);
    } else if (code < 0x800) {
      byte(0xC0 | (code >> 6));
      rest(0);
    } else if (code < 0x10000) {
      byte(0xE0 | (code >> 12));
      rest(6);
      rest(0);
    } else {
      byte(0xF0 | (code >> 18));
      rest(12);
      rest(6);
      rest(0);
    }
  }

  /// A well-formed sequence of UTF-8 (Unicode, table 3-7), copied.
  bool letter_beyond_ascii() {
    const auto byte_at = [&](int k) { return k < end_ - at_ ? static_cast<unsigned char>(at_[k]) : 0u; };
    const unsigned lead = byte_at(0);
    if (lead < 0x20) return broken("a control character in a string is written as an escape");
    const int length = lead >= 0xC2 && lead <= 0xDF ? 2 : lead >= 0xE0 && lead <= 0xEF ? 3 : lead <= 0xF4 ? 4 : 0;
    const unsigned least = lead == 0xE0 ? 0xA0 : lead == 0xF0 ? 0x90 : 0x80;
    const unsigned most = lead == 0xED ? 0x9F : lead == 0xF4 ? 0x8F : 0xBF;
    bool whole = lead >= 0xC2 && length > 0 && byte_at(1) >= least && byte_at(1) <= most;
    for (int k = 2; k < length; ++k) whole = whole && (byte_at(k) & 0xC0) == 0x80;
    if (!whole) return broken("these bytes are no UTF-8");
    text_.append(at_, at_ + length);
    at_ += length;
    return true;
  }

  // ---- numbers ---------------------------------------------------------------------------------------------------

  bool digits() {
    if (!next_is_digit()) return broken("a digit is missing");
    while (next_is_digit()) ++at_;
    return true;
  }
  bool number() {
    const char* const first = at_;
    if (next_is('-')) ++at_;
    if (next_is('N') || next_is('I')) return broken("NaN and Infinity are no numbers of JSON");
    if (!next_is_digit()) return broken(at_ == first ? "a value is missing" : "a digit is missing");
    if (next_is('0')) {
      ++at_;
    } else {
      (void)digits();
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
    if (*first == '-') {
      std::int64_t value = 0;
      return fits(first, value) ? told(handler_.number_integer(value)) : real(first);
    }
    std::uint64_t value = 0;
    return fits(first, value) ? told(handler_.number_unsigned(value)) : real(first);
  }
  template <class Number>
  bool fits(const char* first, Number& value) const {
    return std::from_chars(first, at_, value).ec == std::errc();
  }
  bool real(const char* first) {
    double value = 0;
    (void)read_decimal(first, at_, value);
    if (!std::isfinite(value) && !handler_.takes_any_number()) {
      at_ = first;
      return broken("a number is past the range of doubles");
    }
    return told(handler_.number_float(value));
  }

  // ---- containers ------------------------------------------------------------------------------------------------

  bool array() {
    ++at_;
    if (!told(handler_.start_array())) return false;
    skip_blanks();
    if (!next_is(']')) {
      for (;; ++at_) {
        skip_blanks();
        if (!value()) return false;
        skip_blanks();
        if (!next_is(',')) break;
      }
    }
    if (!next_is(']')) return broken("an array goes on with a comma or ends with ]");
    ++at_;
    return told(handler_.end_array());
  }
  bool object() {
    ++at_;
    if (!told(handler_.start_object())) return false;
    skip_blanks();
    std::string_view member;
    if (!next_is('}')) {
      for (bool first = true;; first = false, ++at_) {
        skip_blanks();
        if (!next_is('"')) return broken("a key is a string in double quotes");
        if (!first && !told(handler_.member(member))) return false;
        if (!text() || !told(handler_.key(text_))) return false;
        skip_blanks();
        if (!next_is(':')) return broken("a colon is missing behind a key");
        ++at_;
        skip_blanks();
        const char* const start = at_;
        if (!value()) return false;
        member = {start, static_cast<std::size_t>(at_ - start)};
        skip_blanks();
        if (!next_is(',')) break;
      }
      if (!next_is('}')) return broken("an object goes on with a comma or ends with }");
      if (!told(handler_.member(member))) return false;
    }
    ++at_;
    return told(handler_.end_object());
  }

  const char* const begin_;
  const char* at_;
  const char* const end_;
  Handler& handler_;
  std::string text_;
  JsonEnd outcome_ = JsonEnd::done;
  std::string_view error_;
};

}  // namespace pd::query

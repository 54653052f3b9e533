/// @file
/// Text from files and their names, made safe to show: no control character of it reaches a terminal or a line of a
/// file.
#pragma once

#include <string>
#include <string_view>

namespace pd {

/// The text with control characters, those of Latin-1 and of UTF-8 beyond ASCII too, as \xNN; so are the characters
/// that end a line in Unicode or turn the order in which letters are shown.
/// @param kept  control characters that stay, e.g. "\n" where lines are meant
[[nodiscard]] inline std::string printable(std::string_view text, std::string_view kept = "") {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    const bool control = byte < 0x20 || byte == 0x7F;
    // U+0080 to U+009F, which terminals obey, and bytes that begin no letter of UTF-8.
    const bool lead = byte >= 0xC2 && byte <= 0xF4;
    const std::size_t rest = !lead ? 0 : byte < 0xE0 ? 1 : byte < 0xF0 ? 2 : 3;
    bool letter = lead && i + rest < text.size();
    for (std::size_t k = 1; letter && k <= rest; ++k) letter = (static_cast<unsigned char>(text[i + k]) & 0xC0) == 0x80;
    if (letter && byte == 0xC2) letter = static_cast<unsigned char>(text[i + 1]) >= 0xA0;
    if (letter && byte == 0xE2) {
      const std::string_view tail = text.substr(i + 1, 2);
      // U+2028 to U+202E, U+2066 to U+2069.
      letter = !(tail >= "\x80\xA8" && tail <= "\x80\xAE") && !(tail >= "\x81\xA6" && tail <= "\x81\xA9");
    }
    if (letter) {
      out += text.substr(i, rest + 1);
      i += rest;
    } else if ((control && kept.find(text[i]) == std::string_view::npos) || byte >= 0x80) {
      constexpr const char* kDigits = "0123456789abcdef";
      out += {'\\', 'x', kDigits[byte / 16], kDigits[byte % 16]};
    } else {
      out += text[i];
    }
  }
  return out;
}

}  // namespace pd

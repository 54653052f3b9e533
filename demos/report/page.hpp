/// @file
/// A report as one page: report.html, which fetches nothing but the pictures beside it. Style, scripts and data are
/// inline, since a page that was opened from a file may not fetch any.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace pd::report {

/// The version of this program and the commit that it was built from: "0.1.0, commit 0123456789ab".
[[nodiscard]] std::string program_version();

/// A headline figure.
struct Card {
  enum class Rank { plain, good, bad };
  std::string value;
  std::string meaning;
  Rank rank = Rank::plain;
};

struct Page {
  std::string title;
  std::string text;         ///< a sentence below it
  std::vector<Card> cards;  ///< headline figures come first
  /// XHTML that follows, section by section (`scene_section`, `pair_figure`, tables).
  std::vector<std::string> sections;
  std::vector<std::string> commands;  ///< that make the page again
  std::string seed;                   ///< empty: nothing is drawn at random
};

/// Well-formed XHTML in UTF-8, which browsers read as HTML. Light and dark, from 320 px on. The commit, the compiler
/// and the machine are named at its end. three.js is there only where a section turns a pair.
[[nodiscard]] std::string to_html(const Page& page);

/// A table that scrolls within the page. @param rows  of escaped cells; the first is the head
/// @param sortable  by the reader (page/table.js)
[[nodiscard]] std::string table(const std::vector<std::vector<std::string>>& rows, bool sortable = false);

/// A still picture of a file beside the page. @param alt  for screen readers, and its caption
[[nodiscard]] std::string picture(std::string_view file, std::string_view alt);

/// Several pairs' figures side by side.
[[nodiscard]] std::string pairs(const std::vector<std::string>& figures);

/// Why DIR/report.html shall not be replaced: it is a link, or a page that `write_page` did not write. Empty where it
/// may be, and for an empty name.
[[nodiscard]] std::string foreign_page(const std::string& folder);

/// Writes DIR/report.html, in place of what stands there; makes the folder.
/// @return false where it cannot be written; then nothing has changed.
[[nodiscard]] bool write_page(const std::string& folder, const Page& page);

}  // namespace pd::report

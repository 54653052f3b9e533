/// @file
/// A table of a page out of the comma-separated values that a program writes: units by the columns' names, sorted and
/// filtered by the reader (page/table.js), and a link to the values as they are.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace pd::report {

struct CsvTable {
  std::string name;  ///< of the file beside the page, without ".csv", and of links: letters, digits, dashes
  std::string title;
  std::string text;                     ///< a sentence; may be empty
  std::string csv;                      ///< a line of columns, then rows (RFC 4180, lines end with a newline alone)
  std::vector<std::string> shown = {};  ///< columns in their order; empty: all. The file holds all.
};

/// Fields of one line; quotes around a field and doubled ones within it are taken off.
[[nodiscard]] std::vector<std::string> csv_fields(std::string_view line);

/// The `section` element: well-formed XHTML. Columns that end in _ns, _us, _ms or _s are times, and numbers have three
/// digits; the whole number is in the cell's title. A count of wrong or lost ones above 0 and words such as "FAILS"
/// stand out. Requires a line of columns and rows that have as many fields.
[[nodiscard]] std::string csv_section(const CsvTable& table);

/// Writes the tables beside a page, as FOLDER/name.csv. False where one cannot be written.
[[nodiscard]] bool write_tables(const std::string& folder, const std::vector<CsvTable>& tables);

}  // namespace pd::report

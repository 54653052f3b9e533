#include "report/csv_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <sstream>

#include "pd/numeric/whole_file.hpp"
#include "report/html_text.hpp"

namespace pd::report {

namespace {

struct Unit {
  std::string_view suffix;
  double seconds;
};
constexpr std::array kTimes{Unit{"_ns", 1e-9}, Unit{"_us", 1e-6}, Unit{"_ms", 1e-3}, Unit{"_s", 1}};

struct Column {
  std::size_t field;  ///< its place in a row
  std::string name;
  std::string title;
  double seconds = 0;  ///< of one unit; 0: no time
  bool counts_faults = false;
  bool words = false;  ///< set to the left, as words are
};

Column column_of(const std::string& name, std::size_t field) {
  Column column{field, name, name};
  for (const Unit& unit : kTimes) {
    if (!name.ends_with(unit.suffix)) continue;
    column.seconds = unit.seconds;
    column.title.resize(name.size() - unit.suffix.size());
    break;
  }
  std::replace(column.title.begin(), column.title.end(), '_', ' ');
  column.counts_faults = name == "wrong" || name == "lost";
  return column;
}

std::optional<double> number_of(const std::string& text) {
  if (text.empty()) return std::nullopt;
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  if (*end != '\0' || !std::isfinite(value)) return std::nullopt;
  // Digits that no double holds are a name, such as a hash.
  if (std::abs(value) >= 0x1p53 && text.find_first_not_of("0123456789") == std::string::npos) return std::nullopt;
  return value;
}

std::string_view rank_of(const Column& column, const std::string& text, const std::optional<double>& number) {
  if (column.counts_faults && number && *number > 0) return "bad";
  if (text == "FAILS" || text == "MISSED" || text == "SLOWER" || text == "differs") return "bad";
  return text == "holds" || text == "faster" || text == "equal" ? "good" : "";
}

/// The attribute of a cell; empty where it needs none.
std::string class_of(const Column& column, std::string_view rank) {
  if (!column.words && rank.empty()) return {};
  return fmt::format(" class=\"{}{}{}\"", column.words ? "word" : "", column.words && !rank.empty() ? " " : "", rank);
}

std::string cell(const Column& column, const std::string& text) {
  const auto number = number_of(text);
  const std::string kind = class_of(column, rank_of(column, text, number));
  if (!number) return fmt::format("<td{}>{}</td>", kind, text.empty() ? "-" : escaped(text));
  const bool whole = std::floor(*number) == *number && std::abs(*number) < 1e9;
  const std::string shown = column.seconds > 0 ? quantity(*number * column.seconds, "s")
                            : whole            ? fmt::format("{:.0f}", *number)
                                               : short_number(*number);
  return fmt::format("<td{} data-value=\"{}\" title=\"{}\">{}</td>", kind, escaped(text), escaped(text),
                     escaped(shown));
}

std::vector<Column> columns_of(const CsvTable& table, const std::vector<std::string>& names) {
  std::vector<Column> columns;
  if (table.shown.empty()) {
    for (std::size_t i = 0; i < names.size(); ++i) columns.push_back(column_of(names[i], i));
  }
  for (const std::string& name : table.shown) {
    const auto found = std::find(names.begin(), names.end(), name);
    if (found != names.end()) columns.push_back(column_of(name, static_cast<std::size_t>(found - names.begin())));
  }
  return columns;
}

}  // namespace

std::vector<std::string> csv_fields(std::string_view line) {
  std::vector<std::string> fields(1);
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (c == '"' && quoted && i + 1 < line.size() && line[i + 1] == '"') {
      fields.back() += c;
      ++i;
    } else if (c == '"') {
      quoted = !quoted;
    } else if (c == ',' && !quoted) {
      fields.emplace_back();
    } else {
      fields.back() += c;
    }
  }
  return fields;
}

std::string csv_section(const CsvTable& table) {
  std::istringstream lines(table.csv);
  std::string line;
  std::getline(lines, line);
  std::vector<Column> columns = columns_of(table, csv_fields(line));
  std::vector<std::vector<std::string>> rows;
  while (std::getline(lines, line)) rows.push_back(csv_fields(line));
  for (Column& column : columns) {
    column.words = std::any_of(rows.begin(), rows.end(), [&](const std::vector<std::string>& row) {
      const std::string& text = row.at(column.field);
      return !text.empty() && !number_of(text);
    });
  }
  std::string text = fmt::format("<section id=\"{}\"><h2>{}</h2>\n", escaped(table.name), escaped(table.title));
  if (!table.text.empty()) text += fmt::format("<p class=\"quiet\">{}</p>\n", escaped(table.text));
  text += "<div class=\"scroll\" tabindex=\"0\"><table class=\"sortable\"><thead><tr>";
  for (const Column& column : columns) {
    text += fmt::format("<th{}>{}</th>", class_of(column, ""), escaped(column.title));
  }
  text += "</tr></thead>\n<tbody>\n";
  for (const auto& row : rows) {
    text += "<tr>";
    for (const Column& column : columns) text += cell(column, row.at(column.field));
    text += "</tr>\n";
  }
  return text +
         fmt::format("</tbody></table></div>\n<p><a href=\"{0}.csv\">{0}.csv</a> holds the numbers.</p></section>\n",
                     escaped(table.name));
}

bool write_tables(const std::string& folder, const std::vector<CsvTable>& tables) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  bool good = true;
  for (const CsvTable& table : tables) {
    good = write_whole_file(std::filesystem::path(folder) / (table.name + ".csv"), table.csv) && good;
  }
  return good;
}

}  // namespace pd::report

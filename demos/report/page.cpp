#include "report/page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <thread>

#include "pd/numeric/whole_file.hpp"
#include "report/html_text.hpp"
#include "report/page_files.hpp"
#include "report_commit.hpp"

namespace pd::report {

namespace {

std::string card(const Card& card) {
  constexpr std::array kRanks{"", "good", "bad"};
  return fmt::format("<li class=\"{}\"><b>{}</b>{}</li>\n", kRanks[static_cast<std::size_t>(card.rank)],
                     escaped(card.value), escaped(card.meaning));
}

/// "AMD EPYC ..., 2 threads".
std::string machine() {
  std::ifstream info("/proc/cpuinfo");
  std::string name = "unknown processor";
  for (std::string line; std::getline(info, line);) {
    if (line.starts_with("model name")) {
      name = line.substr(std::min(line.find(": ") + 2, line.size()));
      break;
    }
  }
  return fmt::format("{}, {} threads", name, std::thread::hardware_concurrency());
}

std::string how_to_reproduce(const Page& page) {
  std::string text = "<section id=\"reproduce\"><h2>How to reproduce</h2>\n<pre>";
  for (const std::string& command : page.commands) text += escaped(command) + "\n";
  text += "</pre>\n";
  std::vector<std::vector<std::string>> rows{{"what", "which"},
                                             {"pdepth", escaped(program_version())},
                                             {"compiler", escaped(__VERSION__)},
                                             {"machine", escaped(machine())}};
  if (!page.seed.empty()) rows.push_back({"seed", escaped(page.seed)});
  return text + table(rows) + "</section>\n";
}

/// How a page of this program is known again.
constexpr std::string_view kGenerator = "<meta name=\"generator\" content=\"pdepth\"/>";
constexpr const char* kPageName = "report.html";

std::string script(std::string_view text) { return fmt::format("<script>//<![CDATA[\n{}\n//]]></script>\n", text); }

}  // namespace

std::string program_version() { return fmt::format("{}, commit {}", kVersion, kCommit); }

std::string table(const std::vector<std::vector<std::string>>& rows, bool sortable) {
  std::string text =
      fmt::format("<div class=\"scroll\" tabindex=\"0\"><table{}>\n", sortable ? " class=\"sortable\"" : "");
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const char* cell = r == 0 ? "th" : "td";
    text += r == 0 ? "<thead><tr>" : "<tr>";
    for (const std::string& value : rows[r]) text += fmt::format("<{0}>{1}</{0}>", cell, value);
    text += r == 0 ? "</tr></thead>\n<tbody>\n" : "</tr>\n";
  }
  return text + "</tbody></table></div>\n";
}

std::string picture(std::string_view file, std::string_view alt) {
  return fmt::format(
      "<figure class=\"picture\"><img src=\"{}\" alt=\"{}\" loading=\"lazy\"/><figcaption "
      "class=\"quiet\">{}</figcaption></figure>\n",
      escaped(file), escaped(alt), escaped(alt));
}

std::string pairs(const std::vector<std::string>& figures) {
  std::string text = "<div class=\"pairs\">\n";
  for (const std::string& figure : figures) text += figure;
  return text + "</div>\n";
}

std::string to_html(const Page& page) {
  std::string text =
      "<!DOCTYPE html>\n<html xmlns=\"http://www.w3.org/1999/xhtml\" lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n";
  text += fmt::format("{}\n", kGenerator);
  text += fmt::format("<title>{}</title>\n<style>{}</style>\n</head>\n<body>\n<main>\n<h1>{}</h1>\n",
                      escaped(page.title), kPageCss, escaped(page.title));
  if (!page.text.empty()) text += fmt::format("<p class=\"quiet\">{}</p>\n", escaped(page.text));
  if (!page.cards.empty()) {
    text += "<ul class=\"cards\">\n";
    for (const Card& each : page.cards) text += card(each);
    text += "</ul>\n";
  }
  bool turns = false;
  bool moves = false;
  bool sorts = false;
  for (const std::string& section : page.sections) {
    turns = turns || section.find("<figure class=\"pair\"") != std::string::npos;
    moves = moves || section.find("<section class=\"scene\"") != std::string::npos;
    sorts = sorts || section.find("<table class=\"sortable\"") != std::string::npos;
    text += section;
  }
  text += how_to_reproduce(page) + "</main>\n";
  if (moves) text += script(kPageJs);
  if (sorts) text += script(kTableJs);
  if (turns) text += script(fmt::format("/* three.js\n\n{}*/\n{}", kThreeLicense, kThreeJs)) + script(kPairJs);
  return text + "</body>\n</html>\n";
}

std::string foreign_page(const std::string& folder) {
  const std::filesystem::path path = std::filesystem::path(folder) / kPageName;
  std::error_code error;
  const auto status = std::filesystem::symlink_status(path, error);
  if (folder.empty() || !std::filesystem::exists(status)) return {};
  if (std::filesystem::is_symlink(status)) return path.string() + " is a link: replace it with --force";
  std::string head(4096, '\0');
  std::ifstream file(path, std::ios::binary);
  file.read(head.data(), static_cast<std::streamsize>(head.size()));
  if (std::filesystem::is_regular_file(status) && head.find(kGenerator) != std::string::npos) return {};
  return path.string() + " was not written by pdepth: name another folder, or replace it with --force";
}

bool write_page(const std::string& folder, const Page& page) {
  const std::filesystem::path path = std::filesystem::path(folder) / kPageName;
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) {
    errno = error.value();
    return false;
  }
  if (std::filesystem::is_symlink(path, error)) std::filesystem::remove(path, error);
  return write_whole_file(path, to_html(page));
}

}  // namespace pd::report

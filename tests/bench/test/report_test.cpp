/// @file
/// Tables of pages out of comma-separated values, and the command that a page names.
#include <gtest/gtest.h>

#include "bench/report/bench_report.hpp"
#include "report/charts.hpp"

namespace pd::bench {
namespace {

std::size_t count(const std::string& text, const std::string& piece) {
  std::size_t found = 0;
  for (std::size_t at = text.find(piece); at != std::string::npos; at = text.find(piece, at + 1)) ++found;
  return found;
}

TEST(CsvTable, QuotesAndUnits) {
  EXPECT_EQ(report::csv_fields("a,\"b,c\",\"d \"\"e\"\"\",,f"),
            (std::vector<std::string>{"a", "b,c", "d \"e\"", "", "f"}));
  const std::string section =
      report::csv_section({"t", "Title", "", "name,p50_ns,wrong,verdict\n\"<a, b>\",1234.5,0,holds\nc,,2,FAILS\n"});
  EXPECT_NE(section.find("<td class=\"word\">&lt;a, b&gt;</td><td data-value=\"1234.5\" title=\"1234.5\">1.23 \u00b5s"),
            std::string::npos)
      << section;
  EXPECT_NE(section.find("<th>p50</th>"), std::string::npos);
  EXPECT_NE(section.find("<td>-</td><td class=\"bad\" data-value=\"2\""), std::string::npos);
  EXPECT_NE(section.find("<td class=\"word bad\">FAILS</td>"), std::string::npos);
  EXPECT_NE(section.find("href=\"t.csv\""), std::string::npos);
}

TEST(CsvTable, AHashIsAName) {
  const std::string section = report::csv_section({"t", "T", "", "kind,hash\na,6022140760000000000\nb,12\n"});
  EXPECT_NE(section.find(">6022140760000000000</td>"), std::string::npos) << section;
}

TEST(CsvTable, ChosenColumns) {
  const std::string section = report::csv_section({"t", "T", "", "a,b,c\n1,2,3\n", {"c", "a", "none"}});
  EXPECT_LT(section.find("<th>c</th>"), section.find("<th>a</th>"));
  EXPECT_EQ(count(section, "<td"), 2U);
}

TEST(LinePlot, LeavesOutWhatHasNoLogarithm) {
  const std::string plot =
      report::line_plot({"T", "n", "s", {{"a", {1, 10, 100}, {1e-6, 0, 1e-4}}, {"b", {1}, {1e-5}}}});
  EXPECT_EQ(count(plot, "<circle"), 3U);
  EXPECT_EQ(count(plot, "<li>"), 2U);
  EXPECT_TRUE(report::line_plot({"T", "n", "s", {{"a", {1}, {1}}}}).empty());
  EXPECT_TRUE(report::line_plot({"T", "n", "", {{"a", {0, 1}, {1, -1}}}}).empty());
}

TEST(BarChart, LengthsByValueOrByItsLogarithm) {
  const std::string bars = report::bar_chart({"T", "", {{"a", 1, "one"}, {"b", 4, "four", true}, {"c", 0, "none"}}});
  EXPECT_NE(bars.find("width:25.0%\"></i></span><b>one"), std::string::npos) << bars;
  EXPECT_NE(bars.find("<li class=\"ours\"><span>b</span><span class=\"track\"><i style=\"width:100.0%"),
            std::string::npos);
  EXPECT_NE(bars.find("width:0.0%\"></i></span><b>none"), std::string::npos);
  const std::string powers = report::bar_chart({"T", "", {{"a", 2, ""}, {"b", 2000, ""}}, true});
  EXPECT_NE(powers.find("width:9.1%"), std::string::npos) << powers;
}

TEST(CommandLine, NamesTheSeedOnce) {
  const char* plain[] = {"/path/pdepth-bench", "pairs", "--families", "a b", "--report", "it's"};
  EXPECT_EQ(command_line(6, plain, "7"), "pdepth-bench pairs --families 'a b' --report 'it'\\''s' --seed 7");
  const char* seeded[] = {"x", "pairs", "--seed", "3"};
  EXPECT_EQ(command_line(4, seeded, "3"), "pdepth-bench pairs --seed 3");
  const char* two[] = {"x", "compare", "a", "b", "--", "--quick"};
  EXPECT_EQ(command_line(6, two, "5"), "pdepth-bench compare a b --seed 5 -- --quick");
  EXPECT_EQ(command_line(2, two, ""), "pdepth-bench compare");
}

}  // namespace
}  // namespace pd::bench

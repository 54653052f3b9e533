/// @file
/// The page that describes the way of one query prints the table of stages as the program has it.
#include "depth/pair/stages.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>
#include <string>

namespace pd {
namespace {

std::string row_of(const detail::Stage& stage) {
  std::string brackets;
  const auto add = [&](Bracket bracket, const char* name) {
    if ((stage.brackets & detail::bit_of(bracket)) != 0) brackets += (brackets.empty() ? "" : ", ") + std::string(name);
  };
  add(Bracket::tightest, "tightest");
  add(Bracket::certified, "certified");
  add(Bracket::contact, "contact");
  std::ostringstream row;
  row << "| `" << stage.name << "` | " << name_of(stage.bodies) << " | " << (stage.automatic ? "automatic" : "searches")
      << " | " << brackets << " | " << (stage.warm ? "with" : "with or without") << " | " << name_of(stage.needs)
      << " |\n";
  return row.str();
}

TEST(Stages, ThePagePrintsTheTable) {
  std::ifstream file(PROJECT_SOURCE_DIR "/pd_core/docs/one_query.md");
  std::ostringstream page;
  page << file.rdbuf();
  std::string table = "|---|---|---|---|---|---|\n";
  for (const detail::Stage& stage : detail::stages()) table += row_of(stage);
  EXPECT_NE(page.str().find(table + "\n"), std::string::npos) << table;
}

/// A query that no other stage answers ends at the last one, whatever is asked.
TEST(Stages, AreFewAndTheLastOneIsForAll) {
  EXPECT_LE(detail::stages().size(), 10U);
  const detail::Stage& last = detail::stages().back();
  EXPECT_TRUE(!last.automatic && !last.warm);
  for (const Bracket bracket : {Bracket::certified, Bracket::tightest, Bracket::contact}) {
    EXPECT_NE(last.brackets & detail::bit_of(bracket), 0);
  }
  EXPECT_EQ(last.bodies, detail::Bodies::any);
  EXPECT_EQ(last.needs, detail::Needs::surface);
}

}  // namespace
}  // namespace pd

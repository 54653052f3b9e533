/// @file
/// Every query with every field left out, of another type or of another length: an answer or an error object, never an
/// exception, whichever limits bound the line. What no reader refused and no engine could take would be answered in
/// words of its own ("could not be answered"), and is a fault.
#include <fstream>
#include <set>
#include <string>
#include <vector>

#include "bench/measure/sanitized.hpp"
#include "protocol/handlers.hpp"
#include "protocol/stream/line_budget.hpp"
#include "protocol_lines.hpp"

namespace pd::test {
namespace {

/// A line or more for every query, with all of its fields between them.
std::vector<std::string> whole_lines() {
  std::ifstream file(PROJECT_SOURCE_DIR "/tests/corpus/protocol_lines.jsonl");
  std::vector<std::string> lines;
  for (std::string line; std::getline(file, line);) lines.push_back(line);
  return lines;
}

/// Pointers to everything below the line's object, its id left out.
std::vector<Json::json_pointer> places_of(const Json& line) {
  std::vector<Json::json_pointer> places;
  const auto walk = [&](const auto& self, const Json::json_pointer& here) -> void {
    const Json& value = line.at(here);
    if (!here.empty()) places.push_back(here);
    if (value.is_object()) {
      for (const auto& [name, member] : value.items()) {
        if (!here.empty() || name != "id") self(self, here / name);
      }
    } else if (value.is_array()) {
      for (std::size_t i = 0; i < value.size(); ++i) self(self, here / i);
    }
  };
  walk(walk, Json::json_pointer());
  return places;
}

Json without(Json line, const Json::json_pointer& place) {
  Json& parent = line.at(place.parent_pointer());
  if (parent.is_array()) {
    parent.erase(std::stoul(place.back()));
  } else {
    parent.erase(place.back());
  }
  return line;
}

Json with(Json line, const Json::json_pointer& place, const Json& value) {
  line.at(place) = value;
  return line;
}

std::vector<std::string> spoilt(const Json& line) {
  static const std::vector<Json> kOthers = {nullptr,
                                            true,
                                            -1,
                                            0,
                                            0.5,
                                            1e300,
                                            "inf",
                                            "depth",
                                            "",
                                            Json::array(),
                                            Json::object(),
                                            Json::parse("[[]]"),
                                            Json::parse("[[[1]]]"),
                                            Json::parse(R"([{"type":1}])"),
                                            Json::parse("[1,2]"),
                                            Json::parse(R"({"type":"box","half_extents":[1,1,1]})")};
  std::vector<std::string> lines;
  for (const Json::json_pointer& place : places_of(line)) {
    lines.push_back(without(line, place).dump());
    for (const Json& other : kOthers) lines.push_back(with(line, place, other).dump());
    if (const Json& value = line.at(place); value.is_array()) {
      Json longer = value;
      longer.push_back(value.empty() ? Json(1) : value.back());
      lines.push_back(with(line, place, longer).dump());
    }
  }
  return lines;
}

void expect_an_answer(const std::string& text, const std::string& line) {
  const Json answer = Json::parse(text, nullptr, false);
  ASSERT_TRUE(answer.is_object()) << line << "\n" << text;
  ASSERT_EQ(answer.at("id"), 1) << line << "\n" << text;
  ASSERT_EQ(text.find("could not be answered"), std::string::npos) << line << "\n" << text;
  ASSERT_EQ(text.find("ended before its answer"), std::string::npos) << line << "\n" << text;
}

TEST(SpoiltLines, EveryQueryHasALineHereThatIsAnswered) {
  std::set<std::string> asked;
  for (const std::string& line : whole_lines()) {
    const Json reply = answer(line);
    EXPECT_EQ(code_of(reply), "") << line << "\n" << reply;
    asked.insert(Json::parse(line).at("query"));
  }
  for (const query::QueryEntry& entry : query::queries()) EXPECT_TRUE(asked.contains(std::string(entry.name)));
}

TEST(SpoiltLines, AreAnsweredInFullAndCoarsely) {
  query::Session session;
  session.limits.files = false;
  int lines = 0, refused = 0;
  for (const std::string& whole : whole_lines()) {
    for (const std::string& line : spoilt(Json::parse(whole))) {
      const query::LineAnswer full = query::answer_line(line, session);
      expect_an_answer(full.text, line);
      if (const auto coarse = query::answer_coarsely(line, session)) {
        expect_an_answer(coarse->text, line);
        EXPECT_TRUE(coarse->unreached);
        EXPECT_EQ(Json::parse(coarse->text).at("bracket_reached"), false);
      }
      ++lines;
      refused += full.text.find("\"error\":") != std::string::npos;
      if (HasFatalFailure()) return;
    }
  }
  EXPECT_GT(lines, 5000);
  EXPECT_GT(refused, lines / 2);
}

/// A sample in processes of their own: each line costs one, and a second one where half of its time is over.
TEST(SpoiltLines, AreAnsweredWithinABudget) {
#if defined(PD_SANITIZED)
  const query::LineBudget budget{.milliseconds = 20'000, .megabytes = 0};
#else
  const query::LineBudget budget{.milliseconds = 20'000, .megabytes = 1'000};
#endif
  query::Session session;
  session.limits.files = false;
  for (const std::string& whole : whole_lines()) {
    const Json line = Json::parse(whole);
    std::vector<std::string> lines;
    for (const auto& [name, value] : line.items()) {
      if (name != "id") lines.push_back(without(line, Json::json_pointer("/" + name)).dump());
    }
    for (const std::string& each : lines) {
      expect_an_answer(query::answer_within(each, session, budget).text, each);
      if (HasFatalFailure()) return;
    }
  }
}

}  // namespace
}  // namespace pd::test

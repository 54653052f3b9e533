/// @file
/// tests/corpus/queries.jsonl: lines of the protocol that once went wrong, each with what its answer must be.
///
/// A line of the file is {"name": why it is here, "line": the query, "expect": fields of its answer}. An expected pair
/// [low, high] bounds a number; a text, a truth value or null (the field is absent) must be met exactly; "error" names
/// the code. Every number of every answer must be finite, and the least form of each bracket holds: lower <= depth <=
/// upper.
#include <cmath>
#include <fstream>

#include "protocol_lines.hpp"

namespace pd::test {
namespace {

void expect_finite(const Json& value, const std::string& name) {
  if (value.is_number()) {
    EXPECT_TRUE(std::isfinite(value.get<double>())) << name;
  }
  if (!value.is_structured()) return;
  for (const Json& element : value) expect_finite(element, name);
}

void expect_fields(const Json& expected, const Json& reply, const std::string& name) {
  for (const auto& [key, wanted] : expected.items()) {
    if (key == "error") {
      EXPECT_EQ(code_of(reply), wanted.get<std::string>()) << name << ": " << reply.dump().substr(0, 400);
      continue;
    }
    if (wanted.is_null()) {
      EXPECT_FALSE(reply.contains(key)) << name;
      continue;
    }
    ASSERT_TRUE(reply.contains(key)) << name << ": " << reply.dump().substr(0, 400);
    const Json& got = reply.at(key);
    if (wanted.is_array() && wanted.size() == 2 && got.is_number()) {
      EXPECT_GE(got.get<double>(), wanted[0].get<double>()) << name << ": " << key;
      EXPECT_LE(got.get<double>(), wanted[1].get<double>()) << name << ": " << key;
    } else {
      EXPECT_EQ(got, wanted) << name << ": " << key;
    }
  }
}

TEST(QueryCorpus, EveryLineIsAnsweredAsItMust) {
  std::ifstream file(PROJECT_SOURCE_DIR "/tests/corpus/queries.jsonl");
  ASSERT_TRUE(file.is_open());
  int lines = 0;
  for (std::string text; std::getline(file, text);) {
    if (text.empty()) continue;
    const Json entry = Json::parse(text);
    const std::string name = entry.at("name");
    SCOPED_TRACE(name);
    const Json reply = answer(entry.at("line").dump());
    expect_finite(reply, name);
    if (!entry.at("expect").contains("error")) {
      EXPECT_EQ(code_of(reply), "") << name << ": " << reply.dump().substr(0, 400);
    }
    expect_fields(entry.at("expect"), reply, name);
    if (reply.contains("lower") && reply.contains("depth") && reply.contains("upper")) {
      EXPECT_LE(reply.at("lower").get<double>(), reply.at("depth").get<double>()) << name;
      EXPECT_LE(reply.at("depth").get<double>(), reply.at("upper").get<double>()) << name;
    }
    ++lines;
  }
  EXPECT_GE(lines, 2);
}

}  // namespace
}  // namespace pd::test

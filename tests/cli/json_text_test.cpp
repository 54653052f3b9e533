/// @file
/// Strict reading: everything that is not one JSON object is bad_json, and the id comes back wherever it can be read.
#include "protocol/line/json_text.hpp"

#include <bit>
#include <cmath>
#include <random>

#include "protocol/line/json_writer.hpp"
#include "protocol_lines.hpp"

namespace pd::test {
namespace {

struct BadLine {
  const char* line;
  const char* id;  ///< JSON text
};

TEST(StrictJson, RefusesWhatIsNoJsonObject) {
  const BadLine cases[] = {
      {"{", "null"},
      {"[]", "null"},
      {"7", "null"},
      {"\"depth\"", "null"},
      {"null", "null"},
      {R"({"id":3,"query":"depth","x":NaN})", "3"},
      {R"({"id":3,"x":Infinity})", "3"},
      {R"({"id":3,"x":-Infinity})", "3"},
      {R"({"id":3,"x":nan})", "3"},
      {R"({"id":"k","x":1e999})", "\"k\""},
      {R"({"id":"k","x":-1e309})", "\"k\""},
      {R"({"id":4,"query":"depth","query":"depth"})", "4"},
      {R"({"query":"depth","query":"depth","id":5})", "5"},
      {R"({"id":4,"id":5})", "null"},
      {R"({"id":4,"a":{"type":"box","type":"box"}})", "4"},
      {R"({"id":4,"a":{"x":1,"y":[{"z":1,"z":2}]}})", "4"},
      {R"({"id":[1,{"x":)", "null"},
      {R"({"id":1,})", "null"},
      {R"({"id":1} {"id":2})", "1"},
      {R"({"id":1}x)", "1"},
      {R"({'id':1})", "null"},
      {R"({"id":01})", "null"},
      {R"({"id":12x,"query":"depth"})", "null"},
      {R"({"id":1,"x":.5})", "1"},
      {R"({"id":1,"x":+5})", "1"},
      {R"({"id":1,"x":5.})", "1"},
      {R"({"id":1,"x":0x10})", "1"},
      {R"({"id":1,"x":1e})", "1"},
      {"{\"id\":1,\"x\":\"\t\"}", "1"},
      {R"({"id":1,"x":"\ud800"})", "1"},
      {"{\"id\":1,\"x\":\"\xff\"}", "1"},
      {"{\"id\":1 // a comment\n}", "null"},
      {"\xEF\xBB\xBF{\"id\":1}", "null"},
  };
  for (const BadLine& bad : cases) {
    const Json reply = answer(bad.line);
    EXPECT_EQ(code_of(reply), "bad_json") << bad.line;
    EXPECT_EQ(reply.at("id"), Json::parse(bad.id)) << bad.line;
  }
}

TEST(StrictJson, ZeroByteDoesNotEndALine) {
  const std::string line = std::string(R"({"id":1})") + '\0' + "rubbish";
  EXPECT_EQ(code_of(answer(line)), "bad_json");
}

TEST(StrictJson, NestingIsBounded) {
  const std::string line = R"({"id":1,"x":)" + std::string(1'000'000, '[');
  const Json reply = answer(line);
  EXPECT_EQ(code_of(reply), "limit_exceeded");
  EXPECT_EQ(reply.at("id"), 1);
}

TEST(StrictJson, ManyDistinctKeysAreNoQuadraticTrap) {
  std::string line = R"({"id":1,"query":"depth")";
  for (int i = 0; i < 200'000; ++i) line += ",\"k" + std::to_string(i) + "\":0";
  EXPECT_EQ(code_of(answer(line + "}")), "bad_value");
}

TEST(StrictJson, BlankLines) {
  EXPECT_TRUE(query::is_blank(""));
  EXPECT_TRUE(query::is_blank(" \t\r"));
  EXPECT_FALSE(query::is_blank("x"));
}

TEST(Id, ComesBackAsItCame) {
  for (const char* id : {"null", "true", "0", "-7", "1.5", "1e5", "12345678901234567890123456789", "\"a\\\"b\\u00e9\"",
                         "[1,[2,\"x\"],null]", "{\"k\":[1.25,{}]}", "[]", "0.1"}) {
    const std::string text = answer_text(std::string(R"({"query":"nothing","id":)") + id + "}");
    const Json reply = Json::parse(text);
    EXPECT_EQ(reply.at("id"), Json::parse(id)) << text;
  }
}

TEST(Id, ComesBackByteForByte) {
  for (const char* id :
       {"12345678901234567890123456789", "-0", "1.0", "1", "1.50", "1E5", "0.1000", "[ 1 , 12345678901234567890123 ]",
        R"({"z":1.0,"a":{"n":12345678901234567890123,"m":"\u00e9\/"}})", R"("\u0061")", "\"\xC3\xA9\"",
        R"({"vertices":[[1,2,3.0]],"translation":[1],"bracket_reached":false})"}) {
    for (const std::string& line : {std::string(R"({"query":"nothing","id": )") + id + " }",
                                    std::string(R"({"id":)") + id + R"(,"query":"nothing"})",
                                    std::string(R"({"id":)") + id + R"(,"query":"hull","a":)" + kUnitBox + "}"}) {
      const std::string text = answer_text(line);
      EXPECT_TRUE(text.starts_with(std::string(R"({"id":)") + id + ",")) << line << "\n" << text;
    }
  }
}

TEST(Id, IsNullWhereThereIsNone) { EXPECT_TRUE(answer(R"({"query":"nothing"})").at("id").is_null()); }

TEST(Numbers, ReadBackToTheSameBits) {
  std::mt19937_64 random(20240501);
  std::string text;
  int checked = 0;
  for (int i = 0; i < 200'000; ++i) {
    const double value = std::bit_cast<double>(random());
    if (!std::isfinite(value)) continue;
    text.clear();
    query::append_number(text, value);
    const Json parsed = Json::parse(text);
    ASSERT_TRUE(parsed.is_number_float()) << text;
    ASSERT_EQ(std::bit_cast<std::uint64_t>(parsed.get<double>()), std::bit_cast<std::uint64_t>(value)) << text;
    ++checked;
  }
  EXPECT_GT(checked, 190'000);
}

TEST(Numbers, WhatIsNotFiniteIsNeverWritten) {
  for (const double value : {HUGE_VAL, -HUGE_VAL, std::nan("")}) {
    std::string text;
    EXPECT_THROW(query::JsonWriter(text).number(value), query::Refusal);
  }
}

TEST(Numbers, WholeNumbersStayDoubles) {
  const auto text_of = [](double value) {
    std::string text;
    query::append_number(text, value);
    return text;
  };
  EXPECT_EQ(text_of(1), "1.0");
  EXPECT_EQ(text_of(-0.0), "-0.0");
  EXPECT_EQ(text_of(0.1), "0.1");
  EXPECT_EQ(text_of(1e300), "1e+300");
  EXPECT_EQ(text_of(5e-324), "5e-324");
}

}  // namespace
}  // namespace pd::test

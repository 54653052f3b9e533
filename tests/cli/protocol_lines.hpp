/// @file
/// Lines of the protocol for tests: built from JSON text, answered by the library, read back.
#pragma once

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "protocol/answer_line.hpp"

namespace pd::test {

using Json = nlohmann::json;

inline constexpr const char* kUnitBox = R"({"type":"box","half_extents":[1,1,1]})";

/// The answer to one line, as text.
inline std::string answer_text(std::string_view line, const query::Limits& limits = {}) {
  query::Session session;
  session.limits = limits;
  return query::answer_line(line, session).text;
}

/// The answer to one line. The text is strict JSON, or the test fails here.
inline Json answer(std::string_view line, const query::Limits& limits = {}) {
  const std::string text = answer_text(line, limits);
  Json parsed = Json::parse(text, nullptr, false);
  EXPECT_TRUE(parsed.is_object()) << text;
  return parsed;
}

/// {"id":1,"query":"depth","a":...,"b":...,MORE}
inline std::string depth_line(const std::string& a, const std::string& b, const std::string& more = "") {
  return R"({"id":1,"query":"depth","a":)" + a + R"(,"b":)" + b + (more.empty() ? "" : "," + more) + "}";
}

/// Error code of an answer; empty where it is none.
inline std::string code_of(const Json& answer) {
  const auto error = answer.find("error");
  return error == answer.end() ? "" : error->at("code").get<std::string>();
}
inline std::string where_of(const Json& answer) {
  const auto error = answer.find("error");
  return error == answer.end() ? "" : error->at("where").get<std::string>();
}

}  // namespace pd::test

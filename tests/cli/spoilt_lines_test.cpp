/// @file
/// Every query with every field left out, of another type or of another length: an answer or an error object, never an
/// exception, whichever limits bound the line. What no reader refused and no engine could take would be answered in
/// words of its own ("could not be answered"), and is a fault.
#include <set>

#include "protocol/handlers.hpp"
#include "protocol/line_budget.hpp"
#include "protocol_lines.hpp"

namespace pd::test {
namespace {

constexpr const char* kWholeLines[] = {
    R"({"id":1,"query":"depth","a":{"type":"box","half_extents":[1,1,1]},"b":{"type":"sphere","radius":1},)"
    R"("pose_b":{"translation":[1.5,0,0]},"method":"auto","delta":0.5})",
    R"({"id":1,"query":"depth","a":{"type":"ellipsoid","radii":[1,2,3]},"b":{"type":"capsule","radius":1,)"
    R"("half_height":1,"axis":"x","margin":0.5},"pose_a":{"quaternion_wxyz":[1,0,0,0]},"delta":0.5})",
    R"({"id":1,"query":"depth","a":{"type":"compound","parts":[{"shape":{"type":"box","half_extents":[1,1,1]},)"
    R"("pose":{"translation":[1,0,0]}}]},"b":{"type":"cone","radius":1,"half_height":1,"axis":"y"},"delta":0.5})",
    R"({"id":1,"query":"depth","a":{"type":"star","vertices":[[1,0,0],[0,1,0],[0,0,1],[-1,-1,-1]],)"
    R"("faces":[[0,1,2],[0,2,3],[0,3,1],[1,3,2]],"center":[0,0,0]},"b":{"type":"box","half_extents":[1,1,1]}})",
    R"({"id":1,"query":"depth","a":{"type":"box","half_extents":[1,1,1]},"b":{"type":"box","half_extents":[1,1,1]},)"
    R"("metric":{"vertices":[[1,0,0],[-1,0,0],[0,1,0],[0,-1,0],[0,0,1],[0,0,-1]]},"seed":7})",
    R"({"id":1,"query":"distance","a":{"type":"cylinder","radius":1,"half_height":1,"axis":"z"},)"
    R"("b":{"type":"box","half_extents":[1,1,1]},"pose_b":{"translation":[5,0,0],"rotation_row_major":[1,0,0,0,1,0,0,0,1]}})",
    R"({"id":1,"query":"intersect","a":{"type":"halfspaces","planes":[[1,0,0,1],[-1,0,0,1],[0,1,0,1],[0,-1,0,1],)"
    R"([0,0,1,1],[0,0,-1,1]]},"b":{"type":"box","half_extents":[1,1,1]}})",
    R"({"id":1,"query":"hull","a":{"type":"convex","vertices":[[0,0,0],[1,0,0],[0,1,0],[0,0,1]],)"
    R"("faces":[[0,2,1],[0,1,3],[1,2,3],[0,3,2]]},"pose_a":{"translation":[1,2,3]}})",
    R"({"id":1,"query":"directional_depth","a":{"type":"box","half_extents":[1,1,1]},)"
    R"("b":{"type":"box","half_extents":[1,1,1]},"direction":[1,2,3],"method":"portal"})",
    R"({"id":1,"query":"support_of_difference","a":{"type":"box","half_extents":[1,1,1]},)"
    R"("b":{"type":"sphere","radius":1},"directions":[[1,0,0],[0,1,0]]})",
    R"({"id":1,"query":"point_in_difference","a":{"type":"box","half_extents":[1,1,1]},)"
    R"("b":{"type":"box","half_extents":[1,1,1]},"points":[[1,0,0],[0,9,0]]})",
    R"({"id":1,"query":"width","a":{"type":"box","half_extents":[1,1,1]},"method":"grid","delta":0.5})",
    R"({"id":1,"query":"minkowski_difference","a":{"type":"box","half_extents":[1,1,1]},)"
    R"("b":{"type":"convex","vertices":[[0,0,0],[1,0,0],[0,1,0],[0,0,1]]}})",
    R"({"id":1,"query":"contact_manifold","a":{"type":"box","half_extents":[1,1,1]},)"
    R"("b":{"type":"box","half_extents":[1,1,1]},"pose_b":{"translation":[1.5,0,0]},"breaking_threshold":0.1})",
    R"({"id":1,"query":"time_of_impact","a":{"type":"box","half_extents":[1,1,1]},"b":{"type":"sphere","radius":1},)"
    R"("pose_b":{"translation":[5,0,0]},"velocity_a":[1,0,0],"angular_velocity_a":[0,0,1],"velocity_b":[0,0,0],)"
    R"("angular_velocity_b":[0,0,0],"duration":3,"tolerance":0.001})",
    R"({"id":1,"query":"hierarchy","a":{"type":"box","half_extents":[1,1,1]},"kind":"inner"})",
    R"({"id":1,"query":"decomposition","a":{"type":"box","half_extents":[1,1,1]},)"
    R"("b":{"type":"box","half_extents":[1,1,1]},"verify":true})",
    R"({"id":1,"query":"polygon_depth","p":{"outer":[[0,0],[4,0],[4,4],[0,4]],"holes":[[[1,1],[1,2],[2,2],[2,1]]]},)"
    R"("q":{"outer":[[0,0],[1,0],[0,1]]},"placements":[[1,1],[9,9]],"direction":[1,0],)"
    R"("complete":"straight","slots":true})",
    R"({"id":1,"query":"polygon_depth","p":{"outer":[[0,0],[4,0],[4,4],[0,4]]},"q":{"outer":[[0,0],[1,0],[0,1]]},)"
    R"("direction_set":[[1,0],[0,1]],"method":"explicit"})",
    R"({"id":1,"query":"approx_directional_width","a":{"points":[[0,0],[1,0],[0,1]],"affine":{"matrix":[[1,0],[0,1]],)"
    R"("translation":[1,1]}},"epsilon":0.25,"directions":[[1,0]],"method":"kernel"})",
    R"({"id":1,"query":"approx_intersect","a":{"points":[[0,0],[1,0],[0,1]]},"b":[{"halfspaces":[[1,0,1],[-1,0,1],)"
    R"([0,1,1],[0,-1,1]]}],"epsilon":0.25,"backend":"kernel"})",
    R"({"id":1,"query":"approx_minkowski_sum","a":{"sum_of":[{"points":[[0,0],[1,0],[0,1]]}]},)"
    R"("b":{"hull_of":[{"points":[[0,0],[1,0],[1,1]]},{"points":[[0,1],[0,2],[1,2]]}]},"epsilon":0.25,"representation":"points"})",
    R"({"id":1,"query":"approx_width","a":{"points":[[0,0,0],[1,0,0],[0,1,0],[0,0,1]]},"epsilon":0.25})",
    R"({"id":1,"query":"approximate","a":{"intersection_of":[{"points":[[0,0],[1,0],[0,1]]},)"
    R"({"points":[[0,0],[1,0],[1,1]]}]},"epsilon":0.25,"representation":"points","side":"outer","backend":"macbeath"})",
    R"({"id":1,"query":"epsilon_kernel","a":{"points":[[0,0],[1,0],[0,1]]},"epsilon":0.25})",
    R"({"id":1,"query":"approx_membership","a":{"points":[[0,0],[1,0],[0,1]]},"epsilon":0.25,"points":[[0.1,0.1]],)"
    R"("backend":"exact"})",
};

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
  for (const char* line : kWholeLines) {
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
  for (const char* whole : kWholeLines) {
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
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  const query::LineBudget budget{.milliseconds = 20'000, .megabytes = 0};
#else
  const query::LineBudget budget{.milliseconds = 20'000, .megabytes = 1'000};
#endif
  query::Session session;
  session.limits.files = false;
  for (const char* whole : kWholeLines) {
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

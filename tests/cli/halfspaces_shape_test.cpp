/// @file
/// The shape "halfspaces" in queries: the same answers as the polytope that it is; unbounded, empty and flat by name.
#include "protocol_lines.hpp"

namespace pd::test {
namespace {

constexpr const char* kCube =
    R"({"type":"halfspaces","planes":[[1,0,0,1],[-1,0,0,1],[0,1,0,1],[0,-2,0,2],[0,0,1,1],[0,0,-1,1]]})";

TEST(HalfspacesShape, AnswersAsTheBoxThatItIs) {
  const std::string more = R"("pose_b":{"translation":[1.5,0.25,0]})";
  const Json mine = answer(depth_line(kCube, kUnitBox, more), {});
  const Json box = answer(depth_line(R"({"type":"box","half_extents":[1,1,1]})", kUnitBox, more), {});
  for (const char* key : {"class", "depth", "lower", "upper", "translation", "normal"}) {
    EXPECT_EQ(mine.at(key), box.at(key)) << key;
  }
  const Json hull = answer(R"({"id":1,"query":"hull","a":)" + std::string(kCube) + "}", {});
  EXPECT_EQ(hull.at("vertices").size(), 8u);
  EXPECT_EQ(hull.at("facets").size(), 6u);
}

TEST(HalfspacesShape, RefusalsByName) {
  const auto refused = [](const std::string& planes, const char* code, const char* where) {
    const Json reply = answer(depth_line(R"({"type":"halfspaces","planes":)" + planes + "}", kUnitBox), {});
    EXPECT_EQ(code_of(reply), code) << reply.dump();
    EXPECT_EQ(where_of(reply), where) << reply.dump();
  };
  refused("[[1,0,0,1],[-1,0,0,1],[0,1,0,1],[0,-1,0,1],[0,0,1,1]]", "unbounded", "a.planes");
  refused("[[1,0,0,-1],[-1,0,0,-1],[0,1,0,1],[0,-1,0,1],[0,0,1,1],[0,0,-1,1]]", "bad_value", "a.planes");
  refused("[[1,0,0,0],[-1,0,0,0],[0,1,0,1],[0,-1,0,1],[0,0,1,1],[0,0,-1,1]]", "not_full_dimensional", "a.planes");
  refused("[[1,0,0,1],[-1,0,0,1]]", "too_few_points", "a.planes");
  refused("[[1,0,0,1],[0,0,0,1],[0,1,0,1],[0,0,1,1]]", "zero_direction", "a.planes[1]");
  refused("[[1,0,0,1],[0,\"nan\",0,1],[0,1,0,1],[0,0,1,1]]", "non_finite", "a.planes[1][1]");
  refused("[[1,0,0],[0,1,0,1],[0,1,0,1],[0,0,1,1]]", "bad_value", "a.planes[0]");
  refused("7", "bad_value", "a.planes");
}

}  // namespace
}  // namespace pd::test

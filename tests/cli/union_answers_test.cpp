/// @file
/// Compounds and star-shaped bodies over the line protocol: answers known from plain geometry, and every refusal.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "protocol_lines.hpp"

namespace pd::test {
namespace {

std::string box(const std::string& half_extents, const std::string& translation = "[0,0,0]") {
  return R"({"shape":{"type":"box","half_extents":)" + half_extents + R"(},"pose":{"translation":)" + translation +
         "}}";
}

/// A U that opens along y: the legs' inner sides at x = -0.5 and 0.5, their tops at y = 1, the floor at y = -1.
std::string letter_u() {
  return R"({"type":"compound","parts":[)" + box("[1.5,0.5,1]", "[0,-1.5,0]") + "," + box("[0.5,1,1]", "[-1,0,0]") +
         "," + box("[0.5,1,1]", "[1,0,0]") + "]}";
}

constexpr const char* kCube = R"({"type":"box","half_extents":[0.5,0.5,0.5]})";
/// An octahedron, one corner drawn in: not convex, star-shaped about the origin.
constexpr const char* kStar =
    R"({"type":"star","vertices":[[1,0,0],[-1,0,0],[0,1,0],[0,-1,0],[0,0,1],[0,0,-0.25]],)"
    R"("faces":[[0,2,4],[2,1,4],[1,3,4],[3,0,4],[2,0,5],[1,2,5],[3,1,5],[0,3,5]],"center":[0,0,0.25]})";

std::string line(const std::string& query, const std::string& a, const std::string& b, const std::string& more = "") {
  return R"({"id":1,"query":")" + query + R"(","a":)" + a + R"(,"b":)" + b + (more.empty() ? "" : "," + more) + "}";
}

TEST(UnionAnswers, DepthNamesItsParts) {
  // Without play between the legs, the way out is along z.
  const Json held = answer(line("depth", kCube, letter_u(), R"("pose_a":{"translation":[0,0,0.25]})"));
  EXPECT_EQ(held["class"], "overlapping");
  EXPECT_EQ(held["depth"], 1.25);
  EXPECT_EQ(held["lower"], 1.25);
  EXPECT_EQ(held["translation"], Json::parse("[0.0,0.0,1.25]"));
  EXPECT_EQ(held["exact"], true);
  EXPECT_EQ(held["feature"]["kind"], "facet-vertex");
  EXPECT_EQ(held["feature"]["part_a"], 0);
  EXPECT_TRUE(held["feature"]["part_b"] == 1 || held["feature"]["part_b"] == 2) << held.dump();
  // Half way into the left leg from above.
  const Json leg = answer(line("depth", kCube, letter_u(), R"("pose_a":{"translation":[-1,1.25,0]})"));
  EXPECT_EQ(leg["depth"], 0.25);
  EXPECT_EQ(leg["feature"]["part_b"], 1);
  EXPECT_EQ(leg["normal"], Json::parse("[0.0,1.0,0.0]"));
  // Swapped: turned round.
  const Json swapped = answer(line("depth", letter_u(), kCube, R"("pose_b":{"translation":[-1,1.25,0]})"));
  EXPECT_EQ(swapped["depth"], 0.25);
  EXPECT_EQ(swapped["translation"], Json::parse("[0.0,-0.25,0.0]"));
}

TEST(UnionAnswers, DistanceClassAndPoints) {
  const std::string up = R"("pose_a":{"translation":[0,2,0]})";
  const Json apart = answer(line("distance", kCube, letter_u(), up));
  EXPECT_EQ(apart["class"], "separated");
  EXPECT_EQ(apart["distance"], 0.5);
  EXPECT_EQ(answer(line("intersect", kCube, letter_u(), up))["class"], "separated");
  EXPECT_EQ(answer(line("intersect", kCube, letter_u()))["class"], "overlapping");
  const Json points = answer(line("point_in_difference", kCube, letter_u(), R"("points":[[0,0,0],[0,1.5,0],[0,2,0]])"));
  EXPECT_EQ(points["classes"], Json::parse(R"(["overlapping","touching","separated"])"));
}

TEST(UnionAnswers, AlongADirection) {
  const Json up = answer(line("directional_depth", kCube, letter_u(), R"("direction":[0,2,0])"));
  EXPECT_EQ(up["depth"], 1.5);
  EXPECT_EQ(up["lower"], up["upper"]);
  const Json down = answer(line("directional_depth", kCube, letter_u(), R"("direction":[0,-1,0],"method":"overlay")"));
  EXPECT_EQ(down["depth"], 2.5);
}

TEST(UnionAnswers, SupportIsThatOfTheExtremeParts) {
  const Json support =
      answer(line("support_of_difference", kCube, letter_u(), R"("directions":[[1,0.125,0],[0,-1,0]])"));
  EXPECT_EQ(support["values"], Json::parse("[2.1875,2.5]"));
  EXPECT_EQ(support["parts_b"], Json::parse("[2,0]"));
}

TEST(UnionAnswers, ContactsOfTheDecidingParts) {
  const Json contacts = answer(line("contact_manifold", kCube, letter_u(), R"("pose_a":{"translation":[-1,1.25,0]})"));
  EXPECT_EQ(contacts["points"].size(), 4u);
  for (const Json& point : contacts["points"]) EXPECT_EQ(point["depth"], 0.25);
  EXPECT_EQ(contacts["part_b"], 1);
}

TEST(UnionAnswers, TheDifferenceIsBuilt) {
  // The channel has no play: the sum is a block, and no facet stands on its wall.
  const Json built = answer(line("minkowski_difference", kCube, letter_u()));
  ASSERT_TRUE(built.contains("facets")) << built.dump();
  EXPECT_EQ(built["K"], built["facets"].size());
  EXPECT_EQ(built["parts_b"].size(), built["facets"].size());
  for (const Json& vertex : built["vertices"]) {
    const bool outside = std::abs(vertex[0].get<double>()) == 2 || std::abs(vertex[2].get<double>()) == 1.5 ||
                         vertex[1] == 1.5 || vertex[1] == -2.5;
    EXPECT_TRUE(outside) << vertex.dump();
  }
}

TEST(UnionAnswers, CompoundsNestAndCarryMargins) {
  std::string nested = kUnitBox;
  for (int depth = 0; depth < 8; ++depth) {
    nested = R"({"type":"compound","parts":[{"shape":)" + nested + R"(,"pose":{"translation":[0.125,0,0]}}]})";
  }
  // Eight steps of 1/8 along x: a unit box about (1, 0, 0).
  const Json deep = answer(line("depth", nested, kUnitBox, R"("pose_a":{"translation":[0.5,0,0]})"));
  EXPECT_EQ(deep["depth"], 0.5);
  const std::string too_deep = R"({"type":"compound","parts":[{"shape":)" + nested + "}]}";
  EXPECT_EQ(code_of(answer(line("depth", too_deep, kUnitBox))), "limit_exceeded");
  // Two spheres of radius 1/2 about (-1, 0, 0) and (1, 0, 0), and a ball on one of them.
  const std::string pair =
      R"({"type":"compound","margin":0.25,"parts":[{"shape":{"type":"sphere","radius":0.25},"pose":{"translation":[-1,0,0]}},)"
      R"({"shape":{"type":"sphere","radius":0.25},"pose":{"translation":[1,0,0]}}]})";
  const Json ball = answer(
      line("depth", pair, R"({"type":"sphere","radius":0.5})", R"("pose_b":{"translation":[1.75,0,0]},"delta":0.01)"));
  EXPECT_LE(ball["lower"].get<double>(), 0.25);
  EXPECT_GE(ball["upper"].get<double>(), 0.25);
  EXPECT_LE(ball["upper"].get<double>(), 0.2526);
}

TEST(UnionAnswers, StarShapedBodies) {
  // A cube pushed up against the drawn-in corner from below stands deeper than the octahedron's hull would let it.
  const std::string small = R"({"type":"box","half_extents":[0.0625,0.0625,0.0625]})";
  const Json free = answer(line("intersect", small, kStar, R"("pose_a":{"translation":[0,0,-0.375]})"));
  EXPECT_EQ(free["class"], "separated");
  const Json top = answer(line("depth", kStar, kStar, R"("pose_a":{"translation":[1.75,0,0]})"));
  EXPECT_EQ(top["class"], "overlapping");
  EXPECT_EQ(top["exact"], true);
  EXPECT_LE(top["depth"].get<double>(), 0.25);
  const Json same = answer(line("depth", kStar, kUnitBox));
  EXPECT_GT(same["depth"].get<double>(), 1);
}

TEST(UnionAnswers, WhatIsNoStarIsNamed) {
  const auto star = [](const std::string& vertices, const std::string& faces, const std::string& centre) {
    return R"({"type":"star","vertices":)" + vertices + R"(,"faces":)" + faces + R"(,"center":)" + centre + "}";
  };
  const std::string corners = "[[0,0,0],[1,0,0],[0,1,0],[0,0,1]]";
  const std::string faces = "[[0,2,1],[0,1,3],[0,3,2],[1,2,3]]";
  EXPECT_EQ(code_of(answer(line("depth", star(corners, faces, "[0.125,0.125,0.125]"), kCube))), "");
  struct Case {
    std::string body;
    std::string code;
    std::string where;
  };
  for (const Case& c : std::vector<Case>{
           {star(corners, faces, "[1,1,1]"), "bad_faces", "a.faces[3]"},
           {star(corners, faces, "[0,0.25,0.25]"), "bad_faces", "a.faces[2]"},
           {star(corners, "[[0,2,1],[0,1,3],[0,3,2],[1,2,4]]", "[0.125,0.125,0.125]"), "bad_faces", "a.faces[3]"},
           {star(corners, "[[0,2,1],[0,1,3],[0,3,2],[1,3,2]]", "[0.125,0.125,0.125]"), "bad_faces", "a.faces[3]"},
           {star(corners, "[[0,2,1],[0,1,3],[0,3,2],[1,1,2]]", "[0.125,0.125,0.125]"), "bad_faces", "a.faces[3]"},
           {star(corners, "[[0,2,1],[0,1,3],[0,3,2],[1,2,3,0]]", "[0.125,0.125,0.125]"), "bad_faces", "a.faces[3]"},
           {star(corners, "[[0,2,1],[0,1,3],[0,3,2]]", "[0.125,0.125,0.125]"), "too_few_points", "a.faces"},
           {star(corners, faces, "[0,0,\"nan\"]"), "non_finite", "a.center[2]"},
       }) {
    const Json reply = answer(line("depth", c.body, kCube));
    EXPECT_EQ(code_of(reply), c.code) << reply.dump();
    EXPECT_EQ(where_of(reply), c.where) << reply.dump();
  }
}

TEST(UnionAnswers, WhatIsNotAnsweredSaysSo) {
  for (const char* query : {"width", "hull"}) {
    const Json reply = answer(R"({"id":1,"query":")" + std::string(query) + R"(","a":)" + letter_u() + "}");
    EXPECT_EQ(code_of(reply), "unsupported") << reply.dump();
    EXPECT_EQ(where_of(reply), "a.type");
  }
  EXPECT_EQ(code_of(answer(line("depth", kCube, letter_u(), R"("method":"overlay")"))), "unsupported");
  EXPECT_EQ(code_of(answer(line("depth", kCube, letter_u(), R"("delta":2)"))), "bad_value");
  EXPECT_EQ(code_of(answer(line("directional_depth", kCube, letter_u(), R"("direction":[0,0,0])"))), "zero_direction");
  EXPECT_EQ(where_of(answer(line("directional_depth", kCube, letter_u(), R"("direction":[0,0,0])"))), "direction");
}

}  // namespace
}  // namespace pd::test

/// @file
/// The contract table of the depth answer: every field, in every class.
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>

#include "protocol_lines.hpp"

namespace pd::test {
namespace {

std::string at(double x, double y, double z) {
  return R"("pose_b":{"translation":[)" + std::to_string(x) + "," + std::to_string(y) + "," + std::to_string(z) + "]}";
}

TEST(DepthAnswer, Overlapping) {
  const Json reply = answer(depth_line(kUnitBox, kUnitBox, at(1.5, 0.25, 0)));
  EXPECT_EQ(reply.at("id"), 1);
  EXPECT_EQ(reply.at("class"), "overlapping");
  EXPECT_EQ(reply.at("depth"), 0.5);
  EXPECT_EQ(reply.at("lower"), 0.5);
  EXPECT_EQ(reply.at("upper"), 0.5);
  EXPECT_EQ(reply.at("distance"), 0.0);
  EXPECT_FALSE(reply.contains("distance_lower"));
  EXPECT_EQ(reply.at("translation"), Json({-0.5, 0.0, 0.0})) << "A moves away from B";
  EXPECT_EQ(reply.at("normal"), Json({-1.0, 0.0, 0.0}));
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(reply.at("witness_b")[i].get<double>() - reply.at("witness_a")[i].get<double>(),
                reply.at("translation")[i].get<double>(), 1e-15);
  }
  EXPECT_TRUE(reply.at("method").is_string());
  EXPECT_GE(reply.at("stats").at("support_calls").get<int>(), 0);
  EXPECT_GE(reply.at("stats").at("nanoseconds").get<int>(), 0);
  EXPECT_TRUE(reply.at("stats").contains("facets_visited"));
}

TEST(DepthAnswer, KeysStandInTheProtocolsOrder) {
  const std::string text = answer_text(depth_line(kUnitBox, kUnitBox, at(1.5, 0.25, 0)));
  std::size_t last = 0;
  for (const char* key :
       {"\"id\"", "\"class\"", "\"depth\"", "\"lower\"", "\"upper\"", "\"distance\"", "\"translation\"", "\"normal\"",
        "\"witness_a\"", "\"witness_b\"", "\"feature\"", "\"method\"", "\"stats\""}) {
    const std::size_t place = text.find(key);
    ASSERT_NE(place, std::string::npos) << key;
    EXPECT_GE(place, last) << key;
    last = place;
  }
}

TEST(DepthAnswer, Touching) {
  const Json reply = answer(depth_line(kUnitBox, kUnitBox, at(2, 0.25, 0)));
  EXPECT_EQ(reply.at("class"), "touching");
  for (const char* key : {"depth", "lower", "upper", "distance"}) EXPECT_EQ(reply.at(key), 0.0) << key;
  EXPECT_EQ(reply.at("translation"), Json({0.0, 0.0, 0.0}));
  EXPECT_EQ(reply.at("normal"), Json({-1.0, 0.0, 0.0})) << "a direction in which A leaves B";
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(reply.at("witness_a")[i].get<double>(), reply.at("witness_b")[i].get<double>(), 1e-15);
  }
}

TEST(DepthAnswer, Separated) {
  const Json reply = answer(depth_line(kUnitBox, kUnitBox, at(2.75, 0.25, 0)));
  EXPECT_EQ(reply.at("class"), "separated");
  for (const char* key : {"depth", "lower", "upper"}) EXPECT_EQ(reply.at(key), 0.0) << key;
  EXPECT_EQ(reply.at("translation"), Json({0.0, 0.0, 0.0}));
  EXPECT_EQ(reply.at("distance"), 0.75);
  EXPECT_LE(reply.at("distance_lower").get<double>(), 0.75);
  EXPECT_GE(reply.at("distance_upper").get<double>(), 0.75);
  EXPECT_EQ(reply.at("normal"), Json({-1.0, 0.0, 0.0})) << "(witness_a - witness_b) / distance";
}

TEST(DepthAnswer, FeatureNamesTheCallersIds) {
  // A tetrahedron's vertex 2 (its duplicate is 4) pokes into the box from above.
  const std::string poker =
      R"({"type":"convex","vertices":[[3,3,5],[-3,3,5],[0.1,0.2,0.5],[0,-4,5],[0.1,0.2,0.5],[0,0,4.9]]})";
  const Json reply = answer(depth_line(poker, kUnitBox));
  ASSERT_EQ(reply.at("class"), "overlapping");
  EXPECT_EQ(reply.at("depth"), 0.5);
  EXPECT_EQ(reply.at("feature").at("kind"), "vertex-facet");
  EXPECT_EQ(reply.at("feature").at("a"), Json({2}));
  std::vector<int> top = reply.at("feature").at("b");
  std::sort(top.begin(), top.end());
  EXPECT_EQ(top, (std::vector<int>{4, 5, 6, 7})) << "box vertices with z > 0 have bit 2";
}

TEST(DepthAnswer, RoundedBodiesNameTheirCoresFeature) {
  const Json reply =
      answer(depth_line(R"({"type":"sphere","radius":0.5})", kUnitBox, R"("pose_a":{"translation":[0,0,1.25]})"));
  EXPECT_EQ(reply.at("class"), "overlapping");
  EXPECT_NEAR(reply.at("depth").get<double>(), 0.25, 1e-15);
  EXPECT_FALSE(reply.at("feature").is_null());
}

TEST(DepthAnswer, SmoothBodiesHaveNoFeature) {
  const Json reply = answer(depth_line(R"({"type":"ellipsoid","radii":[1,2,3]})", kUnitBox, R"("delta":1e-4)"));
  EXPECT_EQ(reply.at("class"), "overlapping");
  EXPECT_TRUE(reply.at("feature").is_null());
  const double lower = reply.at("lower");
  const double upper = reply.at("upper");
  EXPECT_LE(lower, upper);
  EXPECT_LE(upper, lower * (1 + 1e-4) * (1 + 1e-12));
}

TEST(DepthAnswer, DeltaLeavesPolytopesExact) {
  const Json exact = answer(depth_line(kUnitBox, kUnitBox, at(1.5, 0.25, 0.125)));
  const Json rough = answer(depth_line(kUnitBox, kUnitBox, at(1.5, 0.25, 0.125) + R"(,"delta":1)"));
  EXPECT_EQ(exact.at("depth"), rough.at("depth"));
  EXPECT_EQ(exact.at("upper"), rough.at("upper"));
}

TEST(DepthAnswer, EnginesAgree) {
  const std::string more = at(0.7, 0.3, 0.4);
  const Json first = answer(depth_line(kUnitBox, kUnitBox, more + R"(,"method":"expansion")"));
  const Json second = answer(depth_line(kUnitBox, kUnitBox, more + R"(,"method":"overlay")"));
  EXPECT_EQ(first.at("method"), "expansion");
  EXPECT_EQ(second.at("method"), "overlay");
  for (const char* key : {"class", "depth", "lower", "upper", "translation", "normal"}) {
    EXPECT_EQ(first.at(key), second.at(key)) << key;
  }
}

TEST(DepthAnswer, FlatBodiesAreBodies) {
  const Json reply = answer(depth_line(R"({"type":"convex","vertices":[[-1,-1,0],[1,-1,0],[0,1,0]]})", kUnitBox));
  EXPECT_EQ(reply.at("class"), "overlapping");
  EXPECT_EQ(reply.at("depth"), 1.0);
}

TEST(DepthAnswer, BodiesThinnerThanRoundingHaveADepth) {
  const std::string ball = R"({"type":"sphere","radius":1})";
  const Json reply = answer(depth_line(ball, R"({"type":"ellipsoid","radii":[1,2,1e-17]})"));
  EXPECT_EQ(reply.at("class"), "overlapping");
  EXPECT_NEAR(reply.at("depth").get<double>(), 1, 1e-13);
  EXPECT_NEAR(std::abs(reply.at("normal")[2].get<double>()), 1, 1e-13);
  // The depth 1 + 1e-300 is 1 rounded down, and an ulp more rounded up.
  const Json mixed = answer(depth_line(R"({"type":"box","half_extents":[1e-300,1e-300,1e-300]})", kUnitBox));
  EXPECT_EQ(mixed.at("lower"), 1.0);
  EXPECT_LE(mixed.at("upper").get<double>(), 1 + 0x1p-52);
}

TEST(DistanceAnswer, IsADepthAnswer) {
  const Json reply = answer(std::string(R"({"id":1,"query":"distance","a":)") + kUnitBox + R"(,"b":)" + kUnitBox + "," +
                            at(3, 0, 0) + "}");
  EXPECT_EQ(reply.at("class"), "separated");
  EXPECT_EQ(reply.at("distance"), 1.0);
  EXPECT_TRUE(reply.contains("witness_a"));
}

TEST(IntersectAnswer, SeparatingDirectionSeparates) {
  const std::string head = std::string(R"({"id":1,"query":"intersect","a":)") + kUnitBox + R"(,"b":)" + kUnitBox + ",";
  const Json apart = answer(head + at(3, 0.5, 0) + "}");
  EXPECT_EQ(apart.at("class"), "separated");
  const auto n = apart.at("separating_direction").get<std::vector<double>>();
  // max over A of <n, a> < min over B of <n, b>
  const double reach = std::abs(n[0]) + std::abs(n[1]) + std::abs(n[2]);
  EXPECT_LT(reach, 3 * n[0] + 0.5 * n[1] - reach);
  const Json together = answer(head + at(1, 0, 0) + "}");
  EXPECT_EQ(together.at("class"), "overlapping");
  EXPECT_FALSE(together.contains("separating_direction"));
}

TEST(IntersectAnswer, CornersAHairApartHaveADirection) {
  // A corner of B is a corner of A but for one unit in the last place of x: the nearest points' own direction, rounded
  // to unit length, does not separate the bodies.
  const std::string line =
      R"({"query":"intersect","a":{"type":"convex","vertices":[
         [196320.28239784256,-277106.1158478627,-67176.48618040023],[-70828.486913713,161880.015355857,-131532.7058947834],
         [-50366.74950392729,247895.78413715816,-100919.5554451536],[-262565.59814109537,35896.741021844224,-54450.24407342388],
         [53682.25638189714,105960.52420550546,-19483.757887845008],[112649.72559152018,-112342.6902803978,92719.55987680043],
         [81030.89130365964,41116.90727593404,-228227.65065104593],[126632.50969084348,-79255.03241384462,-1304.5742516338814]]},
         "b":{"type":"convex","vertices":[
         [304319.5103378655,-497385.1108799033,-186427.6368595418],[228160.61904158271,-501498.3763068753,-179393.51977147843],
         [297220.03568889614,-471450.0369749542,-90099.1557448908],[196320.28239784253,-277106.1158478627,-67176.48618040024],
         [121233.7196496816,-406712.08383683674,305340.1115895016]]}})";
  std::string one_line = line;
  std::erase(one_line, '\n');
  const Json reply = answer(one_line);
  EXPECT_EQ(reply.at("class"), "separated");
  ASSERT_TRUE(reply.contains("separating_direction"));
  using Exact = boost::multiprecision::cpp_rational;
  const Json question = Json::parse(one_line);
  const auto along = [&](const Json& vertex) {
    Exact sum = 0;
    for (int i = 0; i < 3; ++i)
      sum += Exact(vertex[i].get<double>()) * Exact(reply.at("separating_direction")[i].get<double>());
    return sum;
  };
  for (const Json& a : question.at("a").at("vertices")) {
    for (const Json& b : question.at("b").at("vertices")) EXPECT_LT(along(a), along(b));
  }
}

TEST(HullAnswer, CubeWithDuplicatesAndInnerPoints) {
  const Json reply = answer(
      R"({"id":"h","query":"hull","a":{"type":"convex","vertices":[[0,0,0],[2,0,0],[0,2,0],[2,2,0],[0,0,2],[2,0,2],[0,2,2],
          [2,2,2],[1,1,1],[2,2,2],[1,0,0],[1,1,0]]},"pose_a":{"translation":[10,0,0]}})");
  EXPECT_EQ(reply.at("affine_dim"), 3);
  EXPECT_EQ(reply.at("vertices").size(), 8u);
  EXPECT_EQ(reply.at("facets").size(), 6u);
  std::vector<int> ids = reply.at("vertex_ids");
  for (std::size_t i = 0; i < ids.size(); ++i) {
    EXPECT_LT(ids[i], 8);
    EXPECT_GE(reply.at("vertices")[i][0].get<double>(), 10);
  }
  for (const Json& facet : reply.at("facets")) EXPECT_EQ(facet.size(), 4u);
}

TEST(HullAnswer, FlatBodiesHaveNoFacets) {
  const Json reply =
      answer(R"({"id":1,"query":"hull","a":{"type":"convex","vertices":[[0,0,0],[1,0,0],[0,1,0],[0.25,0.25,0]]}})");
  EXPECT_EQ(reply.at("affine_dim"), 2);
  EXPECT_EQ(reply.at("vertices").size(), 3u);
  EXPECT_TRUE(reply.at("facets").empty());
}

TEST(HullAnswer, SmoothBodiesAreRefused) {
  EXPECT_EQ(code_of(answer(R"({"id":1,"query":"hull","a":{"type":"ellipsoid","radii":[1,1,1]}})")), "unsupported");
}

}  // namespace
}  // namespace pd::test

/// @file
/// The query `polygon_depth`.
#include "protocol_lines.hpp"

namespace pd::test {
namespace {

constexpr const char* kFrame = R"({"outer":[[0,0],[10,0],[10,10],[0,10]],"holes":[[[3,3],[7,3],[7,7],[3,7]]]})";
constexpr const char* kUnitSquare = R"({"outer":[[0,0],[1,0],[1,1],[0,1]]})";

std::string line(const std::string& p, const std::string& q, const std::string& more) {
  return R"({"id":1,"query":"polygon_depth","p":)" + p + R"(,"q":)" + q + (more.empty() ? "" : ",") + more + "}";
}

TEST(PolygonQuery, DepthOverAllDirections) {
  const Json reply = answer(line(kFrame, kUnitSquare, ""));
  EXPECT_EQ(reply.at("class"), "overlapping");
  EXPECT_EQ(reply.at("depth"), 1.0);
  EXPECT_EQ(reply.at("lower"), 1.0);
  EXPECT_EQ(reply.at("upper"), 1.0);
  EXPECT_EQ(reply.at("translation"), Json::parse("[-1.0,0.0]"));
  EXPECT_EQ(reply.at("method"), "implicit");
  EXPECT_EQ(reply.at("stats").at("holes"), 1);
  EXPECT_EQ(reply.at("stats").at("facts_hold"), true);
  EXPECT_LE(reply.at("stats").at("events"), reply.at("stats").at("most_events"));
  EXPECT_EQ(reply.at("feature").at("p").at("ring"), "outer");
}

TEST(PolygonQuery, AlongADirection) {
  const Json reply = answer(line(kFrame, kUnitSquare, R"("direction":[3,0])"));
  EXPECT_EQ(reply.at("depth"), 10.0);  // along the lower edge, past the hole
  EXPECT_EQ(reply.at("normal"), Json::parse("[1.0,0.0]"));
}

TEST(PolygonQuery, ListsOfPlacementsAndDirections) {
  const Json many = answer(line(kFrame, kUnitSquare, R"("placements":[[2.25,4],[4,4],[-1,0]],"direction":[3,0])"));
  EXPECT_EQ(many.at("classes"), Json::parse(R"(["overlapping","separated","touching"])"));
  EXPECT_EQ(many.at("depths"), Json::parse("[0.75,0.0,0.0]"));
  const Json away = answer(line(kFrame, kUnitSquare, R"("placements":[[2.25,4],[4,4]],"complete":"escape")"));
  EXPECT_EQ(away.at("depths"), Json::parse("[3.25,5.0]"));
  const Json straight =
      answer(line(kFrame, kUnitSquare, R"("placements":[[2.25,4]],"complete":true,"direction_set":[[1,0],[0,1]])"));
  EXPECT_EQ(straight.at("depths"), Json::parse("[7.75,6.0]"));
}

TEST(PolygonQuery, StraightOutOverAllDirections) {
  const Json reply = answer(line(kFrame, kUnitSquare, R"("placements":[[4,4],[2.25,4],[11,4]],"complete":"straight")"));
  EXPECT_EQ(reply.at("classes"), Json::parse(R"(["separated","overlapping","separated"])"));
  EXPECT_EQ(reply.at("depths"), Json::parse("[5.0,3.25,0.0]"));
}

// A set is answered out of trapezoids where many placements ask, one direction by rays.
TEST(PolygonQuery, ADirectionSetGivesWhatItsDirectionsGive) {
  std::string at = R"("placements":[[2.25,4],[4,4],[-1,0],[0.5,0.125])";
  for (int i = 4; i < 100; ++i) at += ",[" + std::to_string(i % 13 - 1) + "," + std::to_string(i / 9) + ".5]";
  at += "]";
  const Json set = answer(line(kFrame, kUnitSquare, at + R"(,"direction_set":[[1,0],[-2,5]])"));
  const Json first = answer(line(kFrame, kUnitSquare, at + R"(,"direction":[1,0])"));
  const Json second = answer(line(kFrame, kUnitSquare, at + R"(,"direction":[-2,5])"));
  for (const char* field : {"classes", "depths", "lowers", "translations", "normals"}) {
    for (std::size_t i = 0; i < 100; ++i) {
      if (set.at("classes").at(2 * i) == "touching" && field == std::string("normals")) continue;  // of either edge
      EXPECT_EQ(set.at(field).at(2 * i), first.at(field).at(i)) << field << " " << i;
      EXPECT_EQ(set.at(field).at(2 * i + 1), second.at(field).at(i)) << field << " " << i;
    }
  }
}

TEST(PolygonQuery, SlotsAreListedAndNoWayOut) {
  const Json reply = answer(line(R"({"outer":[[0,0],[10,0],[10,10],[0,10]],"holes":[[[3,3],[4,3],[4,7],[3,7]]]})",
                                 kUnitSquare, R"("placements":[[3,4]],"slots":true)"));
  EXPECT_EQ(reply.at("classes").at(0), "overlapping");
  EXPECT_EQ(reply.at("depths").at(0), 4.0);
  EXPECT_EQ(reply.at("slots"), Json::parse("[[[3.0,3.0],[3.0,6.0]]]"));
  EXPECT_TRUE(reply.at("seat_points").empty());
  EXPECT_EQ(reply.at("seats"), Json::parse("[true]"));
}

TEST(PolygonQuery, ASeatIsToldBesideTheClass) {
  const std::string hole = R"({"outer":[[0,0],[10,0],[10,10],[0,10]],"holes":[[[3,3],[4,3],[4,4],[3,4]]]})";
  const Json reply = answer(line(hole, R"({"outer":[[3,3],[4,3],[4,4],[3,4]]})", R"("slots":true)"));
  EXPECT_EQ(reply.at("class"), "overlapping");
  EXPECT_EQ(reply.at("seat"), true);
  EXPECT_EQ(reply.at("seat_points"), Json::parse("[[0.0,0.0]]"));
  EXPECT_TRUE(reply.at("slots").empty());
  EXPECT_EQ(answer(line(hole, kUnitSquare, "")).at("seat"), false);
}

TEST(PolygonQuery, RingsMayTouch) {
  const Json reply = answer(line(R"({"outer":[[0,0],[8,0],[8,8],[0,8]],"holes":[[[4,0],[6,4],[2,4]]]})", kUnitSquare,
                                 R"("placements":[[3.5,0.25],[3.5,2.75]])"));
  EXPECT_EQ(reply.at("classes"), Json::parse(R"(["overlapping","separated"])"));
}

TEST(PolygonQuery, MarginsSweepAndDiscsAreSweptPoints) {
  const std::string square = R"({"outer":[[0,0],[4,0],[4,4],[0,4]],"margin":0.5})";
  const std::string disc = R"({"outer":[[0,0]],"margin":1.5})";
  const Json reply = answer(line(square, disc, R"("placements":[[1,2],[5,2],[6,2],[7,7]])"));
  EXPECT_EQ(reply.at("classes"), Json::parse(R"(["overlapping","overlapping","touching","separated"])"));
  EXPECT_EQ(reply.at("depths"), Json::parse("[3.0,1.0,0.0,0.0]"));
  EXPECT_FALSE(reply.contains("seats"));
  EXPECT_EQ(answer(line(disc, R"({"outer":[[3,0]],"margin":2})", "")).at("depth"), 0.5);
  const Json notched =
      answer(line(R"({"outer":[[0,0],[6,0],[6,2],[2,2],[2,6],[0,6]]})", disc, R"("placements":[[1,1]])"));
  const double lower = notched.at("lowers").at(0), upper = notched.at("uppers").at(0);
  EXPECT_LE(upper - lower, 2e-6 * upper);
  EXPECT_EQ(notched.at("depths").at(0), upper);
}

TEST(PolygonQuery, ADiscGetsAwayForGood) {
  const std::string disc = R"({"outer":[[0,0]],"margin":1})";
  for (const char* how : {R"("complete":"escape")", R"("complete":"straight")"}) {
    const Json away = answer(line(kFrame, disc, R"("placements":[[4,5],[2,5],[-2,5]],)" + std::string(how)));
    EXPECT_EQ(away.at("classes"), Json::parse(R"(["touching","overlapping","separated"])")) << away;
    for (const auto& [k, known] : {std::pair{0, 5.0}, {1, 3.0}, {2, 0.0}}) {
      EXPECT_LE(away.at("lowers").at(static_cast<std::size_t>(k)), known) << away;
      EXPECT_NEAR(away.at("uppers").at(static_cast<std::size_t>(k)).get<double>(), known, 1e-6) << away;
    }
  }
  const Json both =
      answer(line(kFrame, R"({"outer":[[0,0],[2,0],[2,2],[1.5,0.5]],"margin":1})", R"("complete":"escape")"));
  EXPECT_EQ(both.at("error").at("where"), "complete") << both;
}

TEST(PolygonQuery, Refusals) {
  const auto refused = [](const std::string& text, const char* code, const char* where) {
    const Json reply = answer(text);
    ASSERT_TRUE(reply.contains("error")) << text;
    EXPECT_EQ(reply.at("error").at("code"), code) << reply;
    EXPECT_EQ(reply.at("error").at("where"), where) << reply;
  };
  refused(line(R"({"outer":[[0,0],[4,4],[4,0],[0,4]]})", kUnitSquare, ""), "bad_value", "p.outer[0]");
  refused(line(R"({"outer":[[0,0],[4,4]]})", kUnitSquare, ""), "too_few_points", "p.outer");
  refused(line(kUnitSquare, R"({"outer":[[0,0],[4,0],[0,4]],"holes":[[[5,5],[6,5],[6,6]]]})", ""), "bad_value",
          "q.holes[0][0]");
  refused(line(kUnitSquare, R"({"outer":[[0,0],["nan",0],[0,4]]})", ""), "non_finite", "q.outer[1][0]");
  refused(line(kUnitSquare, kUnitSquare, R"("direction":[0,0])"), "zero_direction", "direction");
  refused(line(kFrame, kFrame, R"("method":"implicit")"), "unsupported", "method");
  refused(line(kFrame, kFrame, R"("method":"fast")"), "bad_value", "method");
  refused(R"({"id":1,"query":"polygon_depth","p":{"outer":[[0,0],[1,0],[0,1]]}})", "missing_field", "q");
  refused(line(R"({"outer":[[0,0]]})", kUnitSquare, ""), "too_few_points", "p.outer");
  refused(line(kUnitSquare, R"({"outer":[[0,0]],"margin":-1})", ""), "bad_value", "q.margin");
  refused(line(R"({"outer":[[0,0],[1,0],[0,1]],"margin":1})", kUnitSquare, R"("slots":true)"), "unsupported", "slots");
}

}  // namespace
}  // namespace pd::test

/// @file
/// The query time_of_impact, through the protocol.
#include <cmath>

#include "protocol_lines.hpp"

namespace pd::test {
namespace {

constexpr const char* kBall = R"({"type":"sphere","radius":0.5})";

std::string line(const std::string& a, const std::string& b, const std::string& more) {
  return R"({"id":7,"query":"time_of_impact","a":)" + a + R"(,"b":)" + b + "," + more + "}";
}

TEST(TimeOfImpactQuery, BallsHeadOn) {
  const Json reply = answer(line(kBall, kBall, R"("pose_a":{"translation":[3,0,0]},"velocity_a":[-4,0,0],
      "angular_velocity_a":[1,2,3],"velocity_b":[1,0,0],"duration":1,"tolerance":1e-6)"));
  EXPECT_EQ(reply.at("id"), 7);
  EXPECT_TRUE(reply.at("hit").get<bool>());
  const double time = reply.at("time").get<double>();
  EXPECT_LE(time, 0.4);
  EXPECT_GT(time, 0.4 - 1e-6 / 5);
  EXPECT_LE(reply.at("certified").get<double>(), 0.4);
  EXPECT_EQ(reply.at("class"), "separated");
  EXPECT_LE(reply.at("distance").get<double>(), 1e-6);
  EXPECT_NEAR(reply.at("normal")[0].get<double>(), 1, 1e-15);
  EXPECT_NEAR(reply.at("witness_a")[0].get<double>(), 3 - 4 * time - 0.5, 1e-12);
  EXPECT_EQ(reply.at("stats").at("nanoseconds").get<std::int64_t>() > 0, true);
  EXPECT_FALSE(reply.contains("bracket_reached"));
}

TEST(TimeOfImpactQuery, AGapWithinTheToleranceIsWhatWasAsked) {
  const char* const ellipsoid = R"({"type":"ellipsoid","radii":[0.7,0.8,1.3]})";
  const std::string cone = R"({"type":"cone","radius":0.7,"half_height":0.5,"axis":"y"})";
  const std::string two = R"({"type":"compound","parts":[{"shape":)" + cone + R"(},{"shape":)" + cone + "}]}";
  for (const std::string& other : {cone, two}) {
    const Json reply = answer(line(ellipsoid, other, R"("pose_a":{"translation":[4,1,0.3],
        "quaternion_wxyz":[0.36,0.48,0.64,0.48]},"velocity_a":[-3,-0.5,0],"angular_velocity_a":[1,2,3],"duration":3)"));
    EXPECT_TRUE(reply.at("hit").get<bool>());
    EXPECT_LE(reply.at("distance").get<double>(), 1e-8);
    EXPECT_FALSE(reply.contains("bracket_reached"));
  }
}

TEST(TimeOfImpactQuery, WithoutAHitTheDepthFieldsAreOfTheEnd) {
  const Json reply =
      answer(line(kBall, kBall, R"("pose_a":{"translation":[3,0,0]},"velocity_a":[1,0,0],"duration":2)"));
  EXPECT_FALSE(reply.at("hit").get<bool>());
  EXPECT_EQ(reply.at("time"), 2.0);
  EXPECT_EQ(reply.at("certified"), 2.0);
  EXPECT_EQ(reply.at("distance"), 4.0);
}

TEST(TimeOfImpactQuery, NotApartAtTheStart) {
  const Json inside = answer(line(kBall, kBall, R"("pose_a":{"translation":[0.75,0,0]},"duration":2)"));
  EXPECT_TRUE(inside.at("hit").get<bool>());
  EXPECT_EQ(inside.at("time"), 0.0);
  EXPECT_EQ(inside.at("certified"), 0.0);
  EXPECT_EQ(inside.at("class"), "overlapping");
  EXPECT_EQ(inside.at("depth"), 0.25);
  const Json touching = answer(line(kUnitBox, kUnitBox, R"("pose_a":{"translation":[2,0,0]},"duration":0)"));
  EXPECT_TRUE(touching.at("hit").get<bool>());
  EXPECT_EQ(touching.at("class"), "touching");
}

TEST(TimeOfImpactQuery, TheDefaultToleranceFollowsTheBodies) {
  for (const double size : {1e-6, 1.0, 1e6}) {
    const auto ball = [&] { return R"({"type":"sphere","radius":)" + std::to_string(size) + "}"; };
    const Json reply = answer(line(ball(), ball(),
                                   R"("pose_a":{"translation":[)" + std::to_string(5 * size) +
                                       R"(,0,0]},"velocity_a":[)" + std::to_string(-size) + R"(,0,0],"duration":9)"));
    ASSERT_TRUE(reply.at("hit").get<bool>()) << size;
    EXPECT_NEAR(reply.at("time").get<double>(), 3, 1e-8) << size;
    EXPECT_LE(reply.at("distance").get<double>(), 2e-9 * size) << size;
  }
}

TEST(TimeOfImpactQuery, PartsOfACompoundTurnAboutItsOrigin) {
  // A hammer: its head, half a metre of box four metres out, swings down onto a table at a right angle.
  const std::string hammer =
      R"({"type":"compound","parts":[{"shape":{"type":"box","half_extents":[2,0.1,0.1]},"pose":{"translation":[2,0,0]}},
          {"shape":{"type":"sphere","radius":0.5},"pose":{"translation":[4,0,0]}}]})";
  const Json reply = answer(line(hammer, kUnitBox, R"("pose_b":{"translation":[0,-4,0]},"angular_velocity_a":[0,0,-1],
      "velocity_b":[0,0,0],"duration":2)"));
  // The ball's centre at 4 (cos t, -sin t): it meets the box's corner (1, -3) or its face x = 1 below y = -3.
  EXPECT_TRUE(reply.at("hit").get<bool>());
  const double time = reply.at("time").get<double>();
  const double x = 4 * std::cos(time) - 1;
  const double y = -4 * std::sin(time) + 3;
  EXPECT_NEAR(y > 0 ? std::hypot(x, y) : x, 0.5, 1e-7);
  EXPECT_EQ(reply.at("feature").is_null() || reply.at("feature").at("part_a") == 1, true);
  EXPECT_LE(reply.at("certified").get<double>(), time);
  const Json missed = answer(line(hammer, kUnitBox, R"("pose_b":{"translation":[0,-4,0]},"duration":2)"));
  EXPECT_FALSE(missed.at("hit").get<bool>());
  EXPECT_EQ(missed.at("class"), "separated");
}

TEST(TimeOfImpactQuery, Refusals) {
  EXPECT_EQ(code_of(answer(line(kBall, kBall, R"("velocity_a":[1,0,0])"))), "missing_field");
  const Json negative = answer(line(kBall, kBall, R"("duration":-1)"));
  EXPECT_EQ(code_of(negative), "bad_value");
  EXPECT_EQ(where_of(negative), "duration");
  EXPECT_EQ(code_of(answer(line(kBall, kBall, R"("duration":"inf")"))), "non_finite");
  EXPECT_EQ(where_of(answer(line(kBall, kBall, R"("duration":1,"tolerance":0)"))), "tolerance");
  EXPECT_EQ(where_of(answer(line(kBall, kBall, R"("duration":1,"velocity_b":[1,2])"))), "velocity_b");
  EXPECT_EQ(code_of(answer(line(kBall, kBall, R"("duration":1,"velocity_b":[1,"nan",0])"))), "non_finite");
  EXPECT_EQ(code_of(answer(line(kBall, kBall, R"("duration":1,"velocity":[1,0,0])"))), "bad_value");
  EXPECT_EQ(code_of(answer(line(kBall, kBall, R"("duration":1,"velocity_a":[1e200,0,0])"))), "out_of_range");
  EXPECT_EQ(code_of(answer(line(kBall, kBall, R"("duration":1e200,"velocity_a":[1e149,0,0])"))), "out_of_range");
  EXPECT_EQ(code_of(answer(line(kBall, kBall, R"("duration":1,"angular_velocity_a":[1e7,0,0])"))), "out_of_range");
}

}  // namespace
}  // namespace pd::test

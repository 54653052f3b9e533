/// @file
/// Queries answered by rays: methods grid and shallow, metrics, approximate widths, hierarchies; and what refuses them.
#include <cmath>

#include "protocol_lines.hpp"

namespace pd::test {
namespace {

constexpr const char* kOctahedron = R"({"vertices":[[1,0,0],[-1,0,0],[0,1,0],[0,-1,0],[0,0,1],[0,0,-1]]})";
const std::string kAside = R"("pose_a":{"translation":[0.5,0,0]})";

TEST(GridAnswers, GridKeepsDelta) {
  for (const double delta : {1.0, 0.01, 1e-6}) {
    const Json reply =
        answer(depth_line(kUnitBox, kUnitBox, kAside + R"(,"method":"grid","delta":)" + std::to_string(delta)));
    EXPECT_EQ(reply.at("class"), "overlapping");
    EXPECT_EQ(reply.at("method"), "grid");
    EXPECT_LE(reply.at("lower").get<double>(), 1.5);
    EXPECT_GE(reply.at("upper").get<double>(), 1.5);
    EXPECT_LE(reply.at("upper").get<double>(), (1 + delta) * reply.at("lower").get<double>() * (1 + 1e-12));
  }
  const Json smooth = answer(depth_line(R"({"type":"cylinder","radius":1,"half_height":2,"axis":"z"})", kUnitBox,
                                        R"("method":"grid","delta":0.01)"));
  EXPECT_NEAR(smooth.at("depth").get<double>(), 2, 0.03);
}

TEST(GridAnswers, ShallowIsExact) {
  const Json reply = answer(depth_line(kUnitBox, kUnitBox, kAside + R"(,"method":"shallow","delta":0.5)"));
  EXPECT_EQ(reply.at("method"), "shallow");
  EXPECT_EQ(reply.at("depth"), 1.5);
  EXPECT_EQ(reply.at("lower"), 1.5);
  EXPECT_EQ(reply.at("upper"), 1.5);
  EXPECT_EQ(code_of(answer(depth_line(R"({"type":"cone","radius":1,"half_height":2,"axis":"z"})", kUnitBox,
                                      R"("method":"shallow")"))),
            "unsupported");
}

TEST(GridAnswers, Metric) {
  for (const char* method : {R"(,"method":"metric")", R"(,"method":"auto")", ""}) {
    const Json reply =
        answer(depth_line(kUnitBox, kUnitBox, kAside + R"(,"metric":)" + std::string(kOctahedron) + method));
    EXPECT_EQ(reply.at("method"), "metric");
    EXPECT_EQ(reply.at("depth"), 1.5);
    EXPECT_EQ(reply.at("translation"), Json({1.5, 0.0, 0.0}));
  }
  const auto code = [](const std::string& more) { return code_of(answer(depth_line(kUnitBox, kUnitBox, more))); };
  EXPECT_EQ(code(R"("metric":{"vertices":[[1,1,1],[2,1,1],[1,2,1],[1,1,2]]})"), "bad_value");
  EXPECT_EQ(code(R"("metric":{"vertices":[[1,0,0],[0,1,0],[-1,-1,0]]})"), "not_full_dimensional");
  EXPECT_EQ(code(R"("metric":{"vertices":[]})"), "too_few_points");
  EXPECT_EQ(code(R"("metric":{})"), "missing_field");
  EXPECT_EQ(code(R"("metric":[])"), "bad_value");
  EXPECT_EQ(code(R"("metric":)" + std::string(kOctahedron) + R"(,"method":"overlay")"), "bad_value");
  const Json outside =
      answer(depth_line(kUnitBox, kUnitBox, R"("metric":{"vertices":[[1,1,1],[2,1,1],[1,2,1],[1,1,2]]})"));
  EXPECT_EQ(where_of(outside), "metric");
}

TEST(GridAnswers, Width) {
  const Json reply =
      answer(R"({"id":1,"query":"width","a":{"type":"box","half_extents":[3,1,2]},"method":"grid","delta":0.1})");
  EXPECT_LE(reply.at("lower").get<double>(), 2);
  EXPECT_GE(reply.at("upper").get<double>(), 2);
  EXPECT_LE(reply.at("upper").get<double>(), 1.1 * reply.at("lower").get<double>() * (1 + 1e-12));
}

/// No frame makes a needle round that is seen from its end; rays along the whole sphere find that end at once.
TEST(GridAnswers, ANeedleIsSeenFromItsEnd) {
  for (const char* far : {"1e6", "1e12", "18446744073709551616", "1e100"}) {
    const std::string needle =
        R"({"type":"convex","vertices":[[0,0,0],[1,0,0],[)" + std::string(far) + R"(,1,0],[0,0,1]]})";
    const Json reply =
        answer(depth_line(kUnitBox, needle, R"("pose_b":{"translation":[0.3,0.2,0.1]},"method":"grid","delta":0.1)"));
    EXPECT_FALSE(reply.contains("bracket_reached")) << far << " " << reply;
    EXPECT_LE(reply.at("upper").get<double>(), 1.1 * reply.at("lower").get<double>() * (1 + 1e-12)) << far;
    EXPECT_LT(reply.at("stats").at("facets_visited").get<int>(), 1200) << far;
  }
}

/// Signs that need big numbers are counted: the search ends, and says that it did.
TEST(GridAnswers, SliversBeyondAnyFrameEndByTheirBudget) {
  for (const char* vertices : {"[[0,0,0],[1,0,0],[0,1,0],[0,0,5e-324]]", "[[0,0,0],[1,0,0],[0,1,0],[0,0,1e-300]]",
                               "[[0,0,0],[1,0,0],[0,1,9223372036854775808],[0,0,1]]"}) {
    const Json reply =
        answer(R"({"id":1,"query":"width","method":"grid","delta":0.1,"a":{"type":"convex","vertices":)" +
               std::string(vertices) + "}}");
    EXPECT_EQ(reply.value("bracket_reached", true), false) << vertices;
    EXPECT_GE(reply.at("upper").get<double>(), reply.at("lower").get<double>());
    EXPECT_LT(reply.at("stats").at("exact_signs").get<int>(), 60'000) << vertices;
  }
}

TEST(GridAnswers, Hierarchy) {
  for (const char* kind : {R"(,"kind":"inner")", R"(,"kind":"outer")", ""}) {
    const Json reply = answer(R"({"id":1,"query":"hierarchy","a":)" + std::string(kUnitBox) + kind + "}");
    const Json& levels = reply.at("levels");
    EXPECT_EQ(levels[0].at("vertices"), 8);
    EXPECT_EQ(levels[0].at("facets"), 6);
    EXPECT_EQ(levels.back().at("max_degree"), 0);
  }
  EXPECT_EQ(code_of(answer(R"({"id":1,"query":"hierarchy","a":{"type":"sphere","radius":1}})")), "unsupported");
  EXPECT_EQ(
      code_of(answer(R"({"id":1,"query":"hierarchy","a":{"type":"convex","vertices":[[0,0,0],[1,0,0],[0,1,0]]}})")),
      "not_full_dimensional");
  EXPECT_EQ(code_of(answer(R"({"id":1,"query":"hierarchy","a":)" + std::string(kUnitBox) + R"(,"kind":"middle"})")),
            "bad_value");
}

TEST(GridAnswers, IntersectGivesAStrictDirection) {
  const Json apart = answer(R"({"id":1,"query":"intersect","a":)" + std::string(kUnitBox) + R"(,"b":)" + kUnitBox +
                            R"(,"pose_b":{"translation":[2.0000000000000004,0.5,0]}})");
  EXPECT_EQ(apart.at("class"), "separated");
  EXPECT_EQ(apart.at("separating_direction"), Json({1.0, 0.0, 0.0}));
  const Json touching = answer(R"({"id":1,"query":"intersect","a":)" + std::string(kUnitBox) + R"(,"b":)" + kUnitBox +
                               R"(,"pose_b":{"translation":[2,0.5,0]}})");
  EXPECT_EQ(touching.at("class"), "touching");
  EXPECT_FALSE(touching.contains("separating_direction"));
}

TEST(GridAnswers, DirectionalDepthOfSmoothBodies) {
  const Json reply = answer(R"({"id":1,"query":"directional_depth","a":{"type":"sphere","radius":1},"b":)" +
                            std::string(kUnitBox) + R"(,"direction":[0,3,0]})");
  EXPECT_NEAR(reply.at("depth").get<double>(), 2, 1e-11);
}

}  // namespace
}  // namespace pd::test

/// @file
/// Every method on every pair of kinds of shape, by the line protocol: an answer that agrees with "auto", or the
/// refusal that the table of methods names; never anything else.
#include <array>
#include <string>

#include "protocol_lines.hpp"

namespace pd::test {
namespace {

struct Kind {
  const char* name;
  const char* text;
  bool polytope;  ///< a polytope, with or without a margin
};
constexpr std::array kKinds = {
    Kind{"box", R"({"type":"box","half_extents":[1,0.8,0.6]})", true},
    Kind{"convex", R"({"type":"convex","vertices":[[1,0,0],[-1,0,0],[0,1,0],[0,-1,0],[0,0,1],[0,0,-1]]})", true},
    Kind{"rounded box", R"({"type":"box","half_extents":[0.9,0.7,0.5],"margin":0.1})", true},
    Kind{"sphere", R"({"type":"sphere","radius":1})", true},
    Kind{"capsule", R"({"type":"capsule","radius":0.5,"half_height":0.5,"axis":"z"})", true},
    Kind{"capsule without a height", R"({"type":"capsule","radius":0.5,"half_height":0,"axis":"z"})", true},
    Kind{"ellipsoid", R"({"type":"ellipsoid","radii":[1,0.8,0.6]})", false},
    Kind{"cylinder", R"({"type":"cylinder","radius":0.6,"half_height":0.8,"axis":"z"})", false},
    Kind{"cone", R"({"type":"cone","radius":0.8,"half_height":0.9,"axis":"z"})", false},
    Kind{"sphere hull", R"({"type":"sphere_hull","spheres":[[0,0,-0.4,0.7],[0.5,0,0.5,0.3],[-0.3,0.4,0.6,0.1]]})",
         false},
};
struct MethodOfTable {
  const char* name;
  bool polytopes_only;
};
constexpr std::array kMethods = {
    MethodOfTable{"auto", false},         MethodOfTable{"expansion", false}, MethodOfTable{"overlay", true},
    MethodOfTable{"decomposition", true}, MethodOfTable{"shallow", true},    MethodOfTable{"grid", false},
};
constexpr double kDelta = 0.05;  // of the engines that are approximate

Json ask(const Kind& a, const Kind& b, const std::string& method, const std::string& pose_b) {
  return answer(
      depth_line(a.text, b.text, pose_b + R"(,"method":")" + method + R"(","delta":)" + std::to_string(kDelta)));
}

class EveryMethod : public ::testing::TestWithParam<MethodOfTable> {};

TEST_P(EveryMethod, AnswersOrRefusesAsTheTableSays) {
  const MethodOfTable method = GetParam();
  for (const char* const pose : {R"("pose_b":{"quaternion_wxyz":[0.8,0.4,0.4,0.2],"translation":[0.3,0.2,0.9]})",
                                 R"("pose_b":{"translation":[5,0.5,0.25]})"}) {
    for (const Kind& a : kKinds) {
      for (const Kind& b : kKinds) {
        SCOPED_TRACE(std::string(method.name) + ": " + a.name + ", " + b.name + ", " + pose);
        const Json reply = ask(a, b, method.name, pose);
        if (method.polytopes_only && !(a.polytope && b.polytope)) {
          EXPECT_EQ(code_of(reply), "unsupported");
          EXPECT_EQ(where_of(reply), "method");
          continue;
        }
        ASSERT_EQ(code_of(reply), "") << reply;
        const Json expected = ask(a, b, "auto", pose);
        EXPECT_EQ(reply.at("class"), expected.at("class"));
        // Both brackets hold the depth (the distance), so that they meet; a hair for rounding.
        EXPECT_LE(reply.at("lower").get<double>(), expected.at("upper").get<double>() + 1e-12);
        EXPECT_GE(reply.at("upper").get<double>(), expected.at("lower").get<double>() - 1e-12);
        EXPECT_NEAR(reply.at("distance").get<double>(), expected.at("distance").get<double>(),
                    kDelta * expected.at("distance").get<double>());
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, EveryMethod, ::testing::ValuesIn(kMethods),
                         [](const auto& tested) { return std::string(tested.param.name); });

}  // namespace
}  // namespace pd::test

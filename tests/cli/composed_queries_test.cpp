// Queries about several bodies of any dimension through the line protocol.

#include <cmath>

#include "cli/protocol_lines.hpp"

namespace pd::test {
namespace {

std::string square(double x, double y) {
  const auto corner = [&](double i, double j) {
    return "[" + std::to_string(x + i) + "," + std::to_string(y + j) + "]";
  };
  return R"({"points":[)" + corner(0, 0) + "," + corner(1, 0) + "," + corner(1, 1) + "," + corner(0, 1) + "]}";
}

Json ask(const std::string& query, const std::string& fields) {
  return answer(R"({"id":1,"query":")" + query + "\"," + fields + "}");
}

TEST(ComposedQueries, Intersections) {
  for (const char* backend : {"kernel", "exact", "macbeath"}) {
    const std::string rest = R"("epsilon":0.02,"backend":")" + std::string(backend) + "\"";
    const auto meets = [&](const std::string& a, const std::string& b) {
      const Json r = ask("approx_intersect", R"("a":)" + a + R"(,"b":)" + b + "," + rest);
      EXPECT_EQ(code_of(r), "") << r;
      return r.contains("intersect") && r["intersect"].get<bool>();
    };
    EXPECT_TRUE(meets(square(0, 0), square(0.99, 0.5)));
    EXPECT_FALSE(meets(square(0, 0), square(1.03, 0.5)));
    EXPECT_TRUE(meets(square(0, 0), R"({"halfspaces":[[-1,0,-0.9],[1,0,3],[0,1,1],[0,-1,0]]})"));
    EXPECT_FALSE(meets(square(0, 0), R"({"halfspaces":[[-1,0,-1.1],[1,0,3],[0,1,1],[0,-1,0]]})"));
    // A common point of all three, or of each two only.
    EXPECT_TRUE(meets(square(0, 0), "[" + square(0.9, 0) + "," + square(0.4, 0.9) + "]"));
    EXPECT_FALSE(meets(square(0, 0), "[" + square(0.9, 0) + "," + square(-0.9, 0) + "]"));
    EXPECT_TRUE(meets(R"({"sum_of":[)" + square(0, 0) + "," + square(0, 0) + "]}", square(1.95, 1.95)));
    EXPECT_TRUE(meets(R"({"hull_of":[)" + square(0, 0) + "," + square(5, 0) + "]}", square(2.5, 0.98)));
    EXPECT_FALSE(meets(R"({"hull_of":[)" + square(0, 0) + "," + square(5, 0) + "]}", square(2.5, 1.1)));
    EXPECT_FALSE(meets(R"({"intersection_of":[)" + square(0, 0) + "," + square(0.5, 0) + "]}", square(1.2, 0)));
  }
}

TEST(ComposedQueries, MinkowskiSums) {
  for (const char* side : {"inner", "outer"}) {
    const std::string fields = R"("a":)" + square(0, 0) + R"(,"b":[)" + square(1, 1) + "," + square(0, 0) +
                               R"(],"epsilon":0.01,"side":")" + side + R"(","representation":)";
    const Json points = ask("approx_minkowski_sum", fields + "\"points\"");
    ASSERT_EQ(code_of(points), "") << points;
    ASSERT_EQ(points["points"].size(), 4u);
    for (const Json& p : points["points"]) {
      EXPECT_NEAR(std::abs(p[0].get<double>() - 2.5), 1.5, 0.02);
      EXPECT_NEAR(std::abs(p[1].get<double>() - 2.5), 1.5, 0.02);
    }
    const Json planes = ask("approx_minkowski_sum", fields + "\"halfspaces\"");
    ASSERT_EQ(code_of(planes), "") << planes;
    EXPECT_EQ(planes["halfspaces"].size(), 4u);
  }
  const Json hull =
      ask("approx_minkowski_sum", R"("a":{"hull_of":[)" + square(0, 0) + "," + square(4, 0) + R"(]},"b":)" +
                                      square(0, 0) + R"(,"epsilon":0.05,"representation":"halfspaces")");
  ASSERT_EQ(code_of(hull), "") << hull;
  EXPECT_EQ(hull["halfspaces"].size(), 4u);
}

TEST(ComposedQueries, SumsWithAnIntersectionInside) {
  // [.5, 1] x [.25, 1] and a square.
  const Json sum =
      ask("approx_minkowski_sum", R"("a":{"intersection_of":[)" + square(0, 0) + "," + square(0.5, 0.25) +
                                      R"(]},"b":)" + square(0, 0) + R"(,"epsilon":0.01,"representation":"points")");
  ASSERT_EQ(code_of(sum), "") << sum;
  ASSERT_EQ(sum["points"].size(), 4u);
  for (const Json& p : sum["points"]) {
    EXPECT_NEAR(std::abs(p[0].get<double>() - 1.25), 0.75, 0.005);
    EXPECT_NEAR(std::abs(p[1].get<double>() - 1.125), 0.875, 0.005);
  }
}

TEST(ComposedQueries, Membership) {
  const Json r = ask("approx_membership", R"("a":{"intersection_of":[)" + square(0, 0) + "," + square(0.5, 0.5) +
                                              R"(]},"epsilon":0.01,"points":[[0.75,0.75],[0.25,0.25],[1,1],[1.1,1]])");
  ASSERT_EQ(code_of(r), "") << r;
  EXPECT_EQ(r["inside"], Json::parse("[true,false,true,false]"));
}

TEST(ComposedQueries, RefusalsByName) {
  const std::string both = R"("a":)" + square(0, 0) + R"(,"b":)" + square(0, 0);
  const auto refused = [](const std::string& query, const std::string& fields, const std::string& code,
                          const std::string& where) {
    const Json r = ask(query, fields);
    EXPECT_EQ(code_of(r), code) << r;
    if (r.contains("error")) {
      EXPECT_EQ(r["error"]["where"], where) << r;
    }
  };
  refused("approx_intersect", both, "missing_field", "epsilon");
  refused("approx_intersect", both + R"(,"epsilon":1)", "bad_value", "epsilon");
  refused("approx_intersect", both + R"(,"epsilon":0.1,"backend":"magic")", "bad_value", "backend");
  refused("approx_intersect", R"("a":)" + square(0, 0) + R"(,"b":[],"epsilon":0.1)", "bad_value", "b");
  refused("approx_intersect", R"("a":)" + square(0, 0) + R"(,"b":{"sum_of":[]},"epsilon":0.1)", "bad_value",
          "b.sum_of");
  refused("approx_intersect",
          R"("a":)" + square(0, 0) + R"(,"b":{"points":[[0,0,0],[1,0,0],[0,1,0],[0,0,1]]},"epsilon":0.1)", "bad_value",
          "b");
  refused("approx_membership", R"("a":)" + square(0, 0) + R"(,"epsilon":0.1,"points":[[0,0,0]])", "bad_value",
          "points[0]");
  const auto sum = [](double x) {
    return R"("a":{"intersection_of":[)" + square(0, 0) + "," + square(x, 0) + R"(]},"b":)" + square(0, 0) +
           R"(,"epsilon":0.1,"representation":"points")";
  };
  refused("approx_minkowski_sum", sum(1.5), "bad_value", "");
  refused("approx_minkowski_sum", sum(1), "bad_value", "epsilon");
}

}  // namespace
}  // namespace pd::test

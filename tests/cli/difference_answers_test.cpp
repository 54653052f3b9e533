/// @file
/// Queries about the difference, the width and the manifold, against cases done by hand.
#include <cmath>
#include <map>

#include "protocol_lines.hpp"

namespace pd::test {
namespace {

std::string line(const std::string& query, const std::string& a, const std::string& b, const std::string& more) {
  return R"({"id":1,"query":")" + query + R"(","a":)" + a + R"(,"b":)" + b + (more.empty() ? "" : "," + more) + "}";
}

TEST(SupportOfDifference, ValuesAndVertices) {
  const Json reply =
      answer(line("support_of_difference", kUnitBox, R"({"type":"box","half_extents":[2,2,2]})",
                  R"("pose_b":{"translation":[10,0,0]},"directions":[[1,2,3],[-2,-2,-2],[0.5,0.5,-0.5]])"));
  // h_P(d) = max over B - min over A.
  EXPECT_EQ(reply.at("values"), Json({28.0, -2.0, 9.5}));
  EXPECT_EQ(reply.at("vertices_a"), Json({0, 7, 4}));
  EXPECT_EQ(reply.at("vertices_b"), Json({7, 0, 3}));
}

TEST(SupportOfDifference, SmoothBodiesHaveNoVertex) {
  const Json reply = answer(
      line("support_of_difference", R"({"type":"ellipsoid","radii":[1,2,3]})", kUnitBox, R"("directions":[[0,0,2]])"));
  EXPECT_NEAR(reply.at("values")[0].get<double>(), 8, 1e-14);
  EXPECT_TRUE(reply.at("vertices_a")[0].is_null());
}

TEST(SupportOfDifference, Refusals) {
  const Json zero = answer(line("support_of_difference", kUnitBox, kUnitBox, R"("directions":[[1,0,0],[0,0,0]])"));
  EXPECT_EQ(code_of(zero), "zero_direction");
  EXPECT_EQ(where_of(zero), "directions[1]");
  const Json infinite = answer(line("support_of_difference", kUnitBox, kUnitBox, R"("directions":[["inf",0,0]])"));
  EXPECT_EQ(code_of(infinite), "non_finite");
  EXPECT_EQ(where_of(infinite), "directions[0]");
  EXPECT_EQ(code_of(answer(line("support_of_difference", kUnitBox, kUnitBox, ""))), "missing_field");
  EXPECT_TRUE(answer(line("support_of_difference", kUnitBox, kUnitBox, R"("directions":[])")).at("values").empty());
}

TEST(PointInDifference, ClassesAreExact) {
  // P = B - A = [8, 12] x [-2, 2]^2.
  const Json reply = answer(line("point_in_difference", kUnitBox, kUnitBox,
                                 R"("pose_b":{"translation":[10,0,0]},"points":[[10,0,0],[12,0,0],[12,2,2],
                                    [12.000000000000002,0,0],[0,0,0],[8.000000000000002,1.9999999999999998,0]])"));
  EXPECT_EQ(reply.at("classes"),
            Json({"overlapping", "touching", "touching", "separated", "separated", "overlapping"}));
}

TEST(DirectionalDepth, DiagonalOfTwoCubes) {
  for (const char* method : {R"("method":"portal",)", R"("method":"overlay",)", R"("method":"hierarchy",)", ""}) {
    const Json reply =
        answer(line("directional_depth", kUnitBox, kUnitBox, std::string(method) + R"("direction":[3,3,0])"));
    EXPECT_NEAR(reply.at("depth").get<double>(), 2 * std::sqrt(2.0), 1e-15);
    EXPECT_TRUE(reply.at("stats").is_object());
  }
  const Json apart =
      answer(line("directional_depth", kUnitBox, kUnitBox, R"("pose_b":{"translation":[5,0,0]},"direction":[1,0,0])"));
  EXPECT_EQ(apart.at("depth"), 0.0);
}

TEST(DirectionalDepth, Refusals) {
  const Json zero = answer(line("directional_depth", kUnitBox, kUnitBox, R"("direction":[0,0,0])"));
  EXPECT_EQ(code_of(zero), "zero_direction");
  EXPECT_EQ(where_of(zero), "direction");
  EXPECT_EQ(code_of(answer(line("directional_depth", kUnitBox, kUnitBox, R"("direction":[0,0])"))), "bad_value");
  EXPECT_EQ(code_of(answer(line("directional_depth", kUnitBox, kUnitBox, ""))), "missing_field");
  EXPECT_EQ(code_of(answer(line("directional_depth", kUnitBox, kUnitBox, R"("direction":[1,0,0],"method":"magic")"))),
            "bad_value");
  for (const char* method : {"hierarchy", "overlay"}) {
    EXPECT_EQ(code_of(answer(line("directional_depth", R"({"type":"sphere","radius":1})", kUnitBox,
                                  R"("direction":[1,0,0],"method":")" + std::string(method) + "\""))),
              "unsupported");
  }
}

TEST(Width, BoxAndSphere) {
  const Json box = answer(R"({"id":1,"query":"width","a":{"type":"box","half_extents":[1,0.5,3]}})");
  EXPECT_EQ(box.at("width"), 1.0);
  EXPECT_EQ(std::abs(box.at("normal")[1].get<double>()), 1.0);
  const Json swept = answer(R"({"id":1,"query":"width","a":{"type":"box","half_extents":[1,0.5,3],"margin":0.25}})");
  EXPECT_EQ(swept.at("width"), 1.5);
  EXPECT_EQ(answer(R"({"id":1,"query":"width","a":{"type":"sphere","radius":2}})").at("width"), 4.0);
  const Json flat = answer(R"({"id":1,"query":"width","a":{"type":"convex","vertices":[[0,0,0],[1,0,0],[0,1,0]]}})");
  EXPECT_EQ(flat.at("width"), 0.0);
  EXPECT_EQ(code_of(answer(R"({"id":1,"query":"width","a":{"type":"sphere","radius":2},"method":"shallow"})")),
            "unsupported");
  EXPECT_EQ(code_of(answer(R"({"id":1,"query":"width","a":{"type":"sphere","radius":2},"b":1})")), "bad_value");
}

TEST(MinkowskiDifference, TwoCubesAreACube) {
  const Json reply = answer(line("minkowski_difference", kUnitBox, kUnitBox, R"("pose_b":{"translation":[10,0,0]})"));
  EXPECT_EQ(reply.at("vertices").size(), 8u);
  EXPECT_EQ(reply.at("K"), 6);
  EXPECT_EQ(reply.at("facet_kinds"), Json(std::vector<std::string>(6, "facet-facet")));
  for (const Json& facet : reply.at("facets")) EXPECT_EQ(facet.size(), 4u);
}

TEST(MinkowskiDifference, IsAClosedSurfaceThatFacesOutwards) {
  const Json reply =
      answer(line("minkowski_difference", kUnitBox,
                  R"({"type":"convex","vertices":[[0.1,0.2,1.5],[1.5,0.3,-0.4],[-1.2,0.9,-0.3],[-0.2,-1.4,-0.6]]})",
                  R"("pose_a":{"quaternion_wxyz":[0.8,0.6,0,0]})"));
  const Json& vertices = reply.at("vertices");
  const auto coordinate = [&](int v, int k) {
    return vertices[static_cast<std::size_t>(v)][static_cast<std::size_t>(k)].get<double>();
  };
  std::map<std::pair<int, int>, int> directed;
  double volume = 0;
  for (const Json& facet : reply.at("facets")) {
    const auto loop = facet.get<std::vector<int>>();
    for (std::size_t i = 0; i < loop.size(); ++i) ++directed[{loop[i], loop[(i + 1) % loop.size()]}];
    for (std::size_t i = 1; i + 1 < loop.size(); ++i) {
      const int p = loop[0];
      const int q = loop[i];
      const int r = loop[i + 1];
      volume += coordinate(p, 0) * (coordinate(q, 1) * coordinate(r, 2) - coordinate(q, 2) * coordinate(r, 1)) +
                coordinate(p, 1) * (coordinate(q, 2) * coordinate(r, 0) - coordinate(q, 0) * coordinate(r, 2)) +
                coordinate(p, 2) * (coordinate(q, 0) * coordinate(r, 1) - coordinate(q, 1) * coordinate(r, 0));
    }
  }
  EXPECT_GT(volume, 6 * 8.0) << "larger than the cube alone, so outward";
  for (const auto& [edge, count] : directed) {
    EXPECT_EQ(count, 1);
    EXPECT_EQ(directed.count({edge.second, edge.first}), 1u);
  }
  EXPECT_EQ(reply.at("facet_kinds").size(), reply.at("facets").size());
  EXPECT_EQ(reply.at("K"), reply.at("facets").size());
}

TEST(MinkowskiDifference, SizeIsBounded) {
  query::Limits limits;
  limits.max_vertices = 8;
  const Json reply =
      answer(line("minkowski_difference", kUnitBox, kUnitBox, R"("pose_a":{"quaternion_wxyz":[0.48,0.36,0.64,0.48]})"),
             limits);
  EXPECT_EQ(code_of(reply), "limit_exceeded");
  EXPECT_EQ(code_of(answer(line("minkowski_difference", R"({"type":"sphere","radius":1})", kUnitBox, ""))),
            "unsupported");
}

TEST(ContactManifold, FaceOnFace) {
  const std::string table = R"({"type":"box","half_extents":[2,2,1]})";
  const Json inside = answer(line("contact_manifold", kUnitBox, table, R"("pose_a":{"translation":[0,0,1.875]})"));
  ASSERT_EQ(inside.at("points").size(), 4u);
  EXPECT_EQ(inside.at("normal")[2], 1.0) << "from B to A";
  for (const Json& point : inside.at("points")) EXPECT_EQ(point.at("depth"), 0.125);
  const std::string gap = R"("pose_a":{"translation":[0,0,2.125]})";
  EXPECT_TRUE(answer(line("contact_manifold", kUnitBox, table, gap)).at("points").empty());
  const Json speculative = answer(line("contact_manifold", kUnitBox, table, gap + R"(,"breaking_threshold":0.25)"));
  ASSERT_EQ(speculative.at("points").size(), 4u);
  for (const Json& point : speculative.at("points")) EXPECT_EQ(point.at("depth"), -0.125);
  EXPECT_EQ(code_of(answer(line("contact_manifold", kUnitBox, table, R"("breaking_threshold":-1)"))), "bad_value");
}

}  // namespace
}  // namespace pd::test

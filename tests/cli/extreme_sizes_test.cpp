/// @file
/// The law of powers of two through every query of the protocol: bodies times 2^k have the answers of size 1 times 2^k,
/// up to the rounding of what is subnormal. Polytopes down to the least doubles, curved bodies in 2^-900..2^895.
#include <cmath>
#include <string>
#include <vector>

#include "protocol_lines.hpp"

namespace pd::test {
namespace {

/// Whole numbers times 2^k, everywhere in a shape or a list but in the numbers of faces.
Json scaled(const Json& value, int exponent) {
  Json result = value;
  if (value.is_number()) return std::ldexp(value.get<double>(), exponent);
  if (value.is_structured()) {
    for (auto& element : result) element = scaled(element, exponent);
  }
  return result;
}

struct Query {
  std::string name;
  Json more;               ///< fields that keep their size
  Json lengths = nullptr;  ///< fields that grow with the bodies
};

Json ask(const Query& query, const Json& a, const Json& b, const Json& translation, int exponent) {
  Json line = query.more.is_null() ? Json::object() : query.more;
  line["query"] = query.name;
  line["a"] = scaled(a, exponent);
  line["b"] = scaled(b, exponent);
  line["pose_b"] = {{"translation", scaled(translation, exponent)}};
  if (query.lengths.is_object()) line.update(scaled(query.lengths, exponent));
  return answer(line.dump());
}

/// Every number of size 1 in the bracket of what rounding to subnormal numbers leaves of it.
void expect_lengths(const Json& one, const Json& small, const char* lower, const char* upper, int exponent) {
  if (!one.contains(lower)) return;
  const double least = std::ldexp(one.at(lower).get<double>(), exponent);
  const double most = std::ldexp(one.at(upper).get<double>(), exponent);
  EXPECT_LE(small.at(lower).get<double>(), most);
  EXPECT_GE(small.at(upper).get<double>(), least);
  EXPECT_LE(small.at(upper).get<double>() - small.at(lower).get<double>(),
            std::max(most - least, 0.0) * 1.01 + 16 * 0x1p-1074 + 0x1p-40 * most);
}

void expect_power_of_two(const Query& query, const Json& a, const Json& b, const Json& translation, int exponent) {
  SCOPED_TRACE(query.name + " " + query.more.dump() + " of " + a.dump() + " and " + b.dump() + " at " +
               translation.dump() + " times 2^" + std::to_string(exponent));
  const Json one = ask(query, a, b, translation, 0);
  const Json other = ask(query, a, b, translation, exponent);
  ASSERT_EQ(code_of(other), code_of(one)) << other.dump().substr(0, 300);
  for (const char* field : {"class", "classes", "K", "K_edge_edge", "missing", "extra", "sign_violations"}) {
    EXPECT_EQ(other.value(field, Json()), one.value(field, Json())) << field;
  }
  expect_lengths(one, other, "lower", "upper", exponent);
  expect_lengths(one, other, "distance_lower", "distance_upper", exponent);
}

TEST(ExtremeSizes, SubnormalPolytopesInEveryQuery) {
  const Json tetrahedron = Json::parse(R"({"type":"convex","vertices":[[-8,-8,-8],[8,0,0],[0,8,0],[0,0,8]]})");
  const Json triangle = Json::parse(R"({"type":"convex","vertices":[[0,0,0],[8,0,0],[0,8,0]]})");
  const Json segment = Json::parse(R"({"type":"convex","vertices":[[2,2,-8],[2,2,8]]})");
  const Json box = Json::parse(R"({"type":"box","half_extents":[4,4,4]})");
  const Json two = {{"type", "compound"}, {"parts", {{{"shape", tetrahedron}}, {{"shape", box}}}}};
  const Json inside = {{"points", Json::parse("[[0,0,0],[4,4,4],[400,0,0],[1e6,1e6,1e6]]")}};
  const Json along = {{"direction", {1, 2, 3}}};
  const Json along_facets = {{"direction", {1, 2, 3}}, {"method", "overlay"}};
  const std::vector<Query> both = {{"depth", nullptr},
                                   {"distance", nullptr},
                                   {"intersect", nullptr},
                                   {"directional_depth", along},
                                   {"point_in_difference", nullptr, inside},
                                   {"support_of_difference", {{"directions", {{1, 2, 3}}}}},
                                   {"contact_manifold", nullptr},
                                   {"minkowski_difference", nullptr}};
  std::vector<Query> convex = both;
  for (const char* method : {"expansion", "overlay", "decomposition"}) {
    convex.push_back({"depth", {{"method", method}}});
  }
  for (const char* method : {"shallow", "grid"}) convex.push_back({"depth", {{"method", method}, {"delta", 0.25}}});
  convex.push_back({"directional_depth", along_facets});
  convex.push_back({"decomposition", {{"verify", true}}});
  convex.push_back({"depth",
                    {{"metric",
                      {{"vertices", Json::parse("[[1,0,0],[-1,0,0],[0,1,0],[0,-1,0],[0,0,1],"
                                                "[0,0,-1]]")}}}}});
  const std::vector<Json> bodies = {tetrahedron, triangle, segment, box};
  const Json nowhere = {0, 0, 0}, aside = {3, 1, 0}, away = {0, 0, 40};
  for (const int exponent : {-1060, -1030}) {
    for (const Json& translation : {nowhere, aside, away}) {
      for (const Json& a : bodies) {
        for (const Json& b : bodies) {
          for (const Query& query : convex) expect_power_of_two(query, a, b, translation, exponent);
        }
        for (const Query& query : both) expect_power_of_two(query, two, a, translation, exponent);
      }
    }
  }
}

TEST(ExtremeSizes, CurvedBodiesInEveryQuery) {
  const std::vector<Json> bodies = {Json::parse(R"({"type":"ellipsoid","radii":[1,2,3]})"),
                                    Json::parse(R"({"type":"cylinder","radius":1,"half_height":2,"axis":"z"})"),
                                    Json::parse(R"({"type":"box","half_extents":[1,1,0.5],"margin":0.25})"),
                                    Json::parse(R"({"type":"convex","vertices":[[0,0,0]],"margin":2})")};
  const std::vector<Query> queries = {
      {"depth", nullptr},
      {"depth", {{"method", "grid"}, {"delta", 0.25}}},
      {"distance", nullptr},
      {"intersect", nullptr},
      {"directional_depth", {{"direction", {1, 2, 3}}}},
      {"point_in_difference", nullptr, {{"points", {{0, 0, 0}, {0.5, 0.5, 0.5}, {9, 9, 9}}}}},
      {"support_of_difference", {{"directions", {{1, 2, 3}}}}},
      {"contact_manifold", nullptr}};
  for (const int exponent : {-900, -200, 200, 895}) {
    for (const Json& translation : {Json{0, 0, 0}, Json{0.5, 0.25, 0.125}, Json{8, 0, 0}}) {
      for (const Json& a : bodies) {
        // A type is a text, an axis, too: only numbers are scaled.
        for (const Json& b : bodies) {
          for (const Query& query : queries) expect_power_of_two(query, a, b, translation, exponent);
        }
      }
    }
  }
  const Json two = {
      {"type", "compound"},
      {"parts", {{{"shape", bodies[0]}}, {{"shape", bodies[1]}, {"pose", {{"translation", {1, 0, 0}}}}}}}};
  for (const int exponent : {-900, 895}) {
    for (const char* query : {"depth", "distance", "contact_manifold"}) {
      expect_power_of_two({query, nullptr}, two, bodies[0], Json{0.5, 0.25, 0.125}, exponent);
    }
  }
}

TEST(ExtremeSizes, TinyBoxesFarApartAreApart) {
  // Squares of their edges' products underflow, which once made all directions parallel.
  for (const double size : {1e-318, 1e-100, 1e-60}) {
    const Json box = {{"type", "box"}, {"half_extents", {size, size, size}}};
    const Json line = {
        {"query", "point_in_difference"}, {"a", box}, {"b", box}, {"points", {{1, 1, 1}, {size, size, size}}}};
    EXPECT_EQ(answer(line.dump()).at("classes"), Json({"separated", "overlapping"})) << size;
  }
}

}  // namespace
}  // namespace pd::test

/// @file
/// Every error code of the protocol, with the path that names the place.
#include "protocol_lines.hpp"

namespace pd::test {
namespace {

struct Case {
  std::string line;
  const char* code;
  const char* where;
};

void expect_refusals(const std::vector<Case>& cases, const query::Limits& limits = {}) {
  for (const Case& c : cases) {
    const Json reply = answer(c.line, limits);
    EXPECT_EQ(code_of(reply), c.code) << c.line << "\n" << reply.dump();
    EXPECT_EQ(where_of(reply), c.where) << c.line << "\n" << reply.dump();
    if (reply.contains("error")) {
      EXPECT_FALSE(reply["error"]["message"].get<std::string>().empty()) << c.line;
      EXPECT_EQ(reply.size(), 2u) << "an error answer is id and error: " << reply.dump();
    }
  }
}

std::string with_a(const std::string& shape) { return depth_line(shape, kUnitBox); }
std::string with_more(const std::string& more) { return depth_line(kUnitBox, kUnitBox, more); }

TEST(Refusals, Queries) {
  expect_refusals({
      {R"({"id":1})", "missing_field", "query"},
      {R"({"id":1,"query":"dept"})", "unknown_query", "query"},
      {R"({"id":1,"query":""})", "unknown_query", "query"},
      {R"({"id":1,"query":7})", "bad_value", "query"},
      {R"({"id":1,"query":null})", "bad_value", "query"},
      {R"({"id":1,"query":"depth"})", "missing_field", "a"},
      {R"({"id":1,"query":"depth","a":)" + std::string(kUnitBox) + "}", "missing_field", "b"},
      {R"({"id":1,"query":"dept","colour":1})", "unknown_query", "query"},
  });
}

TEST(Refusals, KeysThatStandTwice) {
  expect_refusals({
      {with_a(R"({"type":"box","half_extents":[1,1,1],"half_extents":[2,2,2]})"), "bad_json", "a.half_extents"},
      {with_more(R"("delta":0.1,"delta":0.2)"), "bad_json", "delta"},
      {R"({"id":3,"query":"width","a":{"type":"compound","parts":[{},{"x":1,"x":2}]}})", "bad_json", "a.parts[1].x"},
  });
  EXPECT_EQ(answer(with_more(R"("delta":0.1,"delta":0.2)")).at("id"), answer(with_more(R"("delta":0.1)")).at("id"));
}

TEST(Refusals, TextThatIsNoLines) {
  const auto message = [](std::string_view line) {
    const Json reply = answer(std::string(line));
    EXPECT_EQ(code_of(reply), "bad_json") << reply;
    return reply.at("error").at("message").get<std::string>();
  };
  using std::operator""sv;
  for (const char* line : {"{", " \"id\": 1,", "[[0,0],", "}"}) {
    EXPECT_TRUE(message(line).ends_with("; a line must be one whole JSON object")) << line << ": " << message(line);
  }
  EXPECT_EQ(message("{\"id\":1,}").find("whole"), std::string::npos);
  for (const std::string_view line : {"\xFF\xFE{\0}\0"sv, "\0{\0}"sv, "{\0}\0"sv, "\0"sv}) {
    EXPECT_EQ(message(line), "the line is UTF-16; UTF-8 is read");
  }
}

TEST(Refusals, UnknownKeys) {
  expect_refusals({
      {with_more(R"("colour":"red")"), "bad_value", "colour"},
      {with_a(R"({"type":"box","half_extents":[1,1,1],"name":"x"})"), "bad_value", "a.name"},
      {with_a(R"({"type":"sphere","radius":1,"half_extents":[1,1,1]})"), "bad_value", "a.half_extents"},
      {with_more(R"("pose_b":{"translation":[0,0,0],"scale":2})"), "bad_value", "pose_b.scale"},
      {R"({"id":1,"query":"distance","a":)" + std::string(kUnitBox) + R"(,"b":)" + kUnitBox + R"(,"delta":0.1})",
       "bad_value", "delta"},
  });
}

TEST(Refusals, Shapes) {
  expect_refusals({
      {with_a("7"), "bad_value", "a"},
      {with_a("{}"), "missing_field", "a.type"},
      {with_a(R"({"type":7})"), "bad_value", "a.type"},
      {with_a(R"({"type":"torus"})"), "bad_value", "a.type"},
      {with_a(R"({"type":"box"})"), "missing_field", "a.half_extents"},
      {with_a(R"({"type":"box","half_extents":[1,1]})"), "bad_value", "a.half_extents"},
      {with_a(R"({"type":"box","half_extents":[1,0,1]})"), "bad_value", "a.half_extents[1]"},
      {with_a(R"({"type":"box","half_extents":[1,1,-1]})"), "bad_value", "a.half_extents[2]"},
      {with_a(R"({"type":"box","half_extents":["nan",1,1]})"), "bad_value", "a.half_extents[0]"},
      {with_a(R"({"type":"box","half_extents":[1e308,1,1]})"), "out_of_range", "a.half_extents[0]"},
      {with_a(R"({"type":"sphere","radius":0})"), "bad_value", "a.radius"},
      {with_a(R"({"type":"sphere","radius":-1})"), "bad_value", "a.radius"},
      {with_a(R"({"type":"sphere","radius":"inf"})"), "non_finite", "a.radius"},
      {with_a(R"({"type":"sphere","radius":"1"})"), "bad_value", "a.radius"},
      {with_a(R"({"type":"sphere","radius":true})"), "bad_value", "a.radius"},
      {with_a(R"({"type":"sphere","radius":null})"), "bad_value", "a.radius"},
      {with_a(R"({"type":"sphere","radius":1e301})"), "out_of_range", "a.radius"},
      {with_a(R"({"type":"ellipsoid","radii":[1,0,1]})"), "bad_value", "a.radii[1]"},
      {with_a(R"({"type":"ellipsoid","radii":[1,"nan",1]})"), "non_finite", "a.radii[1]"},
      {with_a(R"({"type":"capsule","radius":1,"half_height":1})"), "missing_field", "a.axis"},
      {with_a(R"({"type":"capsule","radius":1,"half_height":1,"axis":"w"})"), "bad_value", "a.axis"},
      {with_a(R"({"type":"capsule","radius":1,"half_height":-1,"axis":"x"})"), "bad_value", "a.half_height"},
      {with_a(R"({"type":"cylinder","radius":1,"half_height":0,"axis":"x"})"), "bad_value", "a.half_height"},
      {with_a(R"({"type":"cone","radius":-2,"half_height":1,"axis":"x"})"), "bad_value", "a.radius"},
      {with_a(R"({"type":"sphere_hull","spheres":[]})"), "too_few_points", "a.spheres"},
      {with_a(R"({"type":"sphere_hull","spheres":[[0,0,0,1],[1,0,0,-1]]})"), "bad_value", "a.spheres[1]"},
      {with_a(R"({"type":"sphere_hull","spheres":[[0,0,0]]})"), "bad_value", "a.spheres[0]"},
      {with_a(R"({"type":"sphere_hull","spheres":[[0,0,"inf",1],[1,0,0,2]]})"), "non_finite", "a.spheres[0][2]"},
      {with_a(R"({"type":"box","half_extents":[1,1,1],"margin":-1})"), "bad_value", "a.margin"},
      {with_a(R"({"type":"box","half_extents":[1,1,1],"margin":"inf"})"), "non_finite", "a.margin"},
      {with_a(R"({"type":"convex","vertices":[]})"), "too_few_points", "a.vertices"},
      {with_a(R"({"type":"convex","vertices":{}})"), "bad_value", "a.vertices"},
      {with_a(R"({"type":"convex","vertices":[[0,0,0],[1,0]]})"), "bad_value", "a.vertices[1]"},
      {with_a(R"({"type":"convex","vertices":[[0,0,0],[1,0,"nan"]]})"), "non_finite", "a.vertices[1]"},
      {with_a(R"({"type":"convex","vertices":[[0,0,0],[1,0,"-inf"]]})"), "non_finite", "a.vertices[1]"},
      {with_a(R"({"type":"convex","vertices":[[0,0,0],[1,0,"x"]]})"), "bad_value", "a.vertices[1]"},
      {with_a(R"({"type":"convex","vertices":[[0,0,0],[1,1e301,0]]})"), "out_of_range", "a.vertices[1]"},
      {with_a(R"({"type":"mesh","path":"/nowhere/at/all.obj"})"), "unreadable_file", "a.path"},
      {with_a(R"({"type":"mesh","path":"/dev/zero"})"), "unreadable_file", "a.path"},
      {with_a(R"({"type":"mesh","path":"/"})"), "unreadable_file", "a.path"},
      {with_a(R"({"type":"mesh","path":""})"), "unreadable_file", "a.path"},
      {with_a(R"({"type":"mesh"})"), "missing_field", "a.path"},
  });
}

std::string cube_with_faces(const std::string& faces) {
  return with_a(R"({"type":"convex","vertices":[[-1,-1,-1],[-1,-1,1],[-1,1,-1],[-1,1,1],[1,-1,-1],[1,-1,1],[1,1,-1],
      [1,1,1]],"faces":)" +
                faces + "}");
}

TEST(Refusals, Faces) {
  EXPECT_EQ(code_of(answer(cube_with_faces("[[0,1,3,2],[4,6,7,5],[0,4,5,1],[2,3,7,6],[0,2,6,4],[1,5,7,3]]"))), "");
  const std::pair<const char*, const char*> cases[] = {
      {"[[0,1,3,2],[4,6,7,9]]", "bad_faces"},
      {"[[0,1,3,2],[4,6,7,-1]]", "bad_faces"},
      {"[[0,1,3,2],[4,6,7,1e30]]", "bad_faces"},
      {"[[0,1]]", "bad_faces"},
      {"[[0,1,3,2],[4,6,7,5],[0,4,5,1],[2,3,7,6],[0,2,6,4]]", "not_closed"},
      {"[[0,1,3,2],[4,6,7,5],[0,4,5,1],[2,3,7,6],[0,2,6,4],[3,7,5,1]]", "bad_faces"},
      {"[[0,1,3,2],[4,6,7,5.5]]", "bad_value"},
      {"[7]", "bad_value"},
      {"7", "bad_value"},
  };
  for (const auto& [faces, code] : cases) {
    const Json reply = answer(cube_with_faces(faces));
    EXPECT_EQ(code_of(reply), code) << faces << reply.dump();
    EXPECT_TRUE(where_of(reply).starts_with("a.faces")) << reply.dump();
  }
}

TEST(Refusals, NotConvexSurface) {
  // A cube whose top is pushed in to a point below its middle.
  const Json reply = answer(with_a(
      R"({"type":"convex","vertices":[[-1,-1,-1],[1,-1,-1],[1,1,-1],[-1,1,-1],[-1,-1,1],[1,-1,1],[1,1,1],[-1,1,1],
          [0,0,0]],"faces":[[3,2,1,0],[0,1,5,4],[1,2,6,5],[2,3,7,6],[3,0,4,7],[4,5,8],[5,6,8],[6,7,8],[7,4,8]]})"));
  EXPECT_EQ(code_of(reply), "not_convex") << reply.dump();
}

TEST(Refusals, Poses) {
  expect_refusals({
      {with_more(R"("pose_a":7)"), "bad_value", "pose_a"},
      {with_more(R"("pose_a":{"translation":[0,0]})"), "bad_value", "pose_a.translation"},
      {with_more(R"("pose_a":{"translation":[0,"inf",0]})"), "non_finite", "pose_a.translation[1]"},
      {with_more(R"("pose_a":{"translation":[0,1e305,0]})"), "out_of_range", "pose_a.translation[1]"},
      {with_more(R"("pose_a":{"quaternion_wxyz":[0,0,0,0]})"), "bad_value", "pose_a.quaternion_wxyz"},
      {with_more(R"("pose_a":{"quaternion_wxyz":[2,0,0,0]})"), "not_a_rotation", "pose_a.quaternion_wxyz"},
      {with_more(R"("pose_a":{"quaternion_wxyz":[1,0,0]})"), "bad_value", "pose_a.quaternion_wxyz"},
      {with_more(R"("pose_a":{"quaternion_wxyz":["nan",0,0,0]})"), "non_finite", "pose_a.quaternion_wxyz[0]"},
      {with_more(R"("pose_b":{"rotation_row_major":[1,0.1,0,0,1,0,0,0,1]})"), "not_a_rotation",
       "pose_b.rotation_row_major"},
      {with_more(R"("pose_b":{"rotation_row_major":[1,0,0,0,1,0,0,0,-1]})"), "not_a_rotation",
       "pose_b.rotation_row_major"},
      {with_more(R"("pose_b":{"rotation_row_major":[0,0,0,0,0,0,0,0,0]})"), "not_a_rotation",
       "pose_b.rotation_row_major"},
      {with_more(R"("pose_b":{"rotation_row_major":[1,0,0,0,1,0,0,0,1],"quaternion_wxyz":[1,0,0,0]})"), "bad_value",
       "pose_b"},
  });
}

TEST(Refusals, AMatrixResidualIsStated) {
  const Json reply = answer(with_more(R"("pose_b":{"rotation_row_major":[1,0.5,0,0,1,0,0,0,1]})"));
  EXPECT_NE(reply["error"]["message"].get<std::string>().find("0.5"), std::string::npos) << reply.dump();
}

TEST(Refusals, Options) {
  expect_refusals({
      {with_more(R"("method":"magic")"), "bad_value", "method"},
      {with_more(R"("method":7)"), "bad_value", "method"},
      {with_more(R"("delta":0)"), "bad_value", "delta"},
      {with_more(R"("delta":-1e-6)"), "bad_value", "delta"},
      {with_more(R"("delta":2)"), "bad_value", "delta"},
      {with_more(R"("delta":"nan")"), "non_finite", "delta"},
      {with_more(R"("seed":1.5)"), "bad_value", "seed"},
      {with_more(R"("seed":-1)"), "bad_value", "seed"},
      {with_more(R"("method":"metric")"), "missing_field", "method"},
      {with_more(R"("method":"shallow","delta":1e-9)"), "limit_exceeded", "delta"},
      {depth_line(R"({"type":"cone","radius":1,"half_height":1,"axis":"z"})", kUnitBox, R"("method":"overlay")"),
       "unsupported", "method"},
  });
}

TEST(Refusals, Compounds) {
  const std::string part = std::string(R"({"shape":)") + kUnitBox + "}";
  std::string nested = kUnitBox;
  for (int depth = 0; depth < 9; ++depth) nested = R"({"type":"compound","parts":[{"shape":)" + nested + "}]}";
  expect_refusals({
      {with_a(R"({"type":"compound","parts":[]})"), "bad_value", "a.parts"},
      {with_a(R"({"type":"compound"})"), "missing_field", "a.parts"},
      {with_a(R"({"type":"compound","parts":[)" + part + R"(,{"shape":{"type":"sphere","radius":0}}]})"), "bad_value",
       "a.parts[1].shape.radius"},
  });
  EXPECT_EQ(code_of(answer(with_a(nested))), "limit_exceeded");
}

TEST(Refusals, Limits) {
  query::Limits limits;
  limits.max_vertices = 8;
  limits.files = false;
  const std::string eight =
      R"({"type":"convex","vertices":[[0,0,0],[1,0,0],[0,1,0],[0,0,1],[1,1,0],[1,0,1],[0,1,1],[1,1,1]]})";
  const std::string nine =
      R"({"type":"convex","vertices":[[0,0,0],[1,0,0],[0,1,0],[0,0,1],[1,1,0],[1,0,1],[0,1,1],[1,1,1],[2,2,2]]})";
  EXPECT_EQ(code_of(answer(depth_line(eight, eight), limits)), "");
  expect_refusals({{depth_line(eight, nine), "limit_exceeded", "b.vertices"},
                   {with_a(R"({"type":"mesh","path":"x.obj"})"), "unreadable_file", "a.path"}},
                  limits);
}

}  // namespace
}  // namespace pd::test

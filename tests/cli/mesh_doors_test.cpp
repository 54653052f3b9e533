/// @file
/// A mesh that is not convex is asked as the solid that it bounds, and refused by name where it bounds none. Where the
/// hull is asked, the answer says so; `pdepth check` says why.
#include <sys/wait.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <vector>

#include "mesh/hull_note.hpp"
#include "mesh/mesh_file.hpp"
#include "protocol_lines.hpp"
#include "temporary_folder.hpp"

namespace pd::test {
namespace {

constexpr const char* kCube =
    "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nv 0 0 1\nv 1 0 1\nv 0 1 1\nv 1 1 1\n"
    "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
/// The L of three unit cubes, counter-clockwise from above.
constexpr const char* kAngle =
    "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\nv 0 0 1\nv 2 0 1\nv 2 1 1\nv 1 1 1\nv 1 2 1\nv 0 2 1\n"
    "f 6 5 4 3 2 1\nf 7 8 9 10 11 12\nf 1 2 8 7\nf 2 3 9 8\nf 3 4 10 9\nf 4 5 11 10\nf 5 6 12 11\nf 6 1 7 12\n";

class MeshDoors : public ::testing::Test, protected TemporaryFolder {
 protected:
  std::string mesh(const std::string& path, const std::string& more = "") {
    return R"({"type":"mesh","path":")" + path + "\"" + more + "}";
  }
  struct Outcome {
    int status = -1;
    std::string out;
    std::string err;
  };
  Outcome run(const std::string& arguments) {
    const std::string command = "cd '" + path().string() + "' && '" PDEPTH_PROGRAM "' " + arguments + " > out 2> err";
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read("out"), read("err")};
  }
  static void expect_words(const std::string& text, const std::vector<std::string>& words) {
    for (const std::string& word : words) EXPECT_NE(text.find(word), std::string::npos) << word << " in\n" << text;
  }
  const std::string cube_ = write("cube.obj", kCube);
  const std::string angle_ = write("angle.obj", kAngle);
  const std::string cloud_ = write("cloud.obj", std::string(kCube).substr(0, std::string(kCube).find('f')));
  const std::string open_ = write("open.obj", std::string(kCube).substr(0, std::string(kCube).rfind('f')));
};

/// The corners of a box as OBJ, and its faces for vertices numbered after `before`.
std::string box_obj(const std::array<double, 6>& b, int before) {
  std::string text;
  for (int k = 0; k < 8; ++k) {
    text += "v";
    for (std::size_t i = 0; i < 3; ++i) text += " " + std::to_string(b[i + 3 * (static_cast<std::size_t>(k >> i & 1))]);
    text += "\n";
  }
  for (const auto& face : {std::array{1, 3, 4, 2}, std::array{5, 6, 8, 7}, std::array{1, 2, 6, 5},
                           std::array{3, 7, 8, 4}, std::array{1, 5, 7, 3}, std::array{2, 4, 8, 6}}) {
    text += "f";
    for (const int v : face) text += " " + std::to_string(before + v);
    text += "\n";
  }
  return text;
}

/// The groups of a file are the parts of a compound: boxes that abut are no solid as they stand in the file.
TEST_F(MeshDoors, GroupsAreAskedAsParts) {
  const std::string two = "o foot\n" + box_obj({0, 0, 0, 2, 1, 1}, 0) + "o leg\n" + box_obj({0, 1, 0, 1, 2, 1}, 8);
  const std::string file = write("parts.obj", two);
  const std::string parts = R"(,"as":"parts")";
  const Json apart = answer(depth_line(mesh(file, parts), mesh(cube_), R"("pose_b":{"translation":[1.1,1.1,0]})"));
  EXPECT_EQ(apart.at("class"), "separated");
  EXPECT_NEAR(apart.at("distance").get<double>(), 0.1, 1e-15);
  EXPECT_EQ(apart.at("a_is"), "parts");
  const Json deep = answer(depth_line(mesh(cube_), mesh(file, parts), R"("pose_a":{"translation":[0.5,0.75,0]})"));
  EXPECT_EQ(deep.at("class"), "overlapping");
  EXPECT_EQ(deep.at("b_is"), "parts");
  // The file's own solid, the L, says the same.
  EXPECT_EQ(deep.at("depth"),
            answer(depth_line(mesh(cube_), mesh(angle_), R"("pose_a":{"translation":[0.5,0.75,0]})")).at("depth"));
  // A part that is a solid is its convex parts; names stand beside numbers where a part is refused.
  const std::string angle = write("angled.obj", "g bracket\n" + std::string(kAngle));
  EXPECT_NEAR(answer(depth_line(mesh(angle, parts), mesh(cube_), R"("pose_b":{"translation":[1.1,1.1,0]})"))
                  .at("distance")
                  .get<double>(),
              0.1, 1e-15);
  const std::string lid = write("lid.obj", two.substr(0, two.rfind('f')));
  const Json refused = answer(depth_line(mesh(lid, parts), mesh(cube_), "")).at("error");
  EXPECT_EQ(refused.at("code"), "open_edge");
  EXPECT_EQ(refused.at("where"), "a.path");
  expect_words(refused.at("message"), {"part 1 (\"leg\")", "\"as\":\"hull\""});
  const Outcome people = run("depth parts.obj cube.obj --parts --pose-b 1.1,1.1,0");
  expect_words(people.out, {"parts.obj  (convex parts: 2)", "0.1"});
  EXPECT_EQ(Json::parse(run("depth parts.obj box:1,1,1 --parts --json").out).value("a_is", ""), "parts");
  EXPECT_EQ(run("depth parts.obj cube.obj --parts --hull").status, 2);
  EXPECT_EQ(run("depth parts.obj cube.obj --parts --direction 0,0,1").status, 2);
  const Json unsupported = answer(R"({"query":"width","a":)" + mesh(file, parts) + R"(,"b":)" + mesh(cube_) + "}");
  EXPECT_TRUE(unsupported.contains("error"));
  EXPECT_TRUE(answer(depth_line(mesh(cloud_, parts), mesh(cube_), "")).contains("error")) << "no faces, no parts";
}

/// Surfaces that cross, touch along an edge or abut, in a file without groups, are parts as well.
TEST_F(MeshDoors, SurfacesThatCrossAreParts) {
  const std::string parts = R"(,"as":"parts")", pose = R"("pose_b":{"translation":[1.1,1.1,0]})";
  const std::string foot = box_obj({0, 0, 0, 2, 1, 1}, 0);
  for (const std::array<double, 6>& leg : {std::array<double, 6>{0, 0.5, 0, 1, 2, 1}, {0, 1, 0, 1, 2, 1}}) {
    const std::string file = write("surfaces.obj", foot + box_obj(leg, 8));
    const Json refused = answer(depth_line(mesh(file), mesh(cube_), pose)).at("error");
    expect_words(refused.at("message"), {"\"as\":\"parts\"", "\"as\":\"hull\""});
    expect_words(run("depth surfaces.obj cube.obj").err, {"union of its parts (--parts)"});
    expect_words(run("check surfaces.obj").out, {"`pdepth depth --parts`"});
    EXPECT_NEAR(answer(depth_line(mesh(file, parts), mesh(cube_), pose)).at("distance").get<double>(), 0.1, 1e-15);
  }
  const std::string edge = write("edge.obj", foot + box_obj({-1, 1, 0, 0, 2, 1}, 8));
  EXPECT_EQ(answer(depth_line(mesh(edge), mesh(cube_), "")).at("error").at("code"), "not_manifold");
  EXPECT_NEAR(answer(depth_line(mesh(edge, parts), mesh(cube_), R"("pose_b":{"translation":[0.25,1.5,0]})"))
                  .at("distance")
                  .get<double>(),
              0.25, 1e-15);
  // A surface that shows its inside and crosses another may be a cavity; nobody fills it.
  const std::string turned = "f 9 10 12 11\nf 13 15 16 14\nf 9 13 14 10\nf 11 12 16 15\nf 9 11 15 13\nf 10 14 16 12\n";
  const std::string leg = box_obj({0, 0.5, 0, 1, 2, 1}, 8);
  const std::string mixed = write("mixed.obj", foot + leg.substr(0, leg.find('f')) + turned);
  for (const char* const turn : {"", R"(,"turn_faces":true)"}) {
    const Json refused = answer(depth_line(mesh(mixed, parts + turn), mesh(cube_), pose)).at("error");
    EXPECT_EQ(refused.at("code"), "inside_out");
    expect_words(refused.at("message"), {"part 0, surface 1: 1 of 2 parts show their insides"});
  }
  // So does a group of its own: the room inside is not filled.
  const std::string room = box_obj({0.5, 0.25, 0.25, 1.5, 0.75, 0.75}, 8);
  const std::string inner =
      write("inner.obj", "o outer\n" + foot + "o inner\n" + room.substr(0, room.find('f')) + turned);
  EXPECT_EQ(answer(depth_line(mesh(inner, parts), mesh(cube_), pose)).at("error").at("code"), "inside_out");
  // Boxes that share a whole face are told by their indices.
  const std::string row = write("row.obj", box_obj({0, 0, 0, 1, 1, 1}, 0) + box_obj({1, 0, 0, 2, 1, 1}, 8));
  EXPECT_NEAR(answer(depth_line(mesh(row, parts), mesh(cube_), R"("pose_b":{"translation":[2.5,0,0]})"))
                  .at("distance")
                  .get<double>(),
              0.5, 1e-15);
  // A face that stands there twice is no part.
  write("twice.obj", std::string(kAngle) + "f 6 1 7 12\n");
  EXPECT_EQ(run("depth twice.obj cube.obj").err.find("parts"), std::string::npos);
  // A flat part is named as flat.
  const std::string flat = write("flat.obj", foot + "o flat\nv 5 0 0\nv 6 0 0\nv 5 1 0\nf 9 10 11\nf 10 9 11\n");
  expect_words(answer(depth_line(mesh(flat, parts), mesh(cube_), pose)).at("error").at("message"),
               {"part 1 (\"flat\")", "all points lie in one plane"});
}

/// Six decimals of a file of a metre round a part of three centimetres by more than 1e-5 of the part.
TEST_F(MeshDoors, PartsAreConvexToThePrecisionOfTheirFile) {
  const std::string part =
      "v 0 0 0\nv 0.03 0 0\nv 0 0.03 0\nv 0 0 0.03\nv 0.01 0.01 0.009999\n"
      "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 5\nf 3 4 5\nf 4 2 5\n";
  write("part.obj", part);
  expect_words(run("check part.obj").out, {"not convex"});
  const std::string file = write("fine.obj", "o small\n" + part + "o large\n" + box_obj({1, 0, 0, 2, 1, 1}, 5));
  const Outcome people = run("depth fine.obj sphere:0.5 --parts --pose-b 0,0,-0.75");
  EXPECT_EQ(people.status, 0) << people.err;
  expect_words(people.out, {"(convex parts: 2)"});
  // A notch of a fifth of its part stays one, however large the file is.
  const std::string far_box = box_obj({1e6, 0, 0, 2e6, 1, 1}, 12);
  write("notch.obj", "o notched\n" + std::string(kAngle) + "o far\n" + far_box);
  expect_words(run("depth notch.obj cube.obj --parts --pose-b 1.1,1.1,0").out,
               {"A and B are apart.", "(convex parts: 3)"});
}

/// A glTF shows one mesh at two places: each showing is a part.
TEST_F(MeshDoors, MeshesOfAGltfAreParts) {
  std::string bytes;
  const auto put = [&](const auto value) { bytes.append(reinterpret_cast<const char*>(&value), sizeof value); };
  for (int k = 0; k < 8; ++k) {
    for (int i = 0; i < 3; ++i) put(static_cast<float>(k >> i & 1));
  }
  for (const auto& f : {std::array{0, 2, 3, 1}, std::array{4, 5, 7, 6}, std::array{0, 1, 5, 4}, std::array{2, 6, 7, 3},
                        std::array{0, 4, 6, 2}, std::array{1, 3, 7, 5}}) {
    for (const std::size_t k : {0U, 1U, 2U, 0U, 2U, 3U}) put(static_cast<std::uint16_t>(f[k]));
  }
  write("two.bin", bytes);
  const std::string file = write("two.gltf", R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0,1]}],
    "nodes":[{"mesh":0},{"mesh":0,"translation":[3,0,0]}],"buffers":[{"uri":"two.bin","byteLength":168}],
    "bufferViews":[{"buffer":0,"byteLength":96},{"buffer":0,"byteOffset":96,"byteLength":72}],
    "accessors":[{"bufferView":0,"componentType":5126,"count":8,"type":"VEC3"},
                 {"bufferView":1,"componentType":5123,"count":36,"type":"SCALAR"}],
    "meshes":[{"name":"cube","primitives":[{"attributes":{"POSITION":0},"indices":1}]}]})");
  // A cube between the two, whose hull holds the cube.
  const std::string pose = R"("pose_b":{"translation":[1.5,0,0]})";
  const Json apart = answer(depth_line(mesh(file, R"(,"as":"parts")"), mesh(cube_), pose));
  EXPECT_EQ(apart.at("distance"), 0.5) << apart;
  EXPECT_EQ(answer(depth_line(mesh(file, R"(,"as":"hull")"), mesh(cube_), pose)).at("class"), "overlapping");
}

TEST_F(MeshDoors, AMeshThatIsNotConvexIsAskedAsTheSolid) {
  // A cube in the notch of the L: the solids are 0.1 apart, their hulls overlap.
  const std::string pose = R"("pose_b":{"translation":[1.1,1.1,0]})";
  const Json found = answer(depth_line(mesh(angle_), mesh(cube_), pose));
  EXPECT_EQ(found.at("class"), "separated");
  EXPECT_NEAR(found.at("distance").get<double>(), 0.1, 1e-15);
  EXPECT_LE(found.at("distance_lower"), found.at("distance"));
  EXPECT_EQ(found.at("a_is"), "solid");
  EXPECT_FALSE(found.contains("b_is")) << "the cube is convex";
  EXPECT_EQ(found.at("feature").at("kind"), "face-face");
  const Json flush = answer(depth_line(mesh(cube_), mesh(angle_), R"("pose_a":{"translation":[1,1,0]})"));
  EXPECT_EQ(flush.at("class"), "touching");
  EXPECT_EQ(flush.at("b_is"), "solid");
  const Json deep = answer(depth_line(mesh(angle_), kUnitBox, R"("pose_b":{"translation":[1,1,0.5]})"));
  EXPECT_EQ(deep.at("class"), "overlapping");
  EXPECT_EQ(deep.at("exact"), true);
  EXPECT_NEAR(deep.at("depth").get<double>(), std::sqrt(2.0), 1e-15);
  for (const char* query : {"distance", "intersect"}) {
    const Json told = answer(R"({"id":1,"query":")" + std::string(query) + R"(","a":)" + mesh(angle_) + R"(,"b":)" +
                             mesh(cube_) + "," + pose + "}");
    EXPECT_EQ(told.at("class"), "separated") << told;
    EXPECT_EQ(told.value("a_is", ""), "solid") << told;
  }
  // Beside other bodies, and where the query is one of unions, the solid's convex parts are asked.
  for (const std::string& other : {std::string(R"({"type":"sphere","radius":0.2})"),
                                   R"({"type":"compound","parts":[{"shape":)" + mesh(angle_) + R"(,"pose":{}}]})"}) {
    const Json told =
        answer(depth_line(other, mesh(angle_, R"(,"margin":0.05)"), R"("pose_a":{"translation":[1.5,1.5,0.5]})"));
    EXPECT_EQ(told.value("b_is", ""), "solid") << told;
    EXPECT_TRUE(told.contains("closed")) << told;
  }
  const Json manifold =
      answer(R"({"id":1,"query":"contact_manifold","a":)" + mesh(angle_) + R"(,"b":)" + mesh(cube_) + "}");
  EXPECT_EQ(manifold.value("a_is", ""), "solid") << manifold;
}

/// A torus whose radius rises and falls, of 98 triangles: more convex parts than a depth is told by.
std::string wavy_torus_obj() {
  constexpr int kAround = 7;
  std::string text;
  for (int i = 0; i < kAround * kAround; ++i) {
    const double u = 2 * M_PI / kAround * (i / kAround), v = 2 * M_PI / kAround * (i % kAround);
    const double r = 1 + 0.05 * std::sin(9 * u + 7 * v), reach = 3 + r * std::cos(v);
    for (const double x : {reach * std::cos(u), reach * std::sin(u), r * std::sin(v)}) {
      text += (text.empty() || text.back() == '\n' ? "v " : " ") + std::to_string(x);
    }
    text += "\n";
  }
  for (int i = 0; i < kAround * kAround; ++i) {
    const auto vertex = [&](int u, int v) {
      return " " + std::to_string(1 + (i / kAround + u) % kAround * kAround + (i % kAround + v) % kAround);
    };
    text +=
        "f" + vertex(0, 0) + vertex(1, 0) + vertex(1, 1) + "\nf" + vertex(0, 0) + vertex(1, 1) + vertex(0, 1) + "\n";
  }
  return text;
}

/// Balls and swept boxes beside solids, also those of too many parts, in lines and in the command.
TEST_F(MeshDoors, CurvedAndSweptShapesBesideASolid) {
  const std::string ball = R"({"type":"sphere","radius":0.25})";
  const std::string notch = R"("pose_b":{"translation":[1.5,1.5,0.5]})";
  const Json apart = answer(depth_line(mesh(angle_), ball, notch));
  EXPECT_EQ(apart.at("class"), "separated") << apart;
  EXPECT_EQ(apart.at("method"), "solid") << apart;
  EXPECT_NEAR(apart.at("distance").get<double>(), 0.25, 1e-15);
  EXPECT_EQ(apart.value("a_is", ""), "solid");
  EXPECT_FALSE(apart.contains("b_is")) << apart;
  const std::string swept = R"({"type":"box","half_extents":[0.25,0.25,0.25],"margin":0.125})";
  const Json turned = answer(depth_line(swept, mesh(angle_), R"("pose_a":{"translation":[1.5,1.5,0.5]})"));
  EXPECT_NEAR(turned.at("distance").get<double>(), 0.125, 1e-15) << turned;
  EXPECT_EQ(turned.value("b_is", ""), "solid") << turned;
  for (const auto& [pose, contact] : {std::pair{"[1.5,1.5,0.5]", "separated"}, std::pair{"[1.25,1.5,0.5]", "touching"},
                                      std::pair{"[1.2,1.5,0.5]", "overlapping"}}) {
    const std::string line = R"({"id":1,"query":"intersect","a":)" + mesh(angle_) + R"(,"b":)" + ball +
                             R"(,"pose_b":{"translation":)" + pose + "}}";
    EXPECT_EQ(answer(line).at("class"), contact) << line;
  }
  // A flat polytope is asked as a part of a union.
  const Json flat = answer(depth_line(mesh(angle_), R"({"type":"convex","vertices":[[0,0,0],[0.25,0,0],[0,0.25,0]]})",
                                      R"("pose_b":{"translation":[0.25,0.25,0.75]})"));
  EXPECT_EQ(flat.value("depth", 0.0), 0.25) << flat;
  const std::string torus = mesh(write("torus.obj", wavy_torus_obj()));
  const Json inside = answer(depth_line(torus, ball, R"("pose_b":{"translation":[3,0,0]})"));
  EXPECT_EQ(inside.at("class"), "overlapping") << inside;
  EXPECT_FALSE(inside.contains("bracket_reached")) << inside;
  EXPECT_GT(inside.at("stats").at("parts_a"), 1) << inside;
  EXPECT_GT(inside.at("lower"), 0.75) << inside;
  EXPECT_LT(inside.at("upper"), 1.25) << inside;
  expect_words(run("depth torus.obj sphere:0.25 --pose-b 3,0,0").out, {"A and B overlap", "solid: 49 vertices"});
  expect_words(run("depth box:0.25,0.25,0.25 angle.obj --margin 0.125,0 --pose-a 1.5,1.5,0.5").out,
               {"A and B are apart", "0.125", "face"});
  const auto refused = run("depth angle.obj sphere:0.5 --margin 0.1");
  EXPECT_EQ(refused.status, 2);
  expect_words(refused.err, {"angle.obj", "--hull"});
}

TEST_F(MeshDoors, TheBudgetOfADepthIsTheCallers) {
  const std::string torus = mesh(write("torus.obj", wavy_torus_obj()));
  const std::string pose = R"("pose_b":{"translation":[2.4,0,0]})";
  const Json asked = answer(depth_line(torus, torus, pose + R"(,"max_points":2000)"));
  EXPECT_EQ(asked.at("class"), "overlapping") << asked;
  EXPECT_EQ(asked.value("bracket_reached", true), false) << asked;
  EXPECT_LE(asked.at("stats").at("points"), 4000) << asked;
  const Json full = answer(depth_line(torus, torus, pose));
  EXPECT_FALSE(full.contains("bracket_reached")) << full;
  EXPECT_GT(full.at("stats").at("points"), 4000) << full;
  EXPECT_LE(asked.at("lower"), full.at("lower"));
  EXPECT_GE(asked.at("upper"), full.at("lower"));
  // Bodies that need no budget take the number all the same, and no body takes a wrong one.
  const std::string compound = R"({"type":"compound","parts":[{"shape":)" + std::string(kUnitBox) + "}]}";
  for (const std::string& body : {torus, mesh(cube_), std::string(kUnitBox), compound}) {
    const Json taken = answer(depth_line(body, kUnitBox, R"("max_points":2000)"));
    EXPECT_FALSE(taken.contains("error")) << taken;
    for (const char* wrong : {"0", "-1", "1.5", "2e12", "\"many\""}) {
      const Json refused = answer(depth_line(body, kUnitBox, R"("max_points":)" + std::string(wrong)));
      EXPECT_EQ(code_of(refused), "bad_value") << refused;
      EXPECT_EQ(where_of(refused), "max_points") << refused;
    }
  }
}

TEST_F(MeshDoors, ASolidThatFitsExactlyIsInASeat) {
  // A cube in a U of exactly its width, and in the corner of the L.
  const std::string notch =
      mesh(write("notch.obj",
                 "v 0 0 0\nv 3 0 0\nv 3 2 0\nv 2 2 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\n"
                 "v 0 0 1\nv 3 0 1\nv 3 2 1\nv 2 2 1\nv 2 1 1\nv 1 1 1\nv 1 2 1\nv 0 2 1\n"
                 "f 8 7 6 5 4 3 2 1\nf 9 10 11 12 13 14 15 16\nf 1 2 10 9\nf 2 3 11 10\nf 3 4 12 11\n"
                 "f 4 5 13 12\nf 5 6 14 13\nf 6 7 15 14\nf 7 8 16 15\nf 8 1 9 16\n"));
  const std::string in_place = R"("pose_a":{"translation":[1,1,0]})";
  const Json seated = answer(depth_line(mesh(cube_), notch, in_place));
  EXPECT_EQ(seated.at("class"), "touching") << seated;
  EXPECT_EQ(seated.at("seat"), true) << seated;
  EXPECT_EQ(answer(depth_line(mesh(cube_), mesh(angle_), in_place)).at("seat"), false);
  EXPECT_FALSE(answer(depth_line(mesh(cube_), notch, R"("pose_a":{"translation":[1,4,0]})")).contains("seat"));
  expect_words(run("depth cube.obj notch.obj --pose-a 1,1,0").out, {"touch", "A fits exactly"});
  EXPECT_EQ(run("depth cube.obj angle.obj --pose-a 1,1,0").out.find("fits exactly"), std::string::npos);
}

TEST_F(MeshDoors, HullsSayThatTheyAreHulls) {
  for (const std::string& hull : {mesh(cloud_), mesh(cube_, R"(,"as":"hull")"), mesh(angle_, R"(,"as":"hull")"),
                                  mesh(angle_, R"(,"margin":0.1,"as":"hull")")}) {
    EXPECT_EQ(answer(depth_line(hull, kUnitBox)).value("a_is", ""), "hull") << hull;
  }
  const Json hull = answer(R"({"id":1,"query":"hull","a":)" + mesh(angle_) + "}");
  EXPECT_EQ(hull.value("a_is", ""), "hull");
  EXPECT_FALSE(answer(R"({"id":1,"query":"hull","a":)" + mesh(cube_) + "}").contains("a_is"));
}

TEST_F(MeshDoors, MeshesThatBoundNoSolidAreRefusedByName) {
  const Json open = answer(depth_line(mesh(open_), kUnitBox));
  EXPECT_EQ(code_of(open), "open_edge");
  EXPECT_EQ(where_of(open), "a.path");
  expect_words(open.dump(), {"line", "hull", "mend the mesh"});
  const std::string text(kCube);
  const auto changed = [&](const std::string& name, const std::string& from, const std::string& to) {
    std::string more = text;
    more.replace(more.find(from), from.size(), to);
    return write(name, more);
  };
  EXPECT_EQ(code_of(answer(depth_line(mesh(changed("flip.obj", "f 5 6 8 7", "f 7 8 6 5")), kUnitBox))), "flipped_face");
  std::string turned = std::string(kAngle).substr(0, std::string(kAngle).find("f 6"));
  turned += "f 1 2 3 4 5 6\nf 12 11 10 9 8 7\nf 7 8 2 1\nf 8 9 3 2\nf 9 10 4 3\nf 10 11 5 4\nf 11 12 6 5\nf 12 7 1 6\n";
  const std::string inside_out = write("turned.obj", turned);
  EXPECT_EQ(code_of(answer(depth_line(mesh(inside_out), kUnitBox))), "inside_out");
  EXPECT_EQ(answer(depth_line(mesh(inside_out, R"(,"turn_faces":true)"), kUnitBox)).value("class", ""), "overlapping");
  const std::string crossing = write("two.obj", text +
                                                    "v 0.5 0.5 0.5\nv 0.7 0.5 0.5\nv 0.5 0.7 0.5\nv 0.5 0.5 2\n"
                                                    "f 9 11 10\nf 9 10 12\nf 9 12 11\nf 10 11 12\n");
  EXPECT_EQ(code_of(answer(depth_line(mesh(crossing), kUnitBox))), "self_crossing");
  const Json refused = answer(depth_line(mesh(cube_, R"(,"as":"magic")"), kUnitBox));
  EXPECT_EQ(code_of(refused), "bad_value");
  EXPECT_EQ(where_of(refused), "a.as");
  EXPECT_EQ(answer(depth_line(mesh(cube_, R"(,"as":"solid")"), kUnitBox)).value("a_is", ""), "solid");
}

TEST_F(MeshDoors, TheReasonAndBothVolumes) {
  const auto note_of = [](const std::string& file) {
    const query::MeshPoints points = query::read_mesh_points(file, 1000, 1 << 20);
    const auto note = query::why_hull(points, ConvexPolytope::from_points(points.points).value());
    return note ? query::in_words(*note) : "";
  };
  EXPECT_EQ(note_of(cube_), "");
  EXPECT_EQ(note_of(angle_),
            "asked as the convex hull, since the mesh is not convex: 10 vertices, 1.167 times the mesh's volume");
  EXPECT_EQ(note_of(cloud_), "asked as the convex hull, since the file holds points and no faces: 8 vertices");
  EXPECT_EQ(note_of(open_), "asked as the convex hull, since the mesh has holes: 8 vertices");
  std::string stl = "solid\n";
  for (const char* corners : {"0 0 0,0 1 0,1 0 0", "0 0 0,1 0 0,0 0 1", "0 0 0,0 0 1,0 1 0", "1 0 0,0 1 0,0 0 1"}) {
    std::string text = corners;
    for (std::size_t at = 0; at != std::string::npos; at = text.find(',', at + 1)) {
      const std::size_t from = at == 0 ? 0 : at + 1;
      stl += "vertex " + text.substr(from, text.find(',', from) - from) + "\n";
    }
  }
  EXPECT_EQ(note_of(write("t.stl", stl + "endsolid\n")), "") << "corners of an STL are one vertex where they are equal";
}

TEST_F(MeshDoors, TheCommandsSayItToPeople) {
  const Outcome found = run("depth angle.obj cube.obj --pose-b 1.1,1.1,0");
  EXPECT_EQ(found.status, 0);
  expect_words(found.out, {"angle.obj  (solid: 12 vertices, 20 triangles)", "A and B are apart."});
  const Json told = Json::parse(run("depth angle.obj cube.obj --json --pose-b 1.1,1.1,0").out);
  EXPECT_EQ(told.value("a_is", ""), "solid");
  EXPECT_EQ(told.value("class", ""), "separated");
  EXPECT_FALSE(told.contains("b_is"));
  const Outcome hull = run("depth angle.obj cube.obj --pose-b 1.1,1.1,0 --hull");
  expect_words(hull.out, {"A's hull and B's hull overlap."});
  EXPECT_EQ(Json::parse(run("depth angle.obj cube.obj --json --hull").out).value("b_is", ""), "hull");
  const Outcome convex = run("depth cube.obj cube.obj");
  EXPECT_EQ(convex.out.find("asked as"), std::string::npos) << convex.out;
  expect_words(convex.out, {"A and B overlap."});
  const Outcome open = run("depth open.obj cube.obj");
  EXPECT_EQ(open.status, 2);
  expect_words(open.err, {"open_edge", "--hull"});
}

TEST_F(MeshDoors, CheckSaysHowQueriesTakeTheFile) {
  const std::string text(kCube);
  const auto changed = [&](const std::string& name, const std::string& from, const std::string& to) {
    std::string more = text;
    more.replace(more.find(from), from.size(), to);
    return write(name, more);
  };
  std::string turned = std::string(kAngle).substr(0, std::string(kAngle).find("f 6"));
  turned += "f 1 2 3 4 5 6\nf 12 11 10 9 8 7\nf 7 8 2 1\nf 8 9 3 2\nf 9 10 4 3\nf 10 11 5 4\nf 11 12 6 5\nf 12 7 1 6\n";
  struct Case {
    std::string file;
    const char* asked_as;
    const char* refused_as;
    const char* words;
  };
  const std::vector<Case> cases = {
      {cube_, "convex", "", "ask for the convex body"},
      {angle_, "solid", "", "ask for the solid that the faces bound; `pdepth depth --hull`"},
      {cloud_, "hull", "", "ask for the convex hull of the points"},
      {open_, "refused", "open_edge", "refuse the file (open_edge): mend the mesh; `pdepth depth --hull`"},
      {changed("flip.obj", "f 5 6 8 7", "f 7 8 6 5"), "refused", "flipped_face", "(flipped_face): mend the mesh"},
      {write("flat.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\nf 3 2 1\n"), "refused", "degenerate_face",
       "mend the mesh"},
      {write("point.obj", "v 1 1 1\nf 1 1 1\n"), "refused", "degenerate_face",
       "refuse the file (degenerate_face): mend"},
      {write("beside.obj", text + "v 9 9 9\nf 9 9 9\n"), "solid", "", "ask for the solid that the faces bound"},
      {write("turned.obj", turned), "refused", "inside_out", "(inside_out): turn the faces, by \"turn_faces\":true"},
      {write("two.obj", text + "v 0.5 0.5 0.5\nv 0.7 0.5 0.5\nv 0.5 0.7 0.5\nv 0.5 0.5 2\n"
                               "f 9 11 10\nf 9 10 12\nf 9 12 11\nf 10 11 12\n"),
       "refused", "self_crossing", "(self_crossing): mend the mesh"},
      {write("nested.obj", text + "v 0.5 0.5 0.5\nv 0.7 0.5 0.5\nv 0.5 0.7 0.5\nv 0.5 0.5 0.7\n"
                                  "f 9 11 10\nf 9 10 12\nf 9 12 11\nf 10 11 12\n"),
       "refused", "bad_faces", "(bad_faces): mend the mesh"}};
  for (const Case& c : cases) {
    expect_words(run("check '" + c.file + "'").out, {"queries", c.words});
    const Json told = Json::parse(run("check '" + c.file + "' --json").out);
    EXPECT_EQ(told.value("asked_as", ""), c.asked_as) << c.file;
    EXPECT_EQ(told.value("refused_as", ""), c.refused_as) << c.file;
    // The query is the judge of what the check says.
    const Json asked = answer(depth_line(mesh(c.file), kUnitBox));
    const std::string as = asked.contains("error") ? "refused" : asked.value("a_is", "convex");
    EXPECT_EQ(as, c.asked_as) << asked;
    EXPECT_EQ(asked.contains("error") ? code_of(asked) : "", c.refused_as) << asked;
  }
}

TEST_F(MeshDoors, CheckNamesFaultsAndPlaces) {
  const Outcome cube = run("check cube.obj --fail-on solid,not_convex,duplicate_points");
  EXPECT_EQ(cube.status, 0) << cube.err;
  expect_words(cube.out, {"The faces bound a solid, and it is convex.", "6 in 1 connected surface", "1 x 1 x 1"});
  const Outcome angle = run("check angle.obj --fail-on solid,not_convex");
  EXPECT_EQ(angle.status, 3);
  expect_words(angle.out, {"The faces bound a solid, which is not convex.", "volume        3\n", "volume 3.5"});
  expect_words(angle.err, {"not_convex of --fail-on applies"});
  const Outcome open = run("check open.obj --fail-on open_edge");
  EXPECT_EQ(open.status, 3);
  expect_words(open.out,
               {"The faces do not bound a solid", "no: the surface has holes; 4 edges have a face on one side",
                "the edge from (1, 0, 0) to (1, 1, 0) of face 0 (line 9)"});
  // Every door counts faces alike.
  expect_words(run("depth open.obj cube.obj").err, {"face 0 alone", "(face 0: line 9)"});
  const std::string tip = "f 1 2 3\nf 1 4 2\nf 1 3 4\nf 2 4 3\n";
  write("turned.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n" + tip);
  expect_words(run("check turned.obj").out, {"wrong way round: 1 surface shows its inside; turn the faces"});
  expect_words(run("check cloud.obj").out, {"points and no faces"});
  EXPECT_EQ(run("check none.obj").status, 2);
  EXPECT_EQ(run("check cube.obj --fail-on magic").status, 2);

  write("two.obj", std::string(kCube) +
                       "v 0.5 0.5 0.5\nv 0.7 0.5 0.5\nv 0.5 0.7 0.5\nv 0.5 0.5 2\n"
                       "f 9 11 10\nf 9 10 12\nf 9 12 11\nf 10 11 12\n");
  const Json crossed = Json::parse(run("check two.obj --json").out);
  EXPECT_EQ(crossed.at("solid"), false);
  EXPECT_EQ(crossed.at("closed"), true);
  EXPECT_EQ(crossed.at("faults"), Json({{"self_crossing", 3}}));
  EXPECT_EQ(crossed.at("surfaces"), 2);
  EXPECT_EQ(crossed.at("loose_points"), 0);
  EXPECT_NE(crossed.at("findings")[0].at("where").get<std::string>().find("face 1 (line 10) and face"),
            std::string::npos);
  write("beside.obj", std::string(kCube) + "v 7 0 0\nf 9 9 9\n");
  const Json beside = Json::parse(run("check beside.obj --json").out);
  EXPECT_EQ(beside.at("loose_points"), 1);
  EXPECT_EQ(beside.at("asked_as"), "solid");
}

}  // namespace
}  // namespace pd::test

/// @file
/// Files from strangers: whatever a name leads to and whatever a header claims, a file is read as it stands or refused
/// by name, within the limits.
#include <sys/stat.h>
#include <unistd.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>

#include "drawing/svg_file.hpp"
#include "files/decimal_number.hpp"
#include "mesh/mesh_file.hpp"
#include "protocol_lines.hpp"
#include "support/refusal.hpp"
#include "temporary_folder.hpp"

namespace pd::test {
namespace {

template <class T>
std::string stored(std::initializer_list<T> values) {
  std::string bytes(values.size() * sizeof(T), '\0');
  std::memcpy(bytes.data(), std::data(values), bytes.size());
  return bytes;
}

/// A triangle, its corners one behind the other.
const std::string kTriangle = stored({0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f});

/// A scene of one node that shows kTriangle out of a buffer.
std::string triangle_of(const std::string& uri) {
  return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
    "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
    "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],
    "bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[{"uri":")" +
         uri + R"(","byteLength":36}]})";
}

std::string glb(const std::string& json, const std::string& chunk) {
  const auto word = [](std::size_t n) { return stored({static_cast<std::uint32_t>(n)}); };
  std::string bytes = "glTF" + word(2) + word(28 + json.size() + chunk.size());
  bytes += word(json.size()) + "JSON" + json;
  return bytes + word(chunk.size()) + std::string("BIN\0", 4) + chunk;
}

class StrangersFiles : public ::testing::Test, protected TemporaryFolder {
 protected:
  query::MeshPoints read(const std::string& name, const std::string& content) {
    return query::read_mesh_points(write(name, content), 1000, 1 << 22);
  }
  /// "code: message" of the refusal of a mesh; empty where it is read.
  std::string refusal_of(const std::string& file) {
    try {
      (void)query::read_mesh_points(file, 1000, 1 << 22);
    } catch (const query::Refusal& refused) {
      return refused.code + ": " + refused.message;
    }
    return "";
  }
  std::string refusal(const std::string& name, const std::string& content) { return refusal_of(write(name, content)); }
  void expect(const std::string& refused, const std::string& code, const std::string& words) {
    EXPECT_TRUE(refused.starts_with(code + ": ")) << refused;
    EXPECT_NE(refused.find(words), std::string::npos) << words << " in " << refused;
  }
};

TEST_F(StrangersFiles, BuffersStandInTheFolderOfTheirGltf) {
  std::filesystem::create_directories(path() / "scene" / "sub");
  const std::string secret = write("secret.bin", kTriangle);
  write("scene/part.bin", kTriangle);
  write("scene/sub/my part.bin", kTriangle);
  std::filesystem::create_symlink(secret, path() / "scene" / "link.bin");
  std::filesystem::create_symlink(path(), path() / "scene" / "up");
  ASSERT_EQ(::mkfifo((path() / "scene" / "pipe").c_str(), 0600), 0);

  for (const char* inside : {"part.bin", "./part.bin", "sub/my%20part.bin", "sub/./my part.bin",
                             "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}) {
    const query::MeshPoints mesh = read("scene/a.gltf", triangle_of(inside));
    ASSERT_EQ(mesh.points.size(), 3u) << inside;
    EXPECT_EQ(mesh.points[1], Vec3(1, 0, 0)) << inside;
  }
  const auto outside = [&](const std::string& uri, const std::string& words) {
    expect(refusal("scene/a.gltf", triangle_of(uri)), "unreadable_file", words);
  };
  outside(secret, "absolute path");
  outside("/dev/stdin", "absolute path");
  outside("../secret.bin", "leaves the folder");
  outside("sub/../../secret.bin", "leaves the folder");
  outside("%2E%2E/secret.bin", "leaves the folder");
  outside("..%2Fsecret.bin", "leaves the folder");
  outside("file://" + secret, "data: URIs");
  outside("C:secret.bin", "data: URIs");
  outside("..\\\\secret.bin", "backslash");
  outside("part.bin%00.png", "zero byte");
  outside("link.bin", "symbolic link");
  outside("up/secret.bin", "symbolic link");
  outside("pipe", "not a regular file");
  outside("sub", "not a regular file");
  outside("none.bin", "no such file");
  outside("", "names no file");
  write("scene/part.bin", kTriangle.substr(0, 20));
  outside("part.bin", "holds 20 bytes where 36 are needed");
}

TEST_F(StrangersFiles, GltfIsCountedBeforeAnythingIsMade) {
  const std::string head = R"({"asset":{"version":"2.0"},)";
  // Each node has its child twice: 2^22 instances.
  std::string nodes;
  for (int i = 0; i < 22; ++i) {
    nodes += R"({"children":[)" + std::to_string(i + 1) + "," + std::to_string(i + 1) + "]},";
  }
  const std::string rest = triangle_of("a.bin").substr(triangle_of("a.bin").find("\"meshes\""));
  const std::string tree = head + R"("scenes":[{"nodes":[0]}],"nodes":[)";
  expect(refusal("a.gltf", tree + nodes + R"({"mesh":0}],)" + rest), "unreadable_file", "two parents");
  expect(refusal("a.gltf", tree + R"({"children":[1]},{"children":[0]}],)" + rest), "unreadable_file", "is no root");
  nodes.clear();
  for (int i = 0; i < 17'420; ++i) nodes += R"({"children":[)" + std::to_string(i + 1) + "]},";
  expect(refusal("a.gltf", tree + nodes + "{}]}"), "limit_exceeded", "deeper than 1000 levels");
  expect(refusal("a.gltf", head + "\"extras\":" + std::string(176'000, '[') + std::string(176'000, ']') + "}"),
         "limit_exceeded", "nest deeper");

  const std::string scene = glb(head + "\"nodes\":[]}", "");
  std::string claims = scene.substr(0, 8) + stored({28u}) + stored({0xFFFFFFFFu}) + "JSON{}  {}  ";
  expect(refusal("a.glb", claims.substr(0, 28)), "unreadable_file", "claims 4294967295 bytes");
  claims = scene;
  claims.replace(8, 4, stored({0xFFFFFFFFu}));
  expect(refusal("a.glb", claims), "unreadable_file", "claims 4294967295 bytes");

  write("a.bin", kTriangle);
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = triangle_of("a.bin");
    return refusal("a.gltf", text.replace(text.find(from), from.size(), to));
  };
  expect(with("\"count\":3", "\"count\":4"), "unreadable_file", "end behind their bufferView");
  expect(with("\"count\":3", "\"count\":4294967295"), "unreadable_file", "end behind their bufferView");
  expect(with("\"byteLength\":36}]}", "\"byteLength\":99}]}"), "unreadable_file", "bytes");
  expect(with("\"byteLength\":36}]}", "\"byteLength\":1099511627776}]}"), "limit_exceeded", "too many bytes");
  expect(with("\"bufferView\":0,", ""), "unsupported", "bufferView");
  expect(with("\"bufferView\":0", "\"bufferView\":7"), "unreadable_file", "no number 7");
  expect(with("\"version\":\"2.0\"", "\"version\":\"1.0\""), "unsupported", "glTF 2");
  expect(with("\"POSITION\":0", "\"POSITION\":-1"), "unreadable_file", "must lie in");
  expect(with("{\"mesh\":0}", "7"), "unreadable_file", "must be an object");
  // A mesh of three vertices in 400 nodes, within a limit of 1,000.
  std::string many = triangle_of("a.bin"), shown, roots;
  for (int i = 0; i < 400; ++i) {
    shown += R"({"mesh":0},)";
    roots += "," + std::to_string(i + 1);
  }
  many.replace(many.find("{\"mesh\":0}"), 0, shown);
  many.replace(many.find("{\"nodes\":[0]}"), 11, "{\"nodes\":[0" + roots);
  expect(refusal("a.gltf", many), "limit_exceeded", "1000 vertices");
}

TEST_F(StrangersFiles, GltfFacesStripsAndSparseValues) {
  const std::string chunk =
      kTriangle + stored({1.f, 1.f, 0.f}) + stored<std::uint16_t>({0, 1, 2, 3, 3, 0}) + stored<float>({5, 5, 5});
  const std::string json = R"({"asset":{"version":"2.0"},"nodes":[{"mesh":0,"scale":[-1,1,1]},{"mesh":1}],"meshes":[
    {"primitives":[{"attributes":{"POSITION":0},"indices":1,"mode":5}]},{"primitives":[{"attributes":{"POSITION":2}}]}],
    "accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"},
      {"bufferView":1,"componentType":5123,"count":4,"type":"SCALAR"},
      {"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","sparse":{"count":1,
        "indices":{"bufferView":1,"byteOffset":2,"componentType":5123},"values":{"bufferView":2}}}],
    "bufferViews":[{"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":12},
      {"buffer":0,"byteOffset":60,"byteLength":12}],"buffers":[{"byteLength":72}]})";
  const query::MeshPoints mesh = read("a.glb", glb(json, chunk));
  ASSERT_EQ(mesh.points.size(), 7u);
  EXPECT_EQ(mesh.points[3], Vec3(-1, 1, 0));
  EXPECT_EQ(mesh.points[5], Vec3(5, 5, 5)) << "the sparse value";
  EXPECT_EQ(mesh.faces.corners, (std::vector<std::int32_t>{2, 1, 0, 2, 3, 1, 4, 5, 6}))
      << "a mirror turns the strip's triangles round, the second of which turns round by itself";
  EXPECT_EQ(mesh.faces.offsets, (std::vector<std::int32_t>{0, 3, 6, 9}));
}

TEST_F(StrangersFiles, FacesOfTextFormats) {
  const query::MeshPoints mesh =
      read("a.obj", "f 1 2 3 5\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 9 9 9\nv 0 1 0\nl 1 2\nf -1 1 2\n");
  ASSERT_EQ(mesh.points.size(), 4u);
  EXPECT_EQ(mesh.faces.corners, (std::vector<std::int32_t>{0, 1, 2, 3, 3, 0, 1}));
  EXPECT_EQ(mesh.faces.lines, (std::vector<std::int32_t>{1, 8}));
  const query::MeshPoints off = read("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  EXPECT_EQ(off.faces.corners, (std::vector<std::int32_t>{0, 1, 2}));
}

TEST_F(StrangersFiles, MeshesAreRegularFiles) {
  ASSERT_EQ(::mkfifo((path() / "pipe.obj").c_str(), 0600), 0);
  expect(refusal_of((path() / "pipe.obj").string()), "unreadable_file", "not a regular file");
  for (const char* name : {"zero.obj", "zero.gltf", "zero.stl"}) {
    std::filesystem::create_symlink("/dev/zero", path() / name);
    expect(refusal_of((path() / name).string()), "unreadable_file", "not a regular file");
  }
  std::filesystem::create_directory(path() / "folder.ply");
  expect(refusal_of((path() / "folder.ply").string()), "unreadable_file", "not a regular file");
  expect(refusal_of((path() / "none.ply").string()), "unreadable_file", "no such file");
  expect(refusal_of(write("large.obj", std::string((1 << 22) + 1, '\n'))), "limit_exceeded", "bytes");
}

TEST_F(StrangersFiles, CornersAreCountedToo) {
  std::string text = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  for (int i = 0; i < 6000; ++i) text += "f 1 2 3\n";
  expect(refusal("a.obj", text), "limit_exceeded", "corners of faces");
}

TEST_F(StrangersFiles, ByteOrderMarksAndZeroBytesOfText) {
  const std::string mark = "\xEF\xBB\xBF";
  EXPECT_EQ(read("a.obj", mark + "v 1 2 3\nv 4 5 6\n").points.size(), 2u);
  EXPECT_EQ(read("a.off", mark + "OFF\n1 0 0\n1 2 3\n").points.size(), 1u);
  EXPECT_EQ(read("a.stl", mark + "solid\nvertex 1 2 3\nvertex 1 2 4\nvertex 2 2 3\nendsolid\n").points.size(), 3u);
  expect(refusal("a.obj", std::string("v 1 2 3\0 4\n", 11)), "unreadable_file", "three numbers");
}

TEST(DecimalNumber, IsRoundedOnceHoweverLong) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const auto number = [](const std::string& text) {
    double value = 0;
    EXPECT_TRUE(query::parse_decimal(text, value)) << text.substr(0, 40);
    return value;
  };
  const std::string zeros(500, '0'), few(400, '0');
  EXPECT_EQ(number("1" + zeros + "e-100"), kInfinity);
  EXPECT_EQ(number("-1" + zeros + "e-100"), -kInfinity);
  EXPECT_EQ(number("1" + zeros + "e-400"), 1e100);
  EXPECT_EQ(number("0." + few + "1"), 0);
  EXPECT_TRUE(std::signbit(number("-0." + few + "1")));
  EXPECT_EQ(number("0." + few + "1e301"), 1e-100);
  EXPECT_EQ(number("0." + few + "1e99999999999999999999"), kInfinity);
  EXPECT_EQ(number("1" + zeros + "e-99999999999999999999"), 0);
  EXPECT_EQ(number("1E-400"), 0);
  EXPECT_EQ(number("1E400"), kInfinity);
  EXPECT_EQ(number("+2.5"), 2.5);
  EXPECT_EQ(number("9007199254740993"), 9007199254740992.0);
  EXPECT_EQ(number("9007199254740993." + few + "1"), 9007199254740994.0) << "a tie that the last digit breaks";
  EXPECT_EQ(number("2.4703282292062327e-324"), 0);
  EXPECT_EQ(number("2.4703282292062328e-324"), 0x1p-1074);
  EXPECT_EQ(number("1.7976931348623158e308"), std::numeric_limits<double>::max());
  EXPECT_EQ(number("1.7976931348623159e308"), kInfinity);
  double value = 0;
  for (const char* word : {"", "+", "-", "+-1", "--1", "1x", "1 ", "e5", "."}) {
    EXPECT_FALSE(query::parse_decimal(word, value)) << word;
  }
}

class StrangersPoints : public StrangersFiles {
 protected:
  Json kernel(const std::string& file, std::int64_t max_vertices = 1'000'000) {
    query::Limits limits;
    limits.max_vertices = max_vertices;
    return answer(R"({"id":1,"query":"epsilon_kernel","a":{"points_file":")" + file + R"("},"epsilon":0.1})", limits);
  }
  std::string npy(const std::string& shape, const std::string& numbers) {
    std::string header = "{'descr': '<f8', 'fortran_order': False, 'shape': " + shape + ", }";
    header.resize(117, ' ');
    header += '\n';
    return "\x93NUMPY" + std::string("\1\0", 2) + static_cast<char>(header.size()) + '\0' + header + numbers;
  }
};

TEST_F(StrangersPoints, AreRegularFilesWithinTheLimits) {
  ASSERT_EQ(::mkfifo((path() / "pipe").c_str(), 0600), 0);
  for (const std::string& file : {std::string("/dev/zero"), std::string("/dev/stdin"), (path() / "pipe").string()}) {
    const Json refused = kernel(file);
    EXPECT_EQ(code_of(refused), "unreadable_file") << refused;
    EXPECT_NE(refused.dump().find("not a regular file"), std::string::npos) << refused;
  }
  const std::string square = write("p.txt", "0 0\n1 0\n1 1\n0 1\n");
  EXPECT_EQ(code_of(kernel(square, 4)), "");
  EXPECT_EQ(code_of(kernel(square, 3)), "limit_exceeded");
  const std::string numbers = stored<double>({0, 0, 1, 0, 1, 1, 0, 1});
  EXPECT_EQ(code_of(kernel(write("p.npy", npy("(4, 2)", numbers)), 4)), "");
  EXPECT_EQ(code_of(kernel(write("p.npy", npy("(4, 2)", numbers)), 3)), "limit_exceeded");
  // Python's last value of a key counts; the file that says two things is refused.
  const Json twice = kernel(write("p.npy", npy("(2, 2), 'shape': (4, 2)", numbers)));
  EXPECT_EQ(code_of(twice), "unreadable_file") << twice;
  EXPECT_NE(twice.dump().find("names shape twice"), std::string::npos) << twice;
}

TEST_F(StrangersPoints, TablesAndTextAreReadAsTheyStandOrRefused) {
  const std::string numbers = stored<double>({0, 0, 1, 0, 1, 1, 0, 1});
  EXPECT_EQ(code_of(kernel(write("p.npy", npy("(4,2,)", numbers)))), "");
  for (const char* shape : {"(2, 2, 2)", "(8,)", "(8)", "()", "(4, 2", "(-4, 2)", "(4, 0)", "(4, 2x)", "(5, 2)",
                            "(99999999999999999999, 2)", "(4611686018427387904, 4)", "4, 2"}) {
    EXPECT_EQ(code_of(kernel(write("p.npy", npy(shape, numbers)))), "unreadable_file") << shape;
  }
  const std::string rest = "\n1 0\n1 1\n0 1\n";
  EXPECT_EQ(code_of(kernel(write("p.txt", "\xEF\xBB\xBF+0 0" + rest))), "");
  EXPECT_EQ(code_of(kernel(write("p.txt", "0 0." + std::string(400, '0') + "1" + rest))), "");
  EXPECT_EQ(code_of(kernel(write("p.txt", "0 1" + std::string(400, '0') + rest))), "non_finite");
  for (const std::string& bad : {std::string("0 0\0 1", 6), std::string("0 0\0", 4), std::string("0-0"),
                                 std::string("0 +-1"), std::string("0 0x1"), "0 " + std::string(5000, '0')}) {
    EXPECT_EQ(code_of(kernel(write("p.txt", bad + rest))), "unreadable_file") << bad.substr(0, 20);
  }
}

TEST(StrangersDrawings, NestedGroupsAreCounted) {
  const auto nested = [](int depth) {
    std::string text = "<svg xmlns='http://www.w3.org/2000/svg'>";
    for (int i = 0; i < depth; ++i) text += "<g>";
    text += "<rect width='1' height='1'/>";
    for (int i = 0; i < depth; ++i) text += "</g>";
    return text + "</svg>";
  };
  EXPECT_EQ(drawing::read_svg(nested(100), "").rings.size(), 1u);
  for (const int depth : {14'564, 200'000}) {
    try {
      (void)drawing::read_svg(nested(depth), "");
      ADD_FAILURE() << depth;
    } catch (const query::Refusal& refused) {
      EXPECT_EQ(refused.code, "limit_exceeded");
    }
  }
}

}  // namespace
}  // namespace pd::test

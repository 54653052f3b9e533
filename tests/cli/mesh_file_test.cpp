/// @file
/// Mesh files: every format gives the same points, numbers keep the file's precision, unreferenced vertices are
/// ignored.
#include "mesh/mesh_file.hpp"

#include <bit>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "protocol_lines.hpp"
#include "support/refusal.hpp"
#include "temporary_folder.hpp"

namespace pd::test {
namespace {

class MeshFile : public ::testing::Test, protected TemporaryFolder {
 protected:
  query::MeshPoints read(const std::string& name, const std::string& content) {
    return query::read_mesh_points(write(name, content), 1000, 1 << 20);
  }
  std::string refusal(const std::string& name, const std::string& content) {
    try {
      (void)read(name, content);
    } catch (const query::Refusal& refused) {
      return refused.code;
    }
    return "";
  }
};

template <class T>
std::string bytes_of(T value, bool big_endian = false) {
  std::string bytes(sizeof(T), '\0');
  std::memcpy(bytes.data(), &value, sizeof(T));
  static_assert(std::endian::native == std::endian::little);
  return big_endian ? std::string(bytes.rbegin(), bytes.rend()) : bytes;
}

/// A tetrahedron whose coordinates no float holds.
const Vec3 kCorners[] = {{0.1, 0.2, 0.3}, {1.1, 0, 0}, {0, 1.7, 0}, {0, 0, 2.3}};

void expect_tetrahedron(const query::MeshPoints& mesh) {
  ASSERT_EQ(mesh.points.size(), 4u);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(mesh.points[i], kCorners[i]) << i;
}

TEST_F(MeshFile, Obj) {
  const query::MeshPoints mesh = read("a.obj", R"(# a comment
mtllib none.mtl
v 0.1 0.2 0.3
v 9 9 9
v 1.1 0 0 1 # with a weight
v 0 17e-1 0 0.5 0.5 0.5
vt 0 0
vn 0 0 1
v 0 \
  0 2.3
usemtl none
f 1/1/1 3//1 4
f -1 -2 -3
)");
  expect_tetrahedron(mesh);
  EXPECT_EQ(mesh.ids, (std::vector<std::int32_t>{0, 2, 3, 4}))
      << "the unreferenced vertex is gone, the ids are the file's";
}

TEST_F(MeshFile, ObjWithoutElementsIsAPointCloud) {
  expect_tetrahedron(read("a.OBJ", "v 0.1 0.2 0.3\r\nv 1.1 0 0\r\nv 0 1.7 0\r\nv 0 0 2.3"));
}

TEST_F(MeshFile, BadObj) {
  EXPECT_EQ(refusal("a.obj", "v 0 0\n"), "unreadable_file");
  EXPECT_EQ(refusal("a.obj", "v 0 0 x\n"), "unreadable_file");
  EXPECT_EQ(refusal("a.obj", "v 0 0 0\nf 1 2 3\n"), "unreadable_file");
  EXPECT_EQ(refusal("a.obj", "v 0 0 0\nf 0\n"), "unreadable_file");
  EXPECT_EQ(refusal("a.obj", "v 0 0 0\nf -2\n"), "unreadable_file");
  EXPECT_EQ(refusal("a.obj", ""), "unreadable_file");
  EXPECT_EQ(refusal("a.obj", "hello\n"), "unreadable_file");
  EXPECT_EQ(refusal("a.txt", "0 0 0\n"), "unreadable_file");
}

TEST_F(MeshFile, Off) {
  const std::string body =
      "5 2 0\n# points\n0.1 0.2 0.3\n1.1 0 0\n0 1.7 0\n0 0 2.3 # high\n9 9 9\n3 0 1 2\n3 1 2 3 255 0 0\n";
  const query::MeshPoints mesh = read("a.off", "OFF\n" + body);
  expect_tetrahedron(mesh);
  EXPECT_EQ(mesh.ids, (std::vector<std::int32_t>{0, 1, 2, 3}));
  expect_tetrahedron(read("b.off", "COFF " + body));
  EXPECT_EQ(refusal("c.off", "OFF\n2 0 0\n0 0 0\n"), "unreadable_file");
  EXPECT_EQ(refusal("c.off", "OFF BINARY\n"), "unreadable_file");
  EXPECT_EQ(refusal("c.off", "OFF\n1 1 0\n0 0 0\n3 0 1 2\n"), "unreadable_file");
  EXPECT_EQ(refusal("c.off", "OFF\n100000 1 0\n"), "limit_exceeded");
  EXPECT_EQ(refusal("c.off", "PLY\n"), "unreadable_file");
}

const char* const kPlyHeader = R"(element vertex 5
property double x
property double y
property double z
property uchar red
element face 2
property list uchar int vertex_indices
end_header
)";

TEST_F(MeshFile, PlyText) {
  const query::MeshPoints mesh =
      read("a.ply", std::string("ply\nformat ascii 1.0\ncomment x\n") + kPlyHeader +
                        "0.1 0.2 0.3 1\n9 9 9 1\n1.1 0 0 1\n0 1.7 0 1\n0 0 2.3 1\n3 0 2 3\n3 2 3 4\n");
  expect_tetrahedron(mesh);
  EXPECT_EQ(mesh.ids, (std::vector<std::int32_t>{0, 2, 3, 4}));
}

TEST_F(MeshFile, PlyBinaryKeepsDoubles) {
  for (const bool big : {false, true}) {
    std::string content = std::string("ply\nformat binary_") + (big ? "big" : "little") + "_endian 1.0\n" + kPlyHeader;
    for (const Vec3& p : {kCorners[0], Vec3(9, 9, 9), kCorners[1], kCorners[2], kCorners[3]}) {
      for (int k = 0; k < 3; ++k) content += bytes_of(p[k], big);
      content += '\7';
    }
    for (const auto& face : {std::array{0, 2, 3}, std::array{2, 3, 4}}) {
      content += '\3';
      for (const int index : face) content += bytes_of(index, big);
    }
    const query::MeshPoints mesh = read("a.ply", content);
    expect_tetrahedron(mesh);
    EXPECT_EQ(mesh.ids, (std::vector<std::int32_t>{0, 2, 3, 4}));
    EXPECT_EQ(refusal("b.ply", content.substr(0, content.size() - 1)), "unreadable_file");
  }
}

TEST_F(MeshFile, BadPly) {
  EXPECT_EQ(refusal("a.ply", "ply\n"), "unreadable_file");
  EXPECT_EQ(refusal("a.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n1\n"),
            "unreadable_file");
  EXPECT_EQ(refusal("a.ply", "ply\nformat odd 1.0\nend_header\n"), "unreadable_file");
  EXPECT_EQ(refusal("a.ply", std::string("ply\nformat ascii 1.0\n") + kPlyHeader + "1 2 3 4\n"), "unreadable_file");
}

TEST_F(MeshFile, StlTextAndBinary) {
  const query::MeshPoints text = read("a.stl", R"(solid part
 facet normal 0 0 0
  outer loop
   vertex 0.1 0.2 0.3
   vertex 1.1 0 0
   vertex 0 1.7 0
  endloop
 endfacet
endsolid part
)");
  ASSERT_EQ(text.points.size(), 3u);
  EXPECT_EQ(text.points[0], kCorners[0]);
  const query::MeshPoints capitals =
      read("c.stl",
           "SOLID X\nFACET NORMAL 0 0 0\nOUTER LOOP\nVERTEX 0.1 0.2 0.3\nVERTEX 1.1 0 0\nVertex 0 1.7 0\nENDLOOP\n"
           "ENDFACET\nENDSOLID X\n");
  EXPECT_EQ(capitals.points, text.points);
  EXPECT_EQ(capitals.faces.size(), 1u);
  std::string binary(80, 's');
  binary.replace(0, 5, "solid");
  binary += bytes_of(std::uint32_t{1});
  for (const float f : {0.f, 0.f, 1.f, 0.1f, 0.2f, 0.3f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f}) binary += bytes_of(f);
  binary += std::string(2, '\0');
  const query::MeshPoints mesh = read("b.stl", binary);
  ASSERT_EQ(mesh.points.size(), 3u);
  EXPECT_EQ(mesh.points[0], Vec3(double{0.1f}, double{0.2f}, double{0.3f}));
  EXPECT_EQ(refusal("c.stl", binary.substr(0, 100)), "unreadable_file");
  EXPECT_EQ(refusal("c.stl", "solid x\nvertex 1 2 3\n"), "unreadable_file");
  EXPECT_EQ(refusal("c.stl", "nothing"), "unreadable_file");
}

TEST_F(MeshFile, GltfAppliesNodeTransforms) {
  std::string buffer;
  for (const float f : {0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f}) buffer += bytes_of(f);
  write("triangle.bin", buffer);
  const query::MeshPoints mesh = read("scene.gltf", R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0,2]}],
    "nodes":[{"children":[1],"translation":[10,0,0]},{"mesh":0,"scale":[2,2,2]},{"mesh":0,"translation":[0,0,5]}],
    "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
    "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}],
    "bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[{"uri":"triangle.bin","byteLength":36}]})");
  ASSERT_EQ(mesh.points.size(), 6u) << "the mesh stands in two nodes";
  EXPECT_EQ(mesh.points[1], Vec3(12, 0, 0)) << "a child's scale and its parent's translation";
  EXPECT_EQ(mesh.points[3], Vec3(0, 0, 5));
  EXPECT_EQ(refusal("bad.gltf", "{"), "unreadable_file");
  // Its name says what a file is, not its first bytes.
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  EXPECT_EQ(read("triangle.ply", ply).points.size(), 3u);
  EXPECT_EQ(refusal("triangle.glb", ply), "unreadable_file");
  EXPECT_EQ(refusal("triangle.gltf", ply), "unreadable_file");
}

TEST_F(MeshFile, ShapesNameTheFilesVertices) {
  const std::string path = write("a.obj", "v 7 7 7\nv 0 0 0\nv 2 0 0\nv 0 2 0\nv 0 0 2\nf 2 3 4\nf 3 4 5\n");
  const Json reply = answer(R"({"id":1,"query":"hull","a":{"type":"mesh","path":")" + path + "\"}}");
  EXPECT_EQ(reply.at("vertices").size(), 4u);
  std::vector<int> ids = reply.at("vertex_ids");
  std::sort(ids.begin(), ids.end());
  EXPECT_EQ(ids, (std::vector<int>{1, 2, 3, 4}));
}

TEST_F(MeshFile, InfiniteCoordinatesAreRefusedByName) {
  const std::string path = write("a.obj", "v 0 0 0\nv 1e999 0 0\n");
  const Json reply = answer(R"({"id":1,"query":"hull","a":{"type":"mesh","path":")" + path + "\"}}");
  EXPECT_EQ(code_of(reply), "non_finite");
  EXPECT_EQ(where_of(reply), "a.path");
}

TEST_F(MeshFile, VertexLimit) {
  const std::string path = write("a.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\n");
  query::Limits limits;
  limits.max_vertices = 2;
  const Json reply = answer(R"({"id":1,"query":"hull","a":{"type":"mesh","path":")" + path + "\"}}", limits);
  EXPECT_EQ(code_of(reply), "limit_exceeded");
}

}  // namespace
}  // namespace pd::test

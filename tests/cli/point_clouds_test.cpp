/// @file
/// Files of points without faces: XYZ and PCD. What is left out is counted, and what is not read is refused by name.
#include <cstring>
#include <filesystem>

#include "mesh/mesh_file.hpp"
#include "protocol_lines.hpp"
#include "support/refusal.hpp"
#include "temporary_folder.hpp"

namespace pd::test {
namespace {

class PointClouds : public ::testing::Test, protected TemporaryFolder {
 protected:
  query::MeshPoints read(const std::string& name, const std::string& content) {
    return query::read_mesh_points(write(name, content), 100, 1 << 20);
  }
  std::string refusal(const std::string& name, const std::string& content) {
    try {
      (void)read(name, content);
    } catch (const query::Refusal& refused) {
      return refused.code + ": " + refused.message.substr(refused.message.rfind('/') + 1);
    }
    return "";
  }
};

const std::vector<Vec3> kCorners = {{0.1, 0.2, 0.3}, {1.1, 0, 0}, {0, 1.7, 0}, {0, 0, 2.3}};

std::string pcd_head(const std::string& sizes, const std::string& types, int points, const std::string& data) {
  return "# .PCD v0.7\nVERSION 0.7\nFIELDS intensity x y z normal\nSIZE 2 " + sizes + " 4\nTYPE U " + types +
         " F\nCOUNT 1 1 1 1 3\nWIDTH " + std::to_string(points) + "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " +
         std::to_string(points) + "\nDATA " + data + "\n";
}

template <class T>
void append(std::string& bytes, T value) {
  char raw[sizeof(T)];
  std::memcpy(raw, &value, sizeof(T));
  bytes.append(raw, sizeof(T));
}

TEST_F(PointClouds, RowsOfNumbersSeparatedInEveryUsualWay) {
  const query::MeshPoints mesh =
      read("a.XYZ", "# scan\n//X Y Z R G B\n4\n0.1 0.2 0.3 255 0 0\n1.1,0,0\n\n  0;1.7;0\r\n0\t0\t23e-1\n");
  EXPECT_EQ(mesh.points, kCorners);
  EXPECT_EQ(mesh.faces.size(), 0);
  EXPECT_EQ(mesh.left_out, 0);
}

TEST_F(PointClouds, RowsThatAreNoPointsAreRefusedByLine) {
  EXPECT_EQ(refusal("a.xyz", "0 0 0\nC 1 2 3\n"),
            "unreadable_file: a.xyz: line 2: a point needs three numbers: x, y, z; what follows them is not read");
  EXPECT_EQ(refusal("b.xyz", "0 0 0\n1 2\n").substr(0, 31), "unreadable_file: b.xyz: line 2:");
  EXPECT_EQ(refusal("c.xyz", "3\n0 0 0\n1 1 1\n"), "unreadable_file: c.xyz: the first row says 3 points, and 2 follow");
  EXPECT_EQ(refusal("d.xyz", "101\n").substr(0, 15), "limit_exceeded:");
  EXPECT_EQ(refusal("e.xyz", "# nothing\n"), "unreadable_file: e.xyz: the file holds no vertices");
}

TEST_F(PointClouds, CloudsAsText) {
  const query::MeshPoints mesh = read("a.pcd", pcd_head("8 8 8", "F F F", 4, "ascii") +
                                                   "7 0.1 0.2 0.3 0 0 1\n7 1.1 0 0 0 0 1\n7 0 1.7 0 0 0 1\n"
                                                   "7 0 0 2.3 0 0 1\n");
  EXPECT_EQ(mesh.points, kCorners);
}

TEST_F(PointClouds, CloudsAsBytesAndPlacesWithoutMeasurement) {
  std::string bytes = pcd_head("8 4 8", "F F F", 3, "binary");
  for (const double x : {0.1, std::nan(""), 1.1}) {
    append(bytes, std::uint16_t{7});
    append(bytes, x);
    append(bytes, std::isnan(x) ? std::nanf("") : 0.5F);
    append(bytes, std::isnan(x) ? x : 0.3);
    for (const float n : {0.F, 0.F, 1.F}) append(bytes, n);
  }
  const query::MeshPoints mesh = read("a.pcd", bytes);
  EXPECT_EQ(mesh.points, (std::vector<Vec3>{{0.1, 0.5, 0.3}, {1.1, 0.5, 0.3}}));
  EXPECT_EQ(mesh.ids, (std::vector<std::int32_t>{0, 2}));
  EXPECT_EQ(mesh.left_out, 1);
  bytes.pop_back();
  EXPECT_EQ(refusal("b.pcd", bytes), "unreadable_file: b.pcd: the file ends too early");
}

TEST_F(PointClouds, CloudsThatAreNotReadAreRefusedByName) {
  EXPECT_EQ(refusal("a.pcd", pcd_head("4 4 4", "F F F", 4, "binary_compressed")),
            "unsupported: a.pcd: DATA binary_compressed is not read: save the cloud as ascii or binary");
  EXPECT_EQ(refusal("b.pcd", "VERSION 0.7\nFIELDS x y\nSIZE 4 4\nTYPE F F\nCOUNT 1 1\nPOINTS 1\nDATA ascii\n0 0\n"),
            "unreadable_file: b.pcd: the points have no field z of one number");
  EXPECT_EQ(refusal("c.pcd", pcd_head("4 4 3", "F F F", 4, "ascii")),
            "unreadable_file: c.pcd: the field z has no number of its TYPE and SIZE");
  EXPECT_EQ(refusal("d.pcd", pcd_head("4 4 4", "F F F", 101, "ascii")).substr(0, 15), "limit_exceeded:");
  EXPECT_EQ(refusal("e.pcd", pcd_head("4 4 4", "F F F", 0, "ascii")),
            "unreadable_file: e.pcd: line 10: POINTS needs whole numbers from 1 to 2^40");
  EXPECT_EQ(refusal("f.pcd", "solid\n"), "unreadable_file: f.pcd: line 1: no line of a PCD header begins with solid");
  EXPECT_EQ(refusal("g.pcd", "SIZE 8 8 8\nFIELDS x y z\n"),
            "unreadable_file: g.pcd: line 1: SIZE stands before FIELDS");
  EXPECT_EQ(refusal("h.pcd", "FIELDS x y z\nFIELDS x\n"), "unreadable_file: h.pcd: line 2: a second FIELDS line");
  std::string names = "FIELDS";
  for (int i = 0; i <= 1024; ++i) names += " x";
  EXPECT_EQ(refusal("i.pcd", names + "\n"), "limit_exceeded: i.pcd: the points have more than 1024 fields");
}

TEST_F(PointClouds, AnAnswerSaysHowManyPointsAreLeftOut) {
  const std::string rows = "nan nan nan\n0 0 0\n1 0 0\nnan nan nan\n0 1 0\n0 0 1\n";
  const std::string cloud = R"({"type":"mesh","path":")" + write("a.xyz", rows) + "\"}";
  for (const std::string& body : {cloud, R"({"type":"compound","parts":[{"shape":)" + cloud + "}]}"}) {
    const Json found = answer(depth_line(kUnitBox, body));
    EXPECT_EQ(found.value("b_is", ""), "hull") << found;
    EXPECT_EQ(found.value("b_points_left_out", 0), 2) << found;
    EXPECT_FALSE(found.contains("a_points_left_out")) << found;
  }
}

TEST_F(PointClouds, ACloudThatComesWithoutANameIsKnownByItsFirstBytes) {
  EXPECT_EQ(query::read_mesh_bytes(pcd_head("8 8 8", "F F F", 1, "ascii") + "7 0.1 0.2 0.3 0 0 1\n", 100).points,
            (std::vector<Vec3>{kCorners[0]}));
}

}  // namespace
}  // namespace pd::test

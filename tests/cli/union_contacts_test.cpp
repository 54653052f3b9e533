/// @file
/// contact_manifold of meshes as sheets of triangles, and of compounds: points, normals, pieces and what was covered.
#include <string>

#include "protocol_lines.hpp"
#include "temporary_folder.hpp"

namespace pd::test {
namespace {

constexpr const char* kSmallBox = R"({"type":"box","half_extents":[0.2,0.2,0.2]})";

class UnionContacts : public testing::Test {
 protected:
  UnionContacts() {
    // Four squares of two triangles each and, at the end, a quadrilateral wall at y = 2.
    std::string text;
    for (int i = 0; i <= 2; ++i) {
      for (int j = 0; j <= 2; ++j) text += "v " + std::to_string(i - 1) + " " + std::to_string(j - 1) + " 0\n";
    }
    for (const int corner : {1, 2, 4, 5}) {
      const auto number = [&](int off) { return std::to_string(corner + off) + " "; };
      text += "f " + number(0) + number(3) + number(4) + "\nf " + number(0) + number(4) + number(1) + "\n";
    }
    text += "v -1 2 0\nv 1 2 0\nv 1 2 1\nv -1 2 1\nf 10 11 12 13\n";
    floor_ = folder_.write("floor.obj", text);
  }
  [[nodiscard]] std::string sheet(const std::string& more = "") const {
    return R"({"type":"mesh","as":"sheet","path":")" + floor_ + "\"" + more + "}";
  }
  static Json contacts(const std::string& a, const std::string& b, const std::string& more = "") {
    return answer(R"({"id":1,"query":"contact_manifold","a":)" + a + R"(,"b":)" + b + (more.empty() ? "" : "," + more) +
                  "}");
  }

  TemporaryFolder folder_;
  std::string floor_;
};

TEST_F(UnionContacts, ABoxOverInnerEdgesOfASheetStandsOnIt) {
  // Its left side stands just beyond the edge at x = 0.
  const Json found = contacts(kSmallBox, sheet(), R"("pose_a":{"translation":[-0.19999,0.1,0.1999]})");
  ASSERT_EQ(found.value("points", Json()).size(), 4U) << found;
  EXPECT_EQ(found["normal"], Json({0.0, 0.0, 1.0}));
  EXPECT_GT(found["covered"], 0);
  EXPECT_EQ(found["b_is"], "sheet");
  EXPECT_EQ(found["patches"].size(), 1U);
  EXPECT_EQ(found["patches"][0]["points"], found["points"]);
  for (const Json& point : found["points"]) {
    EXPECT_NEAR(point["depth"].get<double>(), 1e-4, 1e-12);
    EXPECT_EQ(point["piece_a"], 0);
    EXPECT_LT(point["piece_b"], 8);
    EXPECT_EQ(point["normal"], Json({0.0, 0.0, 1.0}));
  }
}

TEST_F(UnionContacts, FacesAreNumberedAsInTheFile) {
  const Json found = contacts(kSmallBox, sheet(), R"("pose_a":{"translation":[0,1.81,0.5]})");
  ASSERT_FALSE(found.value("points", Json::array()).empty()) << found;
  EXPECT_EQ(found["part_b"], 8);
  for (const Json& point : found["points"]) EXPECT_EQ(point["piece_b"], 8);
}

TEST_F(UnionContacts, OneSideOrTwo) {
  const std::string pose = R"("pose_a":{"translation":[0.3,0.3,-0.1]})";
  EXPECT_EQ(contacts(kSmallBox, sheet(), pose)["normal"], Json({0.0, 0.0, -1.0}));
  EXPECT_EQ(contacts(kSmallBox, sheet(), pose + R"(,"one_sided":true)")["normal"], Json({0.0, 0.0, 1.0}));
  const Json none = contacts(kSmallBox, sheet(), R"("pose_a":{"translation":[0.3,0.3,5]})");
  EXPECT_TRUE(none["normal"].is_null());
  EXPECT_TRUE(none["points"].empty());
  EXPECT_FALSE(none.contains("part_b"));
}

TEST_F(UnionContacts, ACompoundIsOneBody) {
  const auto part = [](double x) {
    return R"({"shape":{"type":"box","half_extents":[0.5,1,0.5]},"pose":{"translation":[)" + std::to_string(x) +
           R"(,0,-0.5]}})";
  };
  const std::string slab = R"({"type":"compound","parts":[)" + part(-0.5) + "," + part(0.5) + "]}";
  const Json found = contacts(kSmallBox, slab, R"("pose_a":{"translation":[-0.195,0,0.19]})");
  ASSERT_EQ(found.value("points", Json()).size(), 4U) << found;
  EXPECT_EQ(found["covered"], 1);
  for (const Json& point : found["points"]) {
    EXPECT_EQ(point["normal"], Json({0.0, 0.0, 1.0}));
    EXPECT_NEAR(point["depth"].get<double>(), 0.01, 1e-12);
  }
  // Apart, the parts that are nearest are named.
  const Json apart = contacts(kSmallBox, slab, R"("pose_a":{"translation":[0.4,0,3]})");
  EXPECT_TRUE(apart["points"].empty());
  EXPECT_EQ(apart["part_b"], 1);
  EXPECT_EQ(apart["normal"], Json({0.0, 0.0, 1.0}));
}

TEST_F(UnionContacts, BadInputIsRefusedByName) {
  const auto refusal = [](const Json& found) { return code_of(found) + " " + where_of(found); };
  EXPECT_EQ(refusal(contacts(sheet(), sheet())), "unsupported a");
  EXPECT_EQ(refusal(contacts(kSmallBox, kSmallBox, R"("one_sided":true)")), "unsupported one_sided");
  EXPECT_EQ(refusal(contacts(kSmallBox, sheet(), R"("one_sided":1)")), "bad_value one_sided");
  EXPECT_EQ(refusal(contacts(kSmallBox, sheet(R"(,"turn_faces":true)"))), "bad_value b.turn_faces");
  EXPECT_EQ(refusal(contacts(kSmallBox, sheet(R"(,"margin":-1)"))), "bad_value b.margin");
  EXPECT_EQ(refusal(contacts(kSmallBox, sheet(), R"("breaking_threshold":-1)")), "bad_value breaking_threshold");
  EXPECT_EQ(refusal(answer(depth_line(kSmallBox, sheet()))), "unsupported b.as");
  EXPECT_EQ(refusal(contacts(kSmallBox, R"({"type":"compound","parts":[{"shape":)" + sheet() + "}]}")),
            "unsupported b.parts[0].shape.as");
  const std::string points = folder_.write("points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n");
  EXPECT_EQ(refusal(contacts(kSmallBox, R"({"type":"mesh","as":"sheet","path":")" + points + "\"}")),
            "too_few_points b.path");
  EXPECT_EQ(code_of(answer(R"({"query":"contact_manifold","a":)" + std::string(kSmallBox) + R"(,"b":)" + sheet() + "}",
                           {.files = false})),
            "unreadable_file");
}

}  // namespace
}  // namespace pd::test

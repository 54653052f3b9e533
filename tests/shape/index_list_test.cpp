/// Lists of indices of 1, 2 and 4 bytes: what is written is read again, at the borders of every width, too; and hulls
/// whose surfaces are stored in them.
#include "pd/shape/index_list.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "pd/shape/convex_polytope.hpp"
#include "pd/shape/verify.hpp"
#include "shape/point_clouds.hpp"

namespace pd {
namespace {

ConvexPolytope hull(const test::Points& points) {
  const Expected<ConvexPolytope> built = ConvexPolytope::from_points(points);
  EXPECT_TRUE(built.has_value());
  EXPECT_EQ(verify_polytope(*built), "");
  return *built;
}

TEST(IndexWidth, IsTheLeastThatHoldsTheIndices) {
  EXPECT_EQ(IndexWidth::up_to(0).bytes(), 1U);
  EXPECT_EQ(IndexWidth::up_to(0xFF).bytes(), 1U);
  EXPECT_EQ(IndexWidth::up_to(0x100).bytes(), 2U);
  EXPECT_EQ(IndexWidth::up_to(0xFFFF).bytes(), 2U);
  EXPECT_EQ(IndexWidth::up_to(0x10000).bytes(), 4U);
  EXPECT_EQ(IndexWidth().bytes(), 4U);
}

TEST(IndexList, GivesBackWhatWasWrittenInAnyOrder) {
  for (const std::int32_t most : {0xFF, 0xFFFF, 0x7FFFFFFF}) {
    const IndexWidth width = IndexWidth::up_to(most);
    const std::vector<std::int32_t> wanted = {most, 0, 1, most - 1, most / 2, 7};
    const auto count = static_cast<std::int32_t>(wanted.size());
    // A read must not see the bytes behind the list.
    std::vector<std::byte> bytes(wanted.size() * width.bytes() + IndexWidth::kReadableBehind, std::byte{0xAB});
    for (std::size_t i = wanted.size(); i-- > 0;) width.write(bytes.data(), i, wanted[i]);
    for (std::size_t i = 0; i < IndexWidth::kReadableBehind; ++i) {
      EXPECT_EQ(bytes[wanted.size() * width.bytes() + i], std::byte{0xAB});
    }

    const IndexList list(bytes.data(), 0, count, width);
    ASSERT_EQ(list.size(), wanted.size());
    EXPECT_EQ(std::vector<std::int32_t>(list.begin(), list.end()), wanted);
    for (std::size_t i = 0; i < wanted.size(); ++i) EXPECT_EQ(list[i], wanted[i]);
    EXPECT_EQ(list.front(), most);
    EXPECT_EQ(list.back(), 7);

    const IndexList part(bytes.data(), 2, 4, width);
    EXPECT_EQ(std::vector<std::int32_t>(part.begin(), part.end()), (std::vector<std::int32_t>{1, most - 1}));
    EXPECT_TRUE(IndexList(bytes.data(), 3, 3, width).empty());
  }
}

TEST(IndexList, FourBytesHoldMinusOne) {
  std::byte bytes[8 + IndexWidth::kReadableBehind] = {};
  const IndexWidth width;
  width.write(bytes, 0, -1);
  width.write(bytes, 1, 5);
  EXPECT_EQ(width.read(bytes, 0), -1);
  EXPECT_EQ(width.read(bytes, 1), 5);
}

TEST(IndexList, TakesAsFewBytesAsAHullNeeds) {
  // Bodies of 30 vertices: 56 facets and 168 half-edges, of which three lists of one byte each.
  EXPECT_LE(hull(test::sphere_cloud(30, 6)).memory_bytes(), 3300U);
  EXPECT_LE(hull(test::sphere_cloud(8, 6)).memory_bytes(), 1650U);
  // 6 V - 12 half-edges: 252 and 258, 65,532 and 65,538. Every one of them is verified.
  for (const int vertices : {44, 45, 10924, 10925}) {
    const ConvexPolytope p = hull(test::sphere_cloud(vertices, 7));
    ASSERT_EQ(p.num_half_edges(), 6 * vertices - 12);
    EXPECT_EQ(p.storage().width.bytes(), vertices == 44 ? 1U : vertices == 10925 ? 4U : 2U);
    for (int h = 0; h < p.num_half_edges(); ++h) ASSERT_EQ(p.half_edge(p.half_edge(h).twin).origin, p.target(h));
  }
}

TEST(IndexList, HoldsCallersIdsOfAnySize) {
  test::Points points(70000, Vec3::Zero());
  const std::size_t ids[] = {3, 255, 256, 65535, 65536, 69999};
  const test::Points corners = test::sphere_cloud(6, 8);
  for (std::size_t i = 0; i < corners.size(); ++i) points[ids[i]] = corners[i];
  const ConvexPolytope p = hull(points);
  for (int v = 0; v < p.num_vertices(); ++v) {
    EXPECT_EQ(p.vertex(v), points[static_cast<std::size_t>(p.caller_id(v))]);
  }
}

}  // namespace
}  // namespace pd

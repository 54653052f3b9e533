/// Lists of indices of 1, 2 and 4 bytes: what is written is read again, at the borders of every width, too.
#include "pd/shape/index_list.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace pd {
namespace {

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
    // What lies behind the list must not be seen.
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

}  // namespace
}  // namespace pd

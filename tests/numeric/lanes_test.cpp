// Masks of lanes: of signs as of flags, on machines with and without instructions for them.
#include "numeric/lanes.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace pd::detail {
namespace {

TEST(Lanes, MasksTellSigns) {
  constexpr std::int32_t kNegative = std::numeric_limits<std::int32_t>::min();
  for (unsigned mask = 0; mask < 256; ++mask) {
    Ids signs, flags;
    // Other bits than the sign's, all or none of them, say nothing.
    for (int i = 0; i < kFloats; ++i) {
      const bool set = (mask >> i & 1U) != 0;
      signs[i] = set ? kNegative : std::numeric_limits<std::int32_t>::max();
      flags[i] = set ? -1 : 0;
    }
    EXPECT_EQ(mask_of_eight(signs), mask);
    EXPECT_EQ(mask_of_eight(flags), mask);
    const Flags wide = {signs[0] < 0 ? -1 : 0, signs[1] < 0 ? -1 : 0, signs[2] < 0 ? -1 : 0, signs[3] < 0 ? -1 : 0};
    EXPECT_EQ(mask_of_four(wide), mask & 15U);
  }
}

}  // namespace
}  // namespace pd::detail

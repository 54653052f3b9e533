/// @file
/// Unions of random parts leave gaps as narrow as a blade. The way out may end in one, and the stored translation must
/// lie in it: not beyond the next piece, up to eight times as far.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "pd/compound/compound_depth.hpp"
#include "pd/depth/scratch.hpp"
#include "scenes/shape_families.hpp"

namespace pd {
namespace {

Vec3 in_cube(scenes::Random& random) {
  const double x = random.uniform(-1, 1), y = random.uniform(-1, 1), z = random.uniform(-1, 1);
  return {x, y, z};
}

Compound random_parts(int count, scenes::Random& random) {
  std::vector<Compound::Part> parts;
  for (int k = 0; k < count; ++k) {
    const Vec3 centre = in_cube(random);
    std::vector<Vec3> points;
    for (int i = 0; i < 8; ++i) points.emplace_back(centre + 0.7 * in_cube(random));
    parts.push_back({*ConvexPolytope::from_points(points), Pose()});
  }
  return *Compound::from_parts(std::move(parts));
}

TEST(NarrowGaps, TheTranslationEndsInTheGap) {
  // The pairs among the first 900 whose translation went beyond the gap.
  constexpr std::array<int, 7> kNarrow = {20, 26, 518, 728, 751, 804, 813};
  scenes::Random random(7);
  Scratch scratch;
  int asked = 0;
  for (int pair = 0; pair <= kNarrow.back(); ++pair) {
    const Compound a = random_parts(4, random), b = random_parts(4, random);
    const std::array<double, 4> turn = random.quaternion();
    const Pose pose = *Pose::from_quaternion(turn, in_cube(random));
    if (std::find(kNarrow.begin(), kNarrow.end(), pair) == kNarrow.end()) continue;
    const UnionDepth depth = *penetration_depth({&a, Pose()}, {&b, pose}, scratch);
    ASSERT_EQ(depth.contact, ContactClass::overlapping) << pair;
    EXPECT_TRUE(depth.bracket_reached) << pair;
    EXPECT_LE(depth.upper, (1 + 1e-12) * depth.lower) << pair;
    EXPECT_NE(*point_in_difference({&a, Pose()}, {&b, pose}, depth.translation, scratch), ContactClass::overlapping)
        << pair;
    ++asked;
  }
  EXPECT_EQ(asked, static_cast<int>(kNarrow.size()));
}

}  // namespace
}  // namespace pd

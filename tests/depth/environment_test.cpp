// A host's rounding mode and flushed subnormals must neither change an answer nor be changed by one.
#include <gtest/gtest.h>

#include <cfenv>
#include <cstring>
#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

#include "pd/depth/penetration_depth.hpp"
#include "pd/depth/scratch.hpp"

namespace {

using pd::Bracket;
using pd::ConvexPolytope;
using pd::ConvexShape;
using pd::PenetrationDepth;
using pd::Pose;
using pd::Vec3;

PenetrationDepth solve(Bracket bracket) {
  const ConvexShape a(ConvexPolytope::box(Vec3(1, 1.5, 0.7)).value());
  const ConvexShape b(ConvexPolytope::box(Vec3(0.3, 0.9, 1.1)).value());
  const Pose pose = Pose::from_quaternion({0.6, 0.48, 0.64, 0.0}, Vec3(0.9, 0.4, 0.3)).value();
  pd::Scratch scratch;
  pd::DepthSettings settings;
  settings.bracket = bracket;
  return penetration_depth({&a, Pose()}, {&b, pose}, scratch, settings);
}

void expect_same(const PenetrationDepth& x, const PenetrationDepth& y) {
  EXPECT_EQ(x.contact, y.contact);
  EXPECT_EQ(x.lower, y.lower);
  EXPECT_EQ(x.upper, y.upper);
  EXPECT_EQ(x.translation, y.translation);
  EXPECT_EQ(x.witness_a, y.witness_a);
}

TEST(Environment, RoundingModeOfTheHostIsGuarded) {
  for (const Bracket bracket : {Bracket::certified, Bracket::tightest}) {
    const PenetrationDepth expected = solve(bracket);
    ASSERT_EQ(expected.contact, pd::ContactClass::overlapping);
    // Shapes and poses are built under the default mode, as the host's scene was.
    const ConvexShape a(ConvexPolytope::box(Vec3(1, 1.5, 0.7)).value());
    const ConvexShape b(ConvexPolytope::box(Vec3(0.3, 0.9, 1.1)).value());
    const Pose pose = Pose::from_quaternion({0.6, 0.48, 0.64, 0.0}, Vec3(0.9, 0.4, 0.3)).value();
    pd::Scratch scratch;
    pd::DepthSettings settings;
    settings.bracket = bracket;
    for (const int mode : {FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO}) {
      ASSERT_EQ(std::fesetround(mode), 0);
      const PenetrationDepth answer = penetration_depth({&a, Pose()}, {&b, pose}, scratch, settings);
      const int after = std::fegetround();
      std::fesetround(FE_TONEAREST);
      EXPECT_EQ(after, mode);
      expect_same(answer, expected);
    }
  }
}

#if defined(__SSE2__)
TEST(Environment, FlushedSubnormalsOfTheHostAreGuarded) {
  const PenetrationDepth expected = solve(Bracket::tightest);
  const unsigned before = _mm_getcsr();
  _mm_setcsr(before | 0x8040u);
  const PenetrationDepth answer = solve(Bracket::tightest);
  const unsigned after = _mm_getcsr();
  _mm_setcsr(before);
  EXPECT_EQ(after & 0x8040u, 0x8040u);
  expect_same(answer, expected);
}
#endif

TEST(Environment, NoNegativeZeroIsAnswered) {
  const ConvexShape cube(ConvexPolytope::box(Vec3(1, 1, 1)).value());
  const Pose pose = Pose::from_quaternion({1, 0, 0, 0}, Vec3(1.5, 0, 0)).value();
  pd::Scratch scratch;
  for (const PenetrationDepth& answer : {penetration_depth({&cube, Pose()}, {&cube, pose}, scratch),
                                         penetration_depth({&cube, pose}, {&cube, Pose()}, scratch)}) {
    for (int i = 0; i < 3; ++i) {
      EXPECT_FALSE(answer.normal[i] == 0 && std::signbit(answer.normal[i]));
      EXPECT_FALSE(answer.translation[i] == 0 && std::signbit(answer.translation[i]));
    }
  }
}

}  // namespace

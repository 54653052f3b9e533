// A refusal whose value is read throws, in every build, and says what was refused.
#include "pd/numeric/expected.hpp"

#include <gtest/gtest.h>

#include <string>

#include "pd/shape/convex_polytope.hpp"

namespace {

using pd::ConvexPolytope;
using pd::ErrorCode;
using pd::Expected;
using pd::Vec3;

TEST(Expected, TheValueOfARefusalThrowsItsReason) {
  const Expected<ConvexPolytope> refused = ConvexPolytope::box(Vec3(-1, 1, 1));
  ASSERT_FALSE(refused);
  const auto reads = {+[](const Expected<ConvexPolytope>& e) { return e.value().num_vertices(); },
                      +[](const Expected<ConvexPolytope>& e) { return (*e).num_vertices(); },
                      +[](const Expected<ConvexPolytope>& e) { return e->num_vertices(); },
                      +[](const Expected<ConvexPolytope>& e) { return Expected(e).value().num_vertices(); }};
  for (const auto read : reads) {
    try {
      read(refused);
      FAIL() << "a refusal was read";
    } catch (const pd::RefusedValue& thrown) {
      EXPECT_EQ(thrown.error().code, refused.error().code);
      EXPECT_NE(std::string(thrown.what()).find(refused.error().message), std::string::npos) << thrown.what();
      EXPECT_EQ(std::string(thrown.what()).find(to_string(refused.error().code)), 0U) << thrown.what();
    }
  }
  EXPECT_NO_THROW(EXPECT_EQ(ConvexPolytope::box(Vec3(1, 1, 1))->num_vertices(), 8));
}

TEST(Expected, TheMessageNamesThePlaceWhereThereIsOne) {
  EXPECT_STREQ(pd::RefusedValue({ErrorCode::bad_value, "delta must lie in (0, 1]", "delta"}).what(),
               "bad_value at delta: delta must lie in (0, 1]");
  EXPECT_STREQ(pd::RefusedValue({ErrorCode::unbounded, "no bound", ""}).what(), "unbounded: no bound");
}

}  // namespace

/// @file
/// The exact pair of a query is made at most once: the linker sends every construction outside posed_pair.cpp through
/// the counter below (`--wrap`, tests/CMakeLists.txt).

#include <gtest/gtest.h>

#include "pd/depth/penetration_depth.hpp"
#include "pd/depth/scratch.hpp"
#include "scenes/shape_families.hpp"
#include "shape/posed_pair.hpp"

// NOLINTBEGIN(bugprone-reserved-identifier): the linker's names
#define PD_POSED_PAIR \
  _ZN2pd6detail9PosedPairC1ERKNS_14ConvexPolytopeERKNS_4PoseES4_S7_RKN5Eigen6MatrixIdLi3ELi1ELi0ELi3ELi1EEE
#define PD_JOINED(prefix, name) prefix##name
#define PD_NAMED(prefix, name) PD_JOINED(prefix, name)

namespace {
int made = 0;
}

extern "C" {
void PD_NAMED(__real_, PD_POSED_PAIR)(void* self, const void* a, const void* pose_a, const void* b, const void* pose_b,
                                      const void* origin);
void PD_NAMED(__wrap_, PD_POSED_PAIR)(void* self, const void* a, const void* pose_a, const void* b, const void* pose_b,
                                      const void* origin) {
  ++made;
  PD_NAMED(__real_, PD_POSED_PAIR)(self, a, pose_a, b, pose_b, origin);
}
}
// NOLINTEND(bugprone-reserved-identifier)

namespace pd {
namespace {

TEST(ExactPair, IsMadeAtMostOnceAQuery) {
  {
    const ConvexPolytope cube = *ConvexPolytope::box({1, 1, 1});
    made = 0;
    const detail::PosedPair pair(cube, Pose(), cube, Pose());
    ASSERT_EQ(made, 1) << "the counter sees no construction: was the program linked without --wrap?";
  }
  Scratch scratch;
  int exact_queries = 0;
  for (int family = 0; family < scenes::kPairFamilies; ++family) {
    for (int depth = 0; depth < scenes::kDepthClasses; ++depth) {
      for (const int n : {4, 8, 24}) {
        const scenes::PointPair p =
            scenes::make_pair(static_cast<scenes::PairFamily>(family), n, static_cast<scenes::DepthClass>(depth), 7);
        const ConvexShape a(*ConvexPolytope::from_points(p.a));
        const ConvexShape b(*ConvexPolytope::from_points(p.b));
        for (const Method method : {Method::automatic, Method::expansion, Method::overlay, Method::decomposition}) {
          for (const Bracket bracket : {Bracket::certified, Bracket::tightest}) {
            made = 0;
            const PenetrationDepth answer =
                penetration_depth({&a, p.pose_a}, {&b, p.pose_b}, scratch, {.method = method, .bracket = bracket});
            EXPECT_LE(made, 1) << "family " << family << ", depth class " << depth << ", " << n << " vertices, "
                               << to_string(method) << ", bracket " << static_cast<int>(bracket);
            EXPECT_EQ(made > 0, answer.statistics.exact_signs > 0);
            exact_queries += made;
          }
        }
      }
    }
  }
  EXPECT_GT(exact_queries, 100);  // both kinds happen
}

}  // namespace
}  // namespace pd

/// @file
/// What the way round the origin claims, against every vertex of P and against the tightest answer: of few vertices by
/// the kernel, of many by tables, from flat starts.
#include "depth/distance/enclosing_simplex.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "pd/depth/penetration_depth.hpp"
#include "pd/depth/scratch.hpp"
#include "scenes/shape_families.hpp"

namespace pd::detail {
namespace {

using scenes::DepthClass;
using scenes::PairFamily;

class EnclosingSimplexOf : public ::testing::TestWithParam<int> {};

double six_volumes(const Vec3& p, const Vec3& q, const Vec3& r, const Vec3& s) {
  return (q - p).cross(r - p).dot(s - p);
}

/// Whether no corner can be exchanged for the origin without turning the tetrahedron, up to `noise`.
bool holds_origin(const DifferenceVertex (&s)[4], double noise) {
  const Vec3 o = Vec3::Zero();
  const double all = six_volumes(s[0].x, s[1].x, s[2].x, s[3].x);
  const double side = all < 0 ? -1 : 1;
  return side * six_volumes(o, s[1].x, s[2].x, s[3].x) >= -noise &&
         side * six_volumes(s[0].x, o, s[2].x, s[3].x) >= -noise &&
         side * six_volumes(s[0].x, s[1].x, o, s[3].x) >= -noise &&
         side * six_volumes(s[0].x, s[1].x, s[2].x, o) >= -noise;
}

TEST_P(EnclosingSimplexOf, SaysWhatIsSo) {
  int enclosed = 0, apart = 0, pairs = 0;
  for (const PairFamily family : {PairFamily::needle, PairFamily::sphere, PairFamily::grid, PairFamily::slivers}) {
    for (int k = 0; k < 48; ++k) {
      const auto depth = static_cast<DepthClass>(k % scenes::kDepthClasses);
      const scenes::PointPair pair = scenes::make_pair(family, GetParam(), depth, 1000 + static_cast<std::uint64_t>(k));
      const ConvexPolytope a = *ConvexPolytope::from_points(pair.a), b = *ConvexPolytope::from_points(pair.b);
      PolytopeDifference difference(a, pair.pose_a, b, pair.pose_b);
      PosedVerticesPair posed;
      difference.prepare_supports(posed);
      // One vertex four times, or two of them twice.
      const DifferenceVertex p = difference.vertex(0, 0);
      const DifferenceVertex q = k % 2 == 0 ? p : difference.vertex(a.num_vertices() - 1, 0);
      const DifferenceVertex start[4] = {p, q, p, q};
      std::vector<std::int32_t> stack;
      std::int64_t supports = 0;
      const EnclosingSimplex found = enclosing_simplex(difference, start, stack, supports);
      ++pairs;
      Scratch scratch;
      const ConvexShape shape_a(a), shape_b(b);
      const PenetrationDepth truth = penetration_depth({&shape_a, pair.pose_a}, {&shape_b, pair.pose_b}, scratch);
      const double reach = difference.reach();
      if (found.status == EnclosingSimplex::Status::encloses) {
        ++enclosed;
        ASSERT_EQ(found.count, 4);
        EXPECT_TRUE(holds_origin(found.simplex, 1e-12 * reach * reach * reach)) << to_string(family) << " " << k;
        EXPECT_NE(truth.contact, ContactClass::separated) << to_string(family) << " " << k;
      } else if (found.status == EnclosingSimplex::Status::apart) {
        ++apart;
        EXPECT_EQ(truth.contact, ContactClass::separated) << to_string(family) << " " << k;
        EXPECT_LT(found.upper, 0);
        for (int i = 0; i < a.num_vertices(); ++i) {
          for (int j = 0; j < b.num_vertices(); ++j) {
            ASSERT_LE(difference.posed_vertex(i, j).x.dot(found.normal), found.upper) << to_string(family) << " " << k;
          }
        }
      }
    }
  }
  EXPECT_GT(enclosed, pairs / 3);
  EXPECT_GT(apart, pairs / 5);
  EXPECT_GT(enclosed + apart, pairs * 9 / 10);
}

INSTANTIATE_TEST_SUITE_P(Sizes, EnclosingSimplexOf, ::testing::Values(12, 40, 128));

}  // namespace
}  // namespace pd::detail

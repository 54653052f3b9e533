/// @file
/// The simplex that exact searches begin with is the one that they end with, to double-double.

#include "depth/distance/closest_simplex.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <vector>

#include "depth/distance/gjk_exact.hpp"
#include "depth/distance/simplex_double_double.hpp"
#include "numeric/root_sum.hpp"
#include "oracle/judged_pair.hpp"

namespace pd {
namespace {

using detail::PosedPair;
using detail::VertexPair;
using scenes::DepthClass;
using scenes::PairFamily;

constexpr VertexPair kAny{0, 0};

/// Of the simplex, scaled as the pair is. Added one by one a vertex may be dropped that is wanted later: in any order.
double distance_of(const PosedPair& pair, const detail::ClosestSimplex& found) {
  std::vector<std::size_t> order(static_cast<std::size_t>(found.count));
  std::iota(order.begin(), order.end(), 0);
  double least = std::numeric_limits<double>::infinity();
  do {
    const auto place = [&](std::size_t i) {
      const VertexPair& v = found.vertices[order[i]];
      return pair.approximate_dd(detail::PairVector::point(v.a, v.b));
    };
    detail::SimplexDoubleDouble<std::size_t> simplex(0, place(0));
    for (std::size_t i = 1; i < order.size() && simplex.closest().count < 4; ++i) simplex.add(i, place(i));
    least = std::min(least, to_double(sqrt(simplex.closest().squared)));
  } while (std::next_permutation(order.begin(), order.end()));
  return least;
}

TEST(ClosestSimplex, IsAsFarAsTheBodiesAre) {
  int apart = 0;
  for (int f = 0; f < scenes::kPairFamilies; ++f) {
    if (static_cast<PairFamily>(f) == PairFamily::scales) continue;  // squares are no doubles there
    for (const DepthClass depth : {DepthClass::gap, DepthClass::mid}) {
      for (const int n : {4, 16, 200}) {
        const oracle::JudgedPair judged = oracle::JudgedPair::of_family(static_cast<PairFamily>(f), n, depth, 5);
        SCOPED_TRACE(judged.name());
        const PosedShape a = judged.a(), b = judged.b();
        const PosedPair pair(*a.shape->polytope(), a.pose, *b.shape->polytope(), b.pose);
        const detail::ClosestSimplex found = closest_simplex(pair, std::span(&kAny, 1));
        ASSERT_GE(found.count, 1);
        ASSERT_LE(found.count, 4);
        const detail::ExactClosestPoint exact = exact_closest_point(pair, &kAny, 1);
        const double error = 64 * pair.vector_error_dd();
        if (!exact.apart) {
          EXPECT_LE(distance_of(pair, found), error);
          continue;
        }
        ++apart;
        const detail::DoubleDouble length = sqrt(to_double_double(dot(exact.point, exact.point)));
        const double expected = to_double(length / to_double_double(exact.scale)) * pair.inwards();
        EXPECT_NEAR(distance_of(pair, found), expected, error + 0x1p-50 * expected);
      }
    }
  }
  EXPECT_GT(apart, 60);
}

}  // namespace
}  // namespace pd

/// @file
/// The simplex that exact searches begin with is the one that they end with, to double-double; and what they end with
/// is nearest to the origin, as every vertex of P shows.

#include <gtest/gtest.h>

#include <array>

#include "depth/distance/gjk_exact.hpp"
#include "depth/distance/simplex_of_numbers.hpp"
#include "numeric/root_sum.hpp"
#include "oracle/judged_pair.hpp"

namespace pd {
namespace {

using detail::PosedPair;
using detail::VertexPair;
using scenes::DepthClass;
using scenes::PairFamily;

constexpr VertexPair kAny{0, 0};

/// The distance of the simplex from the origin, scaled as the pair is.
double distance_of(const PosedPair& pair, const detail::ClosestSimplex& found) {
  using Simplex = detail::SimplexOfNumbers<detail::DoubleDouble, VertexPair>;
  std::array<Simplex::Corner, 4> corners;
  const auto count = static_cast<std::size_t>(found.count);
  for (std::size_t i = 0; i < count; ++i) {
    const VertexPair& v = found.vertices[i];
    corners[i] = {v, pair.approximate_dd(detail::PairVector::point(v.a, v.b))};
  }
  Simplex simplex(corners[0]);
  simplex.take(std::span(corners).first(count));
  return to_double(sqrt(simplex.nearest().squared / simplex.nearest().scale));
}

/// All vertices of P lie behind the plane across the nearest point, and those of its simplex on it.
void expect_nearest(const PosedPair& pair, const detail::ExactClosestPoint& exact) {
  const auto place = [&](int a, int b) { return pair.exact(detail::PairVector::point(a, b)); };
  const detail::Dyadic3 corner = place(exact.simplex[0].a, exact.simplex[0].b);
  for (int i = 1; i < exact.count; ++i) {
    const VertexPair& v = exact.simplex[static_cast<std::size_t>(i)];
    EXPECT_EQ(dot(exact.point, place(v.a, v.b) - corner).sign(), 0);
  }
  for (int a = 0; a < pair.a().num_vertices(); ++a) {
    for (int b = 0; b < pair.b().num_vertices(); ++b) {
      ASSERT_GE(dot(exact.point, place(a, b) - corner).sign(), 0) << a << " " << b;
    }
  }
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
        if (n <= 16) expect_nearest(pair, exact);
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

/// @file
/// The nearest facet by double-double: the one that the exact expansion ends with, or none; none where facets tie
/// exactly, and where the origin does not lie inside.

#include "depth/facets/unique_nearest_facet.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "depth/expansion/exact_expanding_polytope.hpp"
#include "scenes/shape_families.hpp"

namespace pd {
namespace {

using detail::PosedPair;
using detail::VertexPair;
using scenes::DepthClass;
using scenes::PairFamily;

struct Case {
  ConvexPolytope a;
  ConvexPolytope b;
  Pose pose_a;
  Pose pose_b;

  static Case of(PairFamily family, int n, DepthClass depth, std::uint64_t seed) {
    const scenes::PointPair p = scenes::make_pair(family, n, depth, seed);
    return {*ConvexPolytope::from_points(p.a), *ConvexPolytope::from_points(p.b), p.pose_a, p.pose_b};
  }
};

constexpr VertexPair kAny{0, 0};
constexpr int kBudget = 400;

/// Facets that noise tells apart, of bodies turned by noise, beside one a billion times as large, and of sizes whose
/// products leave the range of doubles.
TEST(UniqueNearestFacet, IsThatOfTheExactExpansion) {
  int found = 0, asked = 0;
  for (const PairFamily family : {PairFamily::sphere, PairFamily::needle, PairFamily::scales, PairFamily::mixed_scales,
                                  PairFamily::ulp_noise, PairFamily::near_equal_bodies}) {
    for (const DepthClass depth : {DepthClass::shallow, DepthClass::mid, DepthClass::deep}) {
      for (const int n : {4, 8, 16}) {
        for (std::uint64_t seed = 1; seed <= 4; ++seed) {
          const Case c = Case::of(family, n, depth, seed);
          const PosedPair pair(c.a, c.pose_a, c.b, c.pose_b);
          const detail::ExactClosestPoint closest = exact_closest_point(pair, &kAny, 1);
          detail::SupportFaces faces;
          const auto nearest = unique_nearest_facet(pair, std::span(&kAny, 1), kBudget, faces);
          if (closest.apart) {
            EXPECT_FALSE(nearest.found);
            continue;
          }
          const detail::ExactDepth exact = exact_expanding_polytope(pair, &kAny, 1, std::numeric_limits<int>::max());
          ASSERT_TRUE(exact.complete);
          ++asked;
          if (!nearest.found) continue;
          ++found;
          ASSERT_EQ(exact.contact, ContactClass::overlapping);
          // The same plane exactly, by the same features.
          const detail::FacetOfDifference &x = nearest.found->facet, y = facet_of_direction(pair, *exact.normal);
          EXPECT_EQ(compare(squared_distance(pair, x), squared_distance(pair, y)), 0);
          EXPECT_EQ(x.a, y.a);
          EXPECT_EQ(x.b, y.b);
          const auto same = [](const detail::PairVector& v, const detail::PairVector& w) {
            return v.a_to == w.a_to && v.a_from == w.a_from && v.b_to == w.b_to && v.b_from == w.b_from;
          };
          EXPECT_TRUE(same(x.u, y.u) && same(x.v, y.v));
          EXPECT_EQ(faces.on_a, support_face_a(pair, *exact.normal));
          EXPECT_EQ(faces.on_b, support_face_b(pair, *exact.normal));
        }
      }
    }
  }
  EXPECT_GT(asked, 150);
  EXPECT_GT(found, asked * 9 / 10);
}

TEST(UniqueNearestFacet, LeavesTiesAndTouchingBodiesOpen) {
  detail::SupportFaces faces;
  const Case cubes = Case::of(PairFamily::cubes, 8, DepthClass::deep, 1);  // at one place: opposite facets tie
  EXPECT_FALSE(
      unique_nearest_facet(PosedPair(cubes.a, cubes.pose_a, cubes.b, cubes.pose_b), std::span(&kAny, 1), kBudget, faces)
          .found);
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Case c = Case::of(PairFamily::kissing, 8, DepthClass::mid, seed);
    EXPECT_FALSE(
        unique_nearest_facet(PosedPair(c.a, c.pose_a, c.b, c.pose_b), std::span(&kAny, 1), kBudget, faces).found);
  }
}

/// A budget ends it.
TEST(UniqueNearestFacet, KeepsItsBudget) {
  const Case c = Case::of(PairFamily::sphere, 64, DepthClass::mid, 3);
  const PosedPair pair(c.a, c.pose_a, c.b, c.pose_b);
  detail::SupportFaces faces;
  const auto whole = unique_nearest_facet(pair, std::span(&kAny, 1), kBudget, faces);
  ASSERT_TRUE(whole.found);
  ASSERT_GT(whole.support_calls, 8);
  const auto cut = unique_nearest_facet(pair, std::span(&kAny, 1), 8, faces);
  EXPECT_FALSE(cut.found);
  EXPECT_LE(cut.support_calls, 8);
}

}  // namespace
}  // namespace pd

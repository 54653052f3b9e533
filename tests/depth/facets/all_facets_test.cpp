/// @file
/// Two solids deep in each other by all facets of P: the nearest one against the surface's and the tightest answer, one
/// instruction set against another, and what is left to the surface.
#include "depth/facets/all_facets.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <bit>
#include <random>
#include <vector>

#include "depth/facets/all_facets_kernels.hpp"
#include "pd/depth/penetration_depth.hpp"
#include "pd/depth/scratch.hpp"
#include "scenes/shape_families.hpp"
#include "shape/normal_matrix.hpp"

namespace pd {
namespace detail {

NearestOfAllFacets nearest_of_all_facets_baseline(const AllFacetsBody& a, const AllFacetsBody& b,
                                                  const double (&offset)[3], const AllFacetsErrors& errors);

namespace {

enum class Kind { round, cloud, prism, box_and_hull, mixed };

struct Solids {
  ConvexPolytope a, b;
  Pose pose_a, pose_b;
};

class DeepSolids : public ::testing::TestWithParam<Kind> {
 protected:
  Vec3 vector() { return {normal_(random_), normal_(random_), normal_(random_)}; }
  Mat3 rotation() {
    return Eigen::Quaterniond(normal_(random_), normal_(random_), normal_(random_), normal_(random_))
        .normalized()
        .matrix();
  }
  ConvexPolytope hull(int vertices) {
    std::vector<Vec3> points(static_cast<std::size_t>(vertices));
    for (Vec3& p : points) p = GetParam() == Kind::cloud ? vector() : Vec3(vector().normalized());
    return *ConvexPolytope::from_points(points);
  }
  ConvexPolytope body(bool first) {
    const int vertices = std::uniform_int_distribution(9, 32)(random_);
    switch (GetParam()) {
      case Kind::prism:
        return *ConvexPolytope::from_points(scenes::prism(vertices));
      case Kind::box_and_hull:
        return first ? *ConvexPolytope::box({0.5, 0.6, 0.7}) : hull(vertices);
      case Kind::mixed:
        return first ? *ConvexPolytope::from_points(scenes::prism(vertices)) : hull(vertices);
      case Kind::round:
      case Kind::cloud:
        break;
    }
    return hull(vertices);
  }
  Solids draw(double apart = 0.1) {
    const Vec3 at = vector();
    ConvexPolytope a = body(true);
    return {std::move(a), body(false), *Pose::from_matrix(rotation(), at),
            *Pose::from_matrix(rotation(), at + apart * vector())};
  }

 private:
  std::mt19937_64 random_{17};
  std::normal_distribution<double> normal_;
};

/// A pair as the kernel takes it.
struct KernelInput {
  explicit KernelInput(const Solids& s)
      : difference(s.a, s.pose_a, s.b, s.pose_b), a{s.a.storage(), {}, {}}, b{s.b.storage(), {}, {}} {
    difference.prepare_supports(posed);
    a.posed = difference.posed_a();
    b.posed = difference.posed_b();
    const Mat3 of_a = -normal_matrix(s.pose_a), of_b = normal_matrix(s.pose_b);
    for (int i = 0; i < 9; ++i) {
      a.turn[i] = of_a(i / 3, i % 3);
      b.turn[i] = of_b(i / 3, i % 3);
    }
    for (int i = 0; i < 3; ++i) offset[i] = difference.offset()[i];
    errors = {0x1p-19 * difference.reach(), 0, 0};
  }
  PosedVerticesPair posed;
  PolytopeDifference difference;
  AllFacetsBody a, b;
  double offset[3];
  AllFacetsErrors errors;
};

bool same(const Feature& x, const Feature& y) { return x.kind == y.kind && x.first == y.first && x.second == y.second; }

TEST_P(DeepSolids, TheKernelFindsTheDepth) {
  Scratch scratch;
  int by_edges = 0, by_facets = 0, beyond = 0;
  for (int i = 0; i < 300; ++i) {
    SCOPED_TRACE(i);
    const Solids s = draw(i % 3 == 0 ? 0.6 : 0.1);
    const KernelInput in(s);
    const NearestOfAllFacets found = nearest_of_all_facets(in.a, in.b, in.offset, in.errors);
    const ConvexShape shape_a(s.a), shape_b(s.b);
    const PenetrationDepth expected = penetration_depth({&shape_a, s.pose_a}, {&shape_b, s.pose_b}, scratch,
                                                        {.method = Method::expansion, .bracket = Bracket::certified});
    if (expected.contact == ContactClass::separated) {
      EXPECT_FALSE(found.key > 0 && found.outcome == NearestOfAllFacets::Outcome::found);
      ++beyond;
      continue;
    }
    ASSERT_EQ(found.outcome, NearestOfAllFacets::Outcome::found);
    EXPECT_NEAR(std::sqrt(found.key), expected.depth, 1e-13);
    EXPECT_LE(found.key, found.others_key);
    EXPECT_EQ((found.facet_a >= 0) + (found.facet_b >= 0) + (found.edge_a[0] >= 0 && found.edge_b[0] >= 0), 1);
    (found.edge_a[0] >= 0 ? by_edges : by_facets) += 1;
  }
  EXPECT_GT(by_edges, 10);
  EXPECT_GT(by_facets, 5);
  EXPECT_LT(beyond, 100);
}

TEST_P(DeepSolids, TheSameBitsOnEveryInstructionSet) {
  const auto bits = [](double x) { return std::bit_cast<std::uint64_t>(x); };
  for (int i = 0; i < 300; ++i) {
    SCOPED_TRACE(i);
    const Solids s = draw(i % 3 == 0 ? 1 : 0.1);
    const KernelInput in(s);
    const NearestOfAllFacets x = nearest_of_all_facets(in.a, in.b, in.offset, in.errors);
    const NearestOfAllFacets y = nearest_of_all_facets_baseline(in.a, in.b, in.offset, in.errors);
    EXPECT_EQ(x.outcome, y.outcome);
    EXPECT_EQ(bits(x.key), bits(y.key));
    EXPECT_EQ(bits(x.others_key), bits(y.others_key));
    EXPECT_EQ(bits(x.sign), bits(y.sign));
    EXPECT_EQ(bits(x.largest), bits(y.largest));
    EXPECT_EQ(x.facet_a, y.facet_a);
    EXPECT_EQ(x.facet_b, y.facet_b);
    for (int k = 0; k < 2; ++k) {
      EXPECT_EQ(x.edge_a[k], y.edge_a[k]);
      EXPECT_EQ(x.edge_b[k], y.edge_b[k]);
    }
    EXPECT_EQ(x.pieces, y.pieces);
  }
}

TEST_P(DeepSolids, CertifiedBracketsHoldTheTightestDepthAndNameItsFeatures) {
  Scratch scratch;
  int by_facets = 0;
  constexpr int kPairs = 400;
  for (int i = 0; i < kPairs; ++i) {
    SCOPED_TRACE(i);
    const Solids s = draw();
    const ConvexShape shape_a(s.a), shape_b(s.b);
    const PosedShape a{&shape_a, s.pose_a}, b{&shape_b, s.pose_b};
    const PenetrationDepth fast = penetration_depth(a, b, scratch, {.bracket = Bracket::certified});
    const PenetrationDepth exact = penetration_depth(a, b, scratch);
    const PenetrationDepth searched = penetration_depth(a, b, scratch, {.method = Method::expansion});
    ASSERT_EQ(fast.contact, ContactClass::overlapping);
    by_facets += static_cast<int>(fast.method == Method::overlay);
    const double size = s.a.radius() + s.b.radius() + (s.pose_b.translation() - s.pose_a.translation()).norm();
    EXPECT_LE(fast.lower, exact.upper);
    EXPECT_GE(fast.upper, exact.lower);
    EXPECT_LE(fast.upper - fast.lower, 2e-14 * size);
    EXPECT_LE((fast.witness_b - fast.witness_a - fast.translation).norm(), 2e-15 * size);
    EXPECT_LE((fast.normal - exact.normal).norm(), 1e-12);
    EXPECT_TRUE(same(fast.feature_a, exact.feature_a) && same(fast.feature_b, exact.feature_b));
    // The tightest answer has the bits that a search gives it.
    EXPECT_EQ(exact.lower, searched.lower);
    EXPECT_EQ(exact.upper, searched.upper);
    EXPECT_EQ(exact.translation, searched.translation);
    EXPECT_EQ(exact.witness_a, searched.witness_a);
    EXPECT_TRUE(same(exact.feature_a, searched.feature_a) && same(exact.feature_b, searched.feature_b));
  }
  EXPECT_GT(by_facets, kPairs * 3 / 4);
}

INSTANTIATE_TEST_SUITE_P(Kinds, DeepSolids,
                         ::testing::Values(Kind::round, Kind::cloud, Kind::prism, Kind::box_and_hull, Kind::mixed));

/// Certain signs are asked for: as if they were less certain than they are.
TEST(DeepSolidsInDoubt, AreLeftOpen) {
  scenes::Random random(5);
  const ConvexPolytope hull = *ConvexPolytope::from_points(scenes::sphere_hull(20, random));
  const Solids s{hull, hull, Pose(), *Pose::from_quaternion({0.9, 0.1, 0.3, 0.3}, {0.05, 0.02, 0.03})};
  KernelInput in(s);
  EXPECT_EQ(nearest_of_all_facets(in.a, in.b, in.offset, in.errors).outcome, NearestOfAllFacets::Outcome::found);
  in.errors.side_a = 1;
  EXPECT_EQ(nearest_of_all_facets(in.a, in.b, in.offset, in.errors).outcome, NearestOfAllFacets::Outcome::open);
}

/// Parallel edges and facets, exactly and but for a turn that single precision cannot tell from none; slender bodies;
/// more vertices than there is room for.
TEST(DeepSolidsAligned, AreAnsweredRightly) {
  scenes::Random random(7);
  const ConvexShape prism(*ConvexPolytope::from_points(scenes::prism(24)));
  const ConvexShape round(*ConvexPolytope::from_points(scenes::sphere_hull(40, random)));
  const ConvexShape slender(*ConvexPolytope::from_points(scenes::needle(24, random)));
  Scratch scratch;
  for (const ConvexShape* body : {&prism, &round, &slender}) {
    for (const double angle : {0.0, 1e-16, 1e-12, 1e-8, 1e-6, 1e-3}) {
      for (const Vec3& axis : {Vec3(0, 0, 1), Vec3(0.6, 0, 0.8)}) {
        SCOPED_TRACE(angle);
        const Pose pose_b = *Pose::from_matrix(Eigen::AngleAxisd(angle, axis).matrix(), {0.01, 0.02, 0.005});
        const PosedShape a{body, Pose()}, b{body, pose_b};
        const PenetrationDepth fast = penetration_depth(a, b, scratch, {.bracket = Bracket::certified});
        const PenetrationDepth exact = penetration_depth(a, b, scratch);
        ASSERT_EQ(fast.contact, exact.contact);
        EXPECT_LE(fast.lower, exact.upper);
        EXPECT_GE(fast.upper, exact.lower);
        EXPECT_LE(fast.upper - fast.lower, 1e-13);
      }
    }
  }
}

}  // namespace
}  // namespace detail
}  // namespace pd

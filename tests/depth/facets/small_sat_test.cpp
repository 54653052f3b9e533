/// @file
/// Two solids of few vertices by all facets of P: the kernel against every candidate normal, one instruction set
/// against another, the certified answer against the tightest one.
#include "depth/facets/small_sat.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <bit>
#include <limits>
#include <random>
#include <vector>

#include "depth/facets/small_sat_kernels.hpp"
#include "pd/depth/penetration_depth.hpp"
#include "pd/depth/scratch.hpp"
#include "shape/normal_matrix.hpp"

namespace pd {
namespace detail {

SmallSatNearest nearest_of_small_baseline(const SmallSatBody& a, const SmallSatBody& b, const double (&offset)[3],
                                          const SmallSatErrors& errors, SmallNearPieces* near);

namespace {

enum class Kind { round, slender, flat, tetrahedra, box_and_hull };

struct Solids {
  ConvexPolytope a, b;
  Pose pose_a, pose_b;
};

class SmallSolids : public ::testing::TestWithParam<Kind> {
 protected:
  Vec3 vector() { return {normal_(random_), normal_(random_), normal_(random_)}; }
  Mat3 rotation() {
    return Eigen::Quaterniond(normal_(random_), normal_(random_), normal_(random_), normal_(random_))
        .normalized()
        .matrix();
  }
  ConvexPolytope hull() {
    const Vec3 scale = GetParam() == Kind::slender ? Vec3(1, 0.03, 0.05)
                       : GetParam() == Kind::flat  ? Vec3(1, 0.8, 0.02)
                                                   : Vec3(1, 1, 1);
    std::vector<Vec3> points(GetParam() == Kind::tetrahedra ? 4 : 8);
    for (Vec3& p : points) p = vector().normalized().cwiseProduct(scale);
    return *ConvexPolytope::from_points(points);
  }
  Solids draw() {
    const Vec3 at = vector();
    const double apart = GetParam() == Kind::slender ? 0.05 : 0.3;
    ConvexPolytope a = GetParam() == Kind::box_and_hull ? *ConvexPolytope::box({0.3, 0.6, 0.9}) : hull();
    return {std::move(a), hull(), *Pose::from_matrix(rotation(), at),
            *Pose::from_matrix(rotation(), at + apart * vector())};
  }

 private:
  std::mt19937_64 random_{11};
  std::normal_distribution<double> normal_;
};

/// A pair as the kernel takes it.
struct KernelInput {
  explicit KernelInput(const Solids& s)
      : difference(s.a, s.pose_a, s.b, s.pose_b),
        a{small_gauss_map(s.a), {}, {}, 0},
        b{small_gauss_map(s.b), {}, {}, 0} {
    difference.prepare_supports(posed);
    a.posed = difference.posed_a();
    b.posed = difference.posed_b();
    const Mat3 of_a = -normal_matrix(s.pose_a), of_b = normal_matrix(s.pose_b);
    for (int i = 0; i < 9; ++i) {
      a.normals[i] = of_a(i / 3, i % 3);
      b.normals[i] = of_b(i / 3, i % 3);
    }
    a.growth = -of_a.col(0).dot(s.pose_a.rotation().col(0));
    b.growth = of_b.col(0).dot(s.pose_b.rotation().col(0));
    for (int i = 0; i < 3; ++i) offset[i] = difference.offset()[i];
    errors = {0x1p-20 * difference.reach(), 0, 0};
  }
  PosedVerticesPair posed;
  PolytopeDifference difference;
  SmallSatBody a, b;
  double offset[3];
  SmallSatErrors errors;
};

double height_of_difference(const PolytopeDifference& p, const Vec3& unit) {
  double most = -std::numeric_limits<double>::infinity();
  for (int i = 0; i < p.a().num_vertices(); ++i) {
    for (int j = 0; j < p.b().num_vertices(); ++j) most = std::max(most, p.vertex(i, j).x.dot(unit));
  }
  return most;
}

std::vector<Vec3> edges(const ConvexPolytope& body, const Mat3& turn) {
  std::vector<Vec3> out;
  for (int h = 0; h < body.num_half_edges(); ++h) {
    if (body.half_edge(h).twin > h)
      out.push_back(turn * (body.vertex(body.target(h)) - body.vertex(body.half_edge(h).origin)));
  }
  return out;
}

/// The least height of P over all directions that a facet may have: every facet's normal, every product of two edges.
double least_height(const Solids& s, const PolytopeDifference& p) {
  double least = std::numeric_limits<double>::infinity();
  const auto take = [&](const Vec3& n) { least = std::min(least, height_of_difference(p, n.normalized())); };
  for (int f = 0; f < s.a.num_facets(); ++f) take(-(s.pose_a.rotation() * s.a.facet_normal(f)));
  for (int f = 0; f < s.b.num_facets(); ++f) take(s.pose_b.rotation() * s.b.facet_normal(f));
  for (const Vec3& e : edges(s.a, s.pose_a.rotation())) {
    for (const Vec3& f : edges(s.b, s.pose_b.rotation())) {
      take(e.cross(f));
      take(f.cross(e));
    }
  }
  return least;
}

TEST_P(SmallSolids, TheKernelFindsTheLeastHeightOfAllCandidates) {
  int overlapping = 0, by_edges = 0;
  for (int i = 0; i < 300; ++i) {
    SCOPED_TRACE(i);
    const Solids s = draw();
    const KernelInput in(s);
    const SmallSatNearest found = nearest_of_small(in.a, in.b, in.offset, in.errors, nullptr);
    const double expected = least_height(s, in.difference);
    if (expected <= 0) {
      EXPECT_LT(found.key, 1e-24);
      continue;
    }
    ++overlapping;
    by_edges += static_cast<int>(found.edge_a >= 0);
    ASSERT_GT(found.key, 0);
    EXPECT_NEAR(std::sqrt(found.key), expected, 1e-13);
    EXPECT_EQ((found.facet_a >= 0) + (found.facet_b >= 0) + (found.edge_a >= 0 && found.edge_b >= 0), 1);
  }
  EXPECT_GT(overlapping, 60);
  EXPECT_GT(by_edges, 10);
}

TEST_P(SmallSolids, TheSameBitsOnEveryInstructionSet) {
  const auto bits = [](double x) { return std::bit_cast<std::uint64_t>(x); };
  for (int i = 0; i < 300; ++i) {
    SCOPED_TRACE(i);
    const Solids s = draw();
    const KernelInput in(s);
    SmallNearPieces near_x, near_y;
    near_x.band = near_y.band = 0.2;
    const SmallSatNearest x = nearest_of_small(in.a, in.b, in.offset, in.errors, &near_x);
    const SmallSatNearest y = nearest_of_small_baseline(in.a, in.b, in.offset, in.errors, &near_y);
    EXPECT_EQ(near_x.complete, near_y.complete);
    ASSERT_EQ(near_x.count, near_y.count);
    EXPECT_EQ(bits(near_x.radius), bits(near_y.radius));
    for (int k = 0; k < near_x.count; ++k) EXPECT_EQ(bits(near_x.pieces[k].key), bits(near_y.pieces[k].key));
    EXPECT_EQ(bits(x.key), bits(y.key));
    EXPECT_EQ(bits(x.sign), bits(y.sign));
    EXPECT_EQ(bits(x.largest), bits(y.largest));
    EXPECT_EQ(x.facet_a, y.facet_a);
    EXPECT_EQ(x.facet_b, y.facet_b);
    EXPECT_EQ(x.edge_a, y.edge_a);
    EXPECT_EQ(x.edge_b, y.edge_b);
    EXPECT_EQ(x.crossings, y.crossings);
    EXPECT_EQ(x.possible, y.possible);
    EXPECT_EQ(bits(x.possible_key), bits(y.possible_key));
  }
}

/// As if signs were less certain than they are: pairs that may cross then count, and what they are said to be farther
/// than must hold for the depth.
TEST_P(SmallSolids, PairsWithOpenSidesAreNoFartherThanTheDepth) {
  int possible = 0;
  for (int i = 0; i < 300; ++i) {
    SCOPED_TRACE(i);
    const Solids s = draw();
    KernelInput in(s);
    for (const float error : {1e-3F, 0.02F, 0.3F}) {
      in.errors.side_a = in.errors.side_b = error;
      const SmallSatNearest found = nearest_of_small(in.a, in.b, in.offset, in.errors, nullptr);
      const SmallSatNearest again = nearest_of_small_baseline(in.a, in.b, in.offset, in.errors, nullptr);
      EXPECT_EQ(std::bit_cast<std::uint64_t>(found.key), std::bit_cast<std::uint64_t>(again.key));
      EXPECT_EQ(std::bit_cast<std::uint64_t>(found.possible_key), std::bit_cast<std::uint64_t>(again.possible_key));
      EXPECT_EQ(found.possible, again.possible);
      possible += found.possible;
      const double expected = least_height(s, in.difference);
      const double key = std::min(found.key, found.possible_key);
      if (expected > 0 && key > 0) {
        EXPECT_LE(std::sqrt(key), expected + 1e-13);
      }
    }
  }
  EXPECT_GT(possible, 300);
}

double outside(const Vec3& point, const Pose& pose, const ConvexPolytope& body) {
  const Vec3 local = pose.rotation().transpose() * (point - pose.translation());
  double most = -std::numeric_limits<double>::infinity();
  for (int f = 0; f < body.num_facets(); ++f) {
    most = std::max(most, body.facet_normal(f).dot(local - body.vertex(body.facet_vertices(f)[0])));
  }
  return most;
}

TEST_P(SmallSolids, CertifiedBracketsHoldTheTightestDepth) {
  Scratch scratch;
  int overlapping = 0, by_facets = 0;
  for (int i = 0; i < 500; ++i) {
    SCOPED_TRACE(i);
    const Solids s = draw();
    const ConvexShape shape_a(s.a), shape_b(s.b);
    const PosedShape a{&shape_a, s.pose_a}, b{&shape_b, s.pose_b};
    const PenetrationDepth fast = penetration_depth(a, b, scratch, {.bracket = Bracket::certified});
    const PenetrationDepth exact = penetration_depth(a, b, scratch);
    ASSERT_EQ(fast.contact, exact.contact);
    if (exact.contact != ContactClass::overlapping) continue;
    ++overlapping;
    by_facets += static_cast<int>(fast.method == Method::overlay);
    const double size = s.a.radius() + s.b.radius() + (s.pose_b.translation() - s.pose_a.translation()).norm();
    EXPECT_LE(fast.lower, exact.upper);
    EXPECT_GE(fast.upper, exact.lower);
    EXPECT_LE(fast.upper - fast.lower, 2e-14 * size);
    EXPECT_LE(outside(fast.witness_a, s.pose_a, s.a), 2e-14 * size);
    EXPECT_LE(outside(fast.witness_b, s.pose_b, s.b), 2e-14 * size);
    EXPECT_LE((fast.witness_b - fast.witness_a - fast.translation).norm(), 2e-15 * size);
  }
  EXPECT_GT(overlapping, 100);
  EXPECT_GT(by_facets, overlapping * 19 / 20);
}

INSTANTIATE_TEST_SUITE_P(Kinds, SmallSolids,
                         ::testing::Values(Kind::round, Kind::slender, Kind::flat, Kind::tetrahedra,
                                           Kind::box_and_hull));

Mat3 turned_about_z(double angle) { return Eigen::AngleAxisd(angle, Vec3::UnitZ()).matrix(); }

/// Edges parallel to others or to facets: exactly, and but for a turn that single precision cannot tell from none.
TEST(SmallSolidsAligned, AreLeftToTheSurfaceOrCertifiedRightly) {
  std::vector<Vec3> corners;
  for (int i = 0; i < 8; ++i) corners.emplace_back(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 0.7 : -0.7);
  for (Vec3& c : corners) c.head<2>() *= c.z() > 0 ? 0.5 : 1;  // the frustum of a pyramid
  const ConvexShape frustum(*ConvexPolytope::from_points(corners));
  Scratch scratch;
  for (const double angle : {0.0, 1e-16, 1e-12, 1e-8, 1e-6, 1e-3}) {
    for (const Vec3& apart : {Vec3(0, 0, 1.1), Vec3(1.2, 0, 0), Vec3(0.9, 0.9, 0.1), Vec3(0.1, 0.2, -0.3)}) {
      SCOPED_TRACE(::testing::Message() << angle << " " << apart.transpose());
      const PosedShape a{&frustum, Pose()}, b{&frustum, *Pose::from_matrix(turned_about_z(angle), apart)};
      const PenetrationDepth fast = penetration_depth(a, b, scratch, {.bracket = Bracket::certified});
      const PenetrationDepth exact = penetration_depth(a, b, scratch);
      ASSERT_EQ(fast.contact, exact.contact);
      EXPECT_LE(fast.lower, exact.upper);
      EXPECT_GE(fast.upper, exact.lower);
      EXPECT_LE(fast.upper - fast.lower, 1e-13);
    }
  }
}

TEST(SmallGaussMap, HoldsFacetsAndEdges) {
  const ConvexPolytope box = *ConvexPolytope::box({1, 2, 3});
  ASSERT_TRUE(has_small_gauss_map(box));
  const SmallGaussMap& map = small_gauss_map(box);
  EXPECT_EQ(map.facets, 6);
  EXPECT_EQ(map.edges, 12);
  for (int f = 0; f < map.facets; ++f) {
    EXPECT_EQ(Vec3(map.nx[f], map.ny[f], map.nz[f]), box.facet_normal(f));
    EXPECT_EQ(map.height[f], box.facet_normal(f).cwiseAbs().dot(Vec3(1, 2, 3)));
  }
  for (int e = 0; e < map.edges; ++e) {
    // Seen from outside, the left normal turns to the right one about the edge's direction.
    const Vec3 along = box.vertex(map.to[e]) - box.vertex(map.from[e]);
    EXPECT_GT(box.facet_normal(map.left[e]).cross(box.facet_normal(map.right[e])).dot(along), 0);
    for (int g = 0; g < 3; ++g) {
      for (unsigned set = 0; set < 16; ++set) {
        const auto holds = [&](int facet) { return facet / 4 == g && (set >> facet % 4 & 1) != 0; };
        EXPECT_EQ(map.edges_of_facets[g][set] >> e & 1, holds(map.left[e]) ? 1U : 0U);
        EXPECT_EQ(map.edges_of_facets[g][set] >> (32 + e) & 1, holds(map.right[e]) ? 1U : 0U);
      }
    }
  }
  std::vector<Vec3> nine;
  for (int i = 0; i < 9; ++i) nine.emplace_back(std::cos(i), std::sin(i), 0.1 * i * i);
  EXPECT_FALSE(has_small_gauss_map(*ConvexPolytope::from_points(nine)));
}

}  // namespace
}  // namespace detail
}  // namespace pd

/// @file
/// Two solids of few facets by all facets of P: the kernel against every candidate normal and against the surface, one
/// instruction set against another, the certified answer against the tightest one.
#include "depth/facets/gauss_sat.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

#include "depth/facets/gauss_sat_kernels.hpp"
#include "pd/depth/penetration_depth.hpp"
#include "pd/depth/scratch.hpp"
#include "scenes/agarwal_families.hpp"
#include "scenes/shape_families.hpp"
#include "shape/normal_matrix.hpp"
#include "shape/small_gauss_map.hpp"

namespace pd {
namespace detail {

NearestByGaussMaps nearest_by_gauss_maps_baseline(const GaussSatBody& a, const GaussSatBody& b,
                                                  const double (&offset)[3], const GaussSatErrors& errors,
                                                  NearGaussPieces* near, ThinPairs& thin);

namespace {

enum class Kind { round, slender, flat, tetrahedra, box_and_hull, middle, cloud, prism, box_and_middle, mixed, roofs };

constexpr bool is_middle(Kind kind) { return kind >= Kind::middle; }

struct Solids {
  ConvexPolytope a, b;
  Pose pose_a, pose_b;
};

class SolidsOfFewFacets : public ::testing::TestWithParam<Kind> {
 protected:
  Vec3 vector() { return {normal_(random_), normal_(random_), normal_(random_)}; }
  Mat3 rotation() {
    return Eigen::Quaterniond{normal_(random_), normal_(random_), normal_(random_), normal_(random_)}
        .normalized()
        .matrix();
  }
  ConvexPolytope hull() {
    const Kind kind = GetParam();
    const Vec3 scale = kind == Kind::slender ? Vec3(1, 0.03, 0.05)
                       : kind == Kind::flat  ? Vec3(1, 0.8, 0.02)
                                             : Vec3(1, 1, 1);
    const int vertices = is_middle(kind)            ? std::uniform_int_distribution(9, 32)(random_)
                         : kind == Kind::tetrahedra ? 4
                                                    : 8;
    std::vector<Vec3> points(static_cast<std::size_t>(vertices));
    for (Vec3& p : points) p = kind == Kind::cloud ? vector() : Vec3(vector().normalized().cwiseProduct(scale));
    return *ConvexPolytope::from_points(points);
  }
  ConvexPolytope body(bool first) {
    const Kind kind = GetParam();
    if (kind == Kind::prism || (kind == Kind::mixed && first)) {
      return *ConvexPolytope::from_points(scenes::prism(std::uniform_int_distribution(9, 32)(random_)));
    }
    if (first && kind == Kind::box_and_hull) return *ConvexPolytope::box({0.3, 0.6, 0.9});
    if (first && kind == Kind::box_and_middle) return *ConvexPolytope::box({0.5, 0.6, 0.7});
    return hull();
  }
  Solids draw() {
    const Vec3 at = vector();
    if (GetParam() == Kind::roofs) return crossed_roofs(*Pose::from_matrix(rotation(), at));
    const double apart = GetParam() == Kind::slender ? 0.05 : is_middle(GetParam()) ? 0.1 : 0.3;
    ConvexPolytope a = body(true);
    return {std::move(a), body(false), *Pose::from_matrix(rotation(), at),
            *Pose::from_matrix(rotation(), at + apart * vector())};
  }

 private:
  /// All edges of both ridges cross, some hundred facets of P: nearly as near as each other, or far from it.
  Solids crossed_roofs(const Pose& both) {
    const double overlap = random_() % 2 == 0 ? 1 : std::uniform_real_distribution(0.01, 0.1)(random_);
    const scenes::PolytopePair pair =
        scenes::jittered_roofs(std::uniform_int_distribution(20, 32)(random_), overlap, random_());
    return {pair.a, pair.b, both,
            *Pose::from_matrix(both.rotation() * pair.pose_b.rotation(), both.apply(pair.pose_b.translation()))};
  }
  std::mt19937_64 random_{11};
  std::normal_distribution<double> normal_;
};

/// A pair as the kernel takes it.
struct KernelInput {
  explicit KernelInput(const Solids& s)
      : difference(s.a, s.pose_a, s.b, s.pose_b), a{s.a.storage(), {}, {}, 0}, b{s.b.storage(), {}, {}, 0} {
    difference.prepare_supports(posed);
    a.posed = difference.posed_a();
    b.posed = difference.posed_b();
    const TurnedNormals turned(s.pose_a, s.pose_b);
    for (int i = 0; i < 9; ++i) {
      a.turn[i] = turned.of_a(i / 3, i % 3);
      b.turn[i] = turned.of_b(i / 3, i % 3);
    }
    a.growth = -turned.of_a.col(0).dot(s.pose_a.rotation().col(0));
    b.growth = turned.of_b.col(0).dot(s.pose_b.rotation().col(0));
    for (int i = 0; i < 3; ++i) offset[i] = difference.offset()[i];
    errors = {.reach = difference.reach(),
              .height = 0x1p-19 * difference.reach(),
              .side_a = 0,
              .side_b = 0,
              .fine_side_a = 0,
              .fine_side_b = 0,
              .upper = std::numeric_limits<double>::infinity(),
              .room = 0};
  }
  NearestByGaussMaps nearest(NearGaussPieces* near, ThinPairs& thin) const {
    return nearest_by_gauss_maps(a, b, offset, errors, near, thin);
  }
  PosedVerticesPair posed;
  PolytopeDifference difference;
  GaussSatBody a, b;
  double offset[3];
  GaussSatErrors errors;
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
  const auto take = [&](const Vec3& n) {
    if (n.squaredNorm() > 0) least = std::min(least, height_of_difference(p, n.normalized()));
  };
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

/// The least bound of what the kernel found.
double least_bound(const NearestByGaussMaps& found, const ThinPairs& thin) {
  double least = std::sqrt(std::min(found.key, found.others_key));
  for (int i = 0; i < thin.count; ++i) least = std::min(least, thin.pairs[i].bound);
  return least;
}

TEST_P(SolidsOfFewFacets, TheKernelFindsTheLeastHeightOfAllCandidates) {
  int overlapping = 0, by_edges = 0, thin_ones = 0;
  for (int i = 0; i < (is_middle(GetParam()) ? 12 : 300); ++i) {
    SCOPED_TRACE(i);
    const Solids s = draw();
    KernelInput in(s);
    ThinPairs thin;
    const NearestByGaussMaps found = in.nearest(nullptr, thin);
    const double expected = least_height(s, in.difference);
    if (expected <= 0) {
      EXPECT_FALSE(found.outcome == NearestByGaussMaps::Outcome::found && least_bound(found, thin) > 1e-12);
      continue;
    }
    ++overlapping;
    ASSERT_EQ(found.outcome, NearestByGaussMaps::Outcome::found);
    ASSERT_GT(found.key, 0);
    // Slivers are bounded and do not win.
    EXPECT_LE(least_bound(found, thin), expected + 1e-13);
    EXPECT_GE(std::sqrt(found.key), expected - 1e-13);
    thin_ones += static_cast<int>(thin.count > 0);
    if (thin.count > 0) continue;
    EXPECT_NEAR(std::sqrt(found.key), expected, 1e-13);
    by_edges += static_cast<int>(found.piece.is_of_edges());
    // An upper bound changes what is looked at, not what is found.
    in.errors.upper = expected + 1e-13;
    const NearestByGaussMaps bounded = in.nearest(nullptr, thin);
    EXPECT_EQ(bounded.key, found.key);
    EXPECT_LE(least_bound(bounded, thin), expected + 1e-13);
  }
  EXPECT_GT(overlapping, is_middle(GetParam()) ? 8 : 60);
  if (!is_middle(GetParam())) {
    EXPECT_GT(by_edges, 10);
  }
  EXPECT_LT(thin_ones, overlapping / 2);
}

TEST_P(SolidsOfFewFacets, TheSameBitsOnEveryInstructionSet) {
  const auto bits = [](double x) { return std::bit_cast<std::uint64_t>(x); };
  int thin_ones = 0;
  for (int i = 0; i < 300; ++i) {
    SCOPED_TRACE(i);
    const Solids s = draw();
    KernelInput in(s);
    // As if signs were less certain than they are: sides are told twice, and pairs that may cross count.
    const float error = i % 3 == 0 ? 0 : i % 3 == 1 ? 1e-3F : 0.3F;
    in.errors.side_a = in.errors.side_b = error;
    in.errors.fine_side_a = in.errors.fine_side_b = 0.1 * static_cast<double>(error);
    NearGaussPieces near_x, near_y;
    near_x.band = near_y.band = 0.2;
    ThinPairs thin_x, thin_y;
    const NearestByGaussMaps x = nearest_by_gauss_maps(in.a, in.b, in.offset, in.errors, &near_x, thin_x);
    const NearestByGaussMaps y = nearest_by_gauss_maps_baseline(in.a, in.b, in.offset, in.errors, &near_y, thin_y);
    EXPECT_EQ(x.outcome, y.outcome);
    EXPECT_EQ(near_x.complete, near_y.complete);
    ASSERT_EQ(near_x.count, near_y.count);
    EXPECT_EQ(bits(near_x.radius), bits(near_y.radius));
    for (int k = 0; k < near_x.count; ++k) EXPECT_EQ(bits(near_x.pieces[k].key), bits(near_y.pieces[k].key));
    ASSERT_EQ(thin_x.count, thin_y.count);
    thin_ones += thin_x.count;
    for (int k = 0; k < thin_x.count; ++k) EXPECT_EQ(bits(thin_x.pairs[k].bound), bits(thin_y.pairs[k].bound));
    EXPECT_EQ(bits(x.key), bits(y.key));
    EXPECT_EQ(bits(x.others_key), bits(y.others_key));
    EXPECT_EQ(x.piece.facet_a, y.piece.facet_a);
    EXPECT_EQ(x.piece.facet_b, y.piece.facet_b);
    for (int k = 0; k < 2; ++k) {
      EXPECT_EQ(x.piece.a[k], y.piece.a[k]);
      EXPECT_EQ(x.piece.b[k], y.piece.b[k]);
    }
    EXPECT_EQ(x.pieces, y.pieces);
  }
  if (GetParam() == Kind::slender) {
    EXPECT_GT(thin_ones, 10);
  }
}

/// Pairs that may cross as far as errors tell count, and what they are said to be farther than must hold for the depth.
TEST_P(SolidsOfFewFacets, PairsWithOpenSidesAreNoFartherThanTheDepth) {
  int more = 0;
  for (int i = 0; i < (is_middle(GetParam()) ? 10 : 300); ++i) {
    SCOPED_TRACE(i);
    const Solids s = draw();
    KernelInput in(s);
    ThinPairs thin;
    const NearestByGaussMaps certain = in.nearest(nullptr, thin);
    const double expected = least_height(s, in.difference);
    for (const float error : {1e-3F, 0.02F, 0.3F}) {
      in.errors.side_a = in.errors.side_b = error;
      in.errors.fine_side_a = in.errors.fine_side_b = static_cast<double>(error);
      const NearestByGaussMaps found = in.nearest(nullptr, thin);
      more += static_cast<int>(found.pieces > certain.pieces);
      if (expected > 0 && found.outcome == NearestByGaussMaps::Outcome::found && found.key > 0) {
        EXPECT_LE(least_bound(found, thin), expected + 1e-13);
      }
    }
    // Told again in double precision, sides are what they were.
    in.errors.fine_side_a = in.errors.fine_side_b = 0;
    const NearestByGaussMaps again = in.nearest(nullptr, thin);
    EXPECT_EQ(again.key, certain.key);
    EXPECT_EQ(again.piece.facet_a, certain.piece.facet_a);
    EXPECT_EQ(again.piece.facet_b, certain.piece.facet_b);
    if (certain.piece.is_of_edges()) {
      EXPECT_TRUE(std::equal(again.piece.a, again.piece.a + 2, certain.piece.a));
      EXPECT_TRUE(std::equal(again.piece.b, again.piece.b + 2, certain.piece.b));
    }
  }
  EXPECT_GT(more, is_middle(GetParam()) ? 5 : 30);  // in so many answers the widened errors leave sides open
}

bool same(const Feature& x, const Feature& y) { return x.kind == y.kind && x.first == y.first && x.second == y.second; }

double outside(const Vec3& point, const Pose& pose, const ConvexPolytope& body) {
  const Vec3 local = pose.rotation().transpose() * (point - pose.translation());
  double most = -std::numeric_limits<double>::infinity();
  for (int f = 0; f < body.num_facets(); ++f) {
    most = std::max(most, body.facet_normal(f).dot(local - body.vertex(body.facet_vertices(f)[0])));
  }
  return most;
}

TEST_P(SolidsOfFewFacets, CertifiedBracketsHoldTheTightestDepth) {
  Scratch scratch;
  int overlapping = 0, by_facets = 0;
  for (int i = 0; i < (is_middle(GetParam()) ? 200 : 500); ++i) {
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
    if (!is_middle(GetParam())) continue;
    EXPECT_LE((fast.normal - exact.normal).norm(), 1e-12);
    EXPECT_TRUE(same(fast.feature_a, exact.feature_a) && same(fast.feature_b, exact.feature_b));
    // The tightest answer has the bits that a search gives it.
    const PenetrationDepth searched = penetration_depth(a, b, scratch, {.method = Method::expansion});
    EXPECT_EQ(exact.lower, searched.lower);
    EXPECT_EQ(exact.upper, searched.upper);
    EXPECT_EQ(exact.translation, searched.translation);
    EXPECT_EQ(exact.witness_a, searched.witness_a);
    EXPECT_TRUE(same(exact.feature_a, searched.feature_a) && same(exact.feature_b, searched.feature_b));
  }
  EXPECT_GT(overlapping, 100);
  if (GetParam() == Kind::roofs) return;  // left to the surface
  EXPECT_GT(by_facets, overlapping * (is_middle(GetParam()) ? 15 : 19) / 20);
}

INSTANTIATE_TEST_SUITE_P(Kinds, SolidsOfFewFacets,
                         ::testing::Values(Kind::round, Kind::slender, Kind::flat, Kind::tetrahedra, Kind::box_and_hull,
                                           Kind::middle, Kind::cloud, Kind::prism, Kind::box_and_middle, Kind::mixed,
                                           Kind::roofs));

Mat3 turned_about_z(double angle) { return Eigen::AngleAxisd(angle, Vec3::UnitZ()).matrix(); }

/// Edges parallel to others or to facets: exactly, and but for a turn that single precision cannot tell from none.
TEST(SolidsOfFewFacetsAligned, AreLeftToTheSurfaceOrCertifiedRightly) {
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

/// Parallel edges and facets, exactly and but for a turn that single precision cannot tell from none; slender bodies;
/// more vertices than there is room for.
TEST(SolidsOfFewFacetsAligned, AreAnsweredRightly) {
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

/// Boxes as a mesh file holds them: eight points, turned, moved and rounded to single precision, so that their faces
/// are two triangles each and no edges are parallel. At rest, and off parallel by 1e-7. Few pairs of edges are measured
/// though most that lie in flush faces cross up to rounding.
TEST(SolidsOfFewFacetsAligned, BoxesOfRoundedPointsNeedNoSurface) {
  scenes::Random random(41);
  Scratch scratch;
  int by_facets = 0, overlapping = 0;
  std::int64_t measured = 0;
  for (int i = 0; i < 300; ++i) {
    SCOPED_TRACE(i);
    const auto box = [&](const Vec3& half) {
      const Mat3 turn = Pose::from_quaternion(random.quaternion(), Vec3::Zero())->rotation();
      std::vector<Vec3> points;
      for (int k = 0; k < 8; ++k) {
        const Vec3 corner =
            turn * Vec3(k & 4 ? half.x() : -half.x(), k & 2 ? half.y() : -half.y(), k & 1 ? half.z() : -half.z());
        points.push_back(corner.cast<float>().cast<double>());
      }
      return std::pair(ConvexShape(*ConvexPolytope::from_points(points)), turn);
    };
    const Vec3 half_a(0.5, 0.6, 0.7), half_b(1.2, 0.9, 0.4);
    const auto [a, turn_a] = box(half_a);
    const auto [b, turn_b] = box(half_b);
    const double angle = i % 2 == 0 ? 0 : 1e-7;
    const Mat3 upright = Eigen::AngleAxisd(angle, Vec3(0.6, 0.8, 0)).toRotationMatrix();
    const double sunk = i % 3 == 0 ? 0.01 : i % 3 == 1 ? 0.1 : 0.6;
    const Vec3 at{random.uniform(-0.6, 0.6), random.uniform(-0.6, 0.6), half_a.z() + half_b.z() - sunk};
    const PosedShape first{&a, *Pose::from_matrix(upright * turn_a.transpose(), at)};
    const PosedShape second{&b, *Pose::from_matrix(turn_b.transpose(), Vec3::Zero())};
    const PenetrationDepth fast = penetration_depth(first, second, scratch, {.bracket = Bracket::certified});
    const PenetrationDepth exact = penetration_depth(first, second, scratch);
    ASSERT_EQ(fast.contact, exact.contact);
    EXPECT_LE(fast.lower, exact.upper);
    EXPECT_GE(fast.upper, exact.lower);
    EXPECT_LE(fast.upper - fast.lower, 1e-13);
    ++overlapping;
    by_facets += static_cast<int>(fast.method == Method::overlay);
    measured += fast.statistics.facets_visited;
  }
  EXPECT_GT(by_facets, overlapping * 9 / 10);
  EXPECT_LT(measured, 6 * overlapping);
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
    EXPECT_TRUE(map.left[e] == map.edge[e].left && map.right[e] == map.edge[e].right);
    const Vec3 along = box.vertex(map.edge[e].to) - box.vertex(map.edge[e].from);
    EXPECT_GT(box.facet_normal(map.edge[e].left).cross(box.facet_normal(map.edge[e].right)).dot(along), 0);
  }
  std::vector<Vec3> nine;
  for (int i = 0; i < 9; ++i) nine.emplace_back(std::cos(i), std::sin(i), 0.1 * i * i);
  EXPECT_FALSE(has_small_gauss_map(*ConvexPolytope::from_points(nine)));
}

}  // namespace
}  // namespace detail
}  // namespace pd

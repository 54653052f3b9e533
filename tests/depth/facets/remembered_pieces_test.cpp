/// @file
/// Facets of P remembered of an earlier frame: wherever the bodies have gone since, what is certified holds.

#include "depth/facets/remembered_pieces.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>

#include "depth/difference/bracket_width.hpp"
#include "pd/depth/penetration_depth.hpp"
#include "pd/depth/scratch.hpp"
#include "pd/depth/warm_certificate.hpp"
#include "scenes/shape_families.hpp"

namespace pd::detail {
namespace {

using scenes::DepthClass;
using scenes::PairFamily;

constexpr DepthSettings kHot{.bracket = Bracket::certified};

struct Looks {
  int all = 0, certified = 0, wrong_facet_then = 0;
};

/// Looks from many places at what was remembered of one.
class RememberedPieces : public ::testing::TestWithParam<PairFamily> {
 protected:
  Vec3 direction() { return Vec3(normal_(random_), normal_(random_), normal_(random_)).normalized(); }
  Pose moved(const Pose& pose, double size) {
    const Mat3 turn = Eigen::AngleAxisd(size * normal_(random_), direction()).toRotationMatrix();
    return Pose::from_trusted_matrix(turn * pose.rotation(),
                                     pose.translation() + 0.3 * size * normal_(random_) * direction());
  }

  void look(const scenes::PointPair& points, Looks& looks) {
    const ConvexShape shape_a(*ConvexPolytope::from_points(points.a));
    const ConvexShape shape_b(*ConvexPolytope::from_points(points.b));
    WarmCertificate certificate;
    const PenetrationDepth then =
        penetration_depth({&shape_a, points.pose_a}, {&shape_b, points.pose_b}, scratch_, kHot, &certificate);
    const WarmSmallSolids& small = certificate.state().small;
    if (!small.known) return;
    const WarmPieces& pieces = small.pieces[0];
    // The pair's canonical order may be the other one.
    const bool swapped = !pieces.a->same_storage(*shape_a.polytope());
    for (int trial = 0; trial < 150; ++trial) {
      const double size = std::pow(10.0, -5 + 4.5 * trial / 150);
      const Pose pose_a = moved(points.pose_a, size), pose_b = moved(points.pose_b, size);
      const Pose &first = swapped ? pose_b : pose_a, &second = swapped ? pose_a : pose_b;
      PolytopeDifference difference(*pieces.a, first, *pieces.b, second);
      difference.prepare_supports(posed_);
      int looked_at = 0;
      const NearFacets found =
          certify_remembered_pieces(pieces, first, second, difference, BracketWidth{2e-14, 0}, looked_at);
      ++looks.all;
      if (!found.certified) continue;
      ++looks.certified;
      EXPECT_LE(looked_at, pieces.count);
      const PenetrationDepth cold = penetration_depth({&shape_a, pose_a}, {&shape_b, pose_b}, scratch_);
      ASSERT_EQ(cold.contact, ContactClass::overlapping) << "trial " << trial;
      EXPECT_LE(found.lower, cold.upper) << "trial " << trial;
      EXPECT_GE(found.upper, cold.lower) << "trial " << trial;
      EXPECT_LE(found.upper - found.lower, 1e-13);
      const Vec3 out = swapped ? Vec3(-then.normal) : then.normal;
      looks.wrong_facet_then += static_cast<int>(found.normal.dot(out) < 0.9);
    }
  }

 private:
  std::mt19937_64 random_{23};
  std::normal_distribution<double> normal_;
  Scratch scratch_;
  PosedVerticesPair posed_;
};

TEST_P(RememberedPieces, HoldWhereverTheyAreCertified) {
  Looks looks;
  for (const DepthClass depth : {DepthClass::shallow, DepthClass::mid, DepthClass::deep}) {
    for (std::uint64_t seed = 1; seed <= 12; ++seed) look(scenes::make_pair(GetParam(), 8, depth, seed), looks);
  }
  std::printf("%d of %d looks certified, %d of them with another facet\n", looks.certified, looks.all,
              looks.wrong_facet_then);
  // Both happen, or nothing was tested; and the nearest facet changes.
  EXPECT_GT(looks.certified, looks.all / 4);
  EXPECT_LT(looks.certified, looks.all);
  EXPECT_GT(looks.wrong_facet_then, 10);
}

INSTANTIATE_TEST_SUITE_P(Families, RememberedPieces,
                         ::testing::Values(PairFamily::sphere, PairFamily::needle, PairFamily::clouds),
                         [](const auto& named) { return std::string(to_string(named.param)); });

/// A matrix that is no rotation turns the inner ball into anything.
TEST(RememberedPiecesOf, PosesThatAreNoRotationsAreNotKept) {
  const scenes::PointPair points = scenes::make_pair(PairFamily::sphere, 8, DepthClass::mid, 1);
  const ConvexShape a(*ConvexPolytope::from_points(points.a)), b(*ConvexPolytope::from_points(points.b));
  Scratch scratch;
  for (const double scale : {1.0, 1.01}) {
    WarmCertificate certificate;
    const Pose pose = Pose::from_trusted_matrix(scale * points.pose_b.rotation(), points.pose_b.translation());
    (void)penetration_depth({&a, points.pose_a}, {&b, pose}, scratch, kHot, &certificate);
    EXPECT_EQ(certificate.state().small.known, scale == 1.0);
  }
}

}  // namespace
}  // namespace pd::detail

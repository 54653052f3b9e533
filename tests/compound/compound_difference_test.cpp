/// @file
/// The built boundary of P for unions: its volume is that of the cells it encloses, every ray from inside leaves
/// through it, and the distance from the origin to it is the depth that the search finds.
#include "pd/compound/compound_difference.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "compound/scene_compounds.hpp"
#include "pd/depth/scratch.hpp"
#include "pd/shape/star_body.hpp"
#include "scenes/non_convex.hpp"

namespace pd {
namespace {

Vec3 corner(const UnionDifference& p, const UnionDifference::Facet& facet, int k) {
  const auto at = static_cast<std::size_t>(facet.first + k % facet.count);
  return p.vertices[static_cast<std::size_t>(p.corners[at])];
}

/// Volume inside the boundary, by the divergence theorem.
double volume(const UnionDifference& p) {
  double sum = 0;
  for (const UnionDifference::Facet& facet : p.facets) {
    for (int k = 1; k + 1 < facet.count; ++k) {
      sum += corner(p, facet, 0).dot(corner(p, facet, k).cross(corner(p, facet, k + 1))) / 6;
    }
  }
  return sum;
}

double segment_distance(const Vec3& from, const Vec3& to) {
  const Vec3 edge = to - from;
  const double t = std::clamp(-from.dot(edge) / edge.squaredNorm(), 0.0, 1.0);
  return (from + t * edge).norm();
}

/// Distance of the origin from the boundary: plain loops over polygons.
double distance(const UnionDifference& p) {
  double best = HUGE_VAL;
  for (const UnionDifference::Facet& facet : p.facets) {
    const double height = facet.normal.dot(corner(p, facet, 0));
    const Vec3 foot = height * facet.normal;
    bool inside = true;
    for (int k = 0; k < facet.count; ++k) {
      const Vec3 from = corner(p, facet, k), to = corner(p, facet, k + 1);
      if (from != to) best = std::min(best, segment_distance(from, to));
      inside = inside && (to - from).cross(foot - from).dot(facet.normal) >= 0;
    }
    if (inside) best = std::min(best, std::abs(height));
  }
  return best;
}

/// How often the ray from `from` along a direction leaves less how often it enters.
int leaves(const UnionDifference& p, const Vec3& from, const Vec3& direction) {
  int count = 0;
  for (const UnionDifference::Facet& facet : p.facets) {
    const double slope = facet.normal.dot(direction);
    const double t = facet.normal.dot(corner(p, facet, 0) - from) / slope;
    if (!(t > 0)) continue;
    const Vec3 x = from + t * direction;
    bool inside = true;
    for (int k = 0; k < facet.count; ++k) {
      const Vec3 a = corner(p, facet, k), b = corner(p, facet, k + 1);
      inside = inside && (b - a).cross(x - a).dot(facet.normal) > 0;
    }
    if (inside) count += slope > 0 ? 1 : -1;
  }
  return count;
}

TEST(UnionDifference, VolumesOfKnownSums) {
  const Compound cube(ConvexShape(*ConvexPolytope::box({0.5, 0.5, 0.5})));
  const Compound tight = compound_of(scenes::letter_u(1)), wide = compound_of(scenes::letter_u(1.5));
  // A U grown by a cube: the channel closes where it has no play, and nothing of the wall stays.
  const UnionDifference closed = *minkowski_difference({&cube, Pose()}, {&tight, Pose()});
  EXPECT_NEAR(volume(closed), 4 * 4 * 3, 1e-12);
  for (const UnionDifference::Facet& facet : closed.facets) {
    for (int k = 0; k < facet.count; ++k) {
      const Vec3 x = corner(closed, facet, k);
      EXPECT_TRUE(std::abs(x.x()) == 2 || std::abs(x.z()) == 1.5 || x.y() == 1.5 || x.y() == -2.5) << x.transpose();
    }
  }
  const UnionDifference open = *minkowski_difference({&cube, Pose()}, {&wide, Pose()});
  EXPECT_NEAR(volume(open), (4.5 * 4 - 0.5 * 2) * 3, 1e-12);
  // A room with a cavity: its inner surface bounds int P, too.
  const Compound room = compound_of(scenes::room(1, 0.25));
  const UnionDifference hollow = *minkowski_difference({&cube, Pose()}, {&room, Pose()});
  EXPECT_NEAR(volume(hollow), 3.5 * 3.5 * 3.5 - 1, 1e-12);
}

TEST(UnionDifference, NearestPointIsTheDepth) {
  scenes::Random random(21);
  Scratch scratch;
  const std::vector<Compound> bodies{compound_of(scenes::letter_l()), compound_of(scenes::cross()),
                                     compound_of(scenes::rubble(3, 8, random)), compound_of(scenes::spiked_star(1.5))};
  int overlapping = 0;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    for (int turned = 0; turned < 2; ++turned) {
      const Vec3 place = 0.5 * random.direction();
      const Pose pose = turned == 0 ? *Pose::from_matrix(Mat3::Identity(), place) : random.pose(place);
      const Compound& other = bodies[i == 0 ? 1 : 0];
      const PosedCompound a{&bodies[i], pose}, b{&other, Pose()};
      const UnionDepth answer = *penetration_depth(a, b, scratch);
      const UnionDifference built = *minkowski_difference(a, b);
      EXPECT_GT(volume(built), 0);
      if (answer.contact != ContactClass::overlapping) continue;
      ++overlapping;
      EXPECT_NEAR(answer.depth, distance(built), 1e-12) << "body " << i;
      for (int k = 0; k < 20; ++k) EXPECT_EQ(leaves(built, Vec3::Zero(), random.direction()), 1) << "body " << i;
    }
  }
  EXPECT_GT(overlapping, 4);
}

TEST(UnionDifference, StarsGiveAStarAndItsEnvelopeTheDepth) {
  scenes::Random random(4);
  Scratch scratch;
  const Compound a = compound_of(scenes::spiked_star(1)), b = compound_of(scenes::rough_ball(0, 0.4, random));
  const Vec3 offset(0.75, 0.125, -0.25);
  const Pose pose = random.pose(offset);
  const PosedCompound posed_a{&a, pose}, posed_b{&b, Pose()};
  const UnionDifference built = *minkowski_difference(posed_a, posed_b);
  // Star-shaped about c_B - c_A: every facet is seen from there from its inner side, and each ray leaves once.
  const Vec3 centre = -offset;
  for (const UnionDifference::Facet& facet : built.facets) {
    EXPECT_GT(facet.normal.dot(corner(built, facet, 0) - centre), 0);
  }
  for (int k = 0; k < 200; ++k) EXPECT_EQ(leaves(built, centre, random.direction()), 1);
  const UnionDepth answer = *penetration_depth(posed_a, posed_b, scratch);
  ASSERT_EQ(answer.contact, ContactClass::overlapping);
  EXPECT_NEAR(answer.depth, distance(built), 1e-12);
  // Asked the other way round, the same answer turned round, to the bit.
  const UnionDepth swapped = *penetration_depth(posed_b, posed_a, scratch);
  EXPECT_EQ(swapped.lower, answer.lower);
  EXPECT_EQ(swapped.upper, answer.upper);
  EXPECT_EQ(swapped.translation, -answer.translation);
  EXPECT_EQ(swapped.part_a, answer.part_b);
}

// Deep inside each other nearly all pairs of parts overlap: the search by cubes finds what all of the boundary says,
// and cuts next to nothing.
TEST(UnionDifference, DeepRoughBallsAreAnsweredByTheirBoundaryAndFewCuts) {
  for (std::uint64_t seed = 1; seed <= 2; ++seed) {
    scenes::Random random(seed);
    const Compound a = compound_of(scenes::rough_ball(0, 0.3, random)),
                   b = compound_of(scenes::rough_ball(0, 0.3, random)),
                   large = compound_of(scenes::rough_ball(1, 0.3, random));
    const Pose pose = random.pose({0.3, 0.1, 0.2});
    Scratch scratch;
    const UnionDepth answer = *penetration_depth(PosedCompound{&a, pose}, PosedCompound{&b, Pose()}, scratch);
    const UnionDifference built = *minkowski_difference({&a, pose}, {&b, Pose()});
    EXPECT_NEAR(distance(built), answer.depth, 1e-12) << "seed " << seed;
    EXPECT_LT(answer.work.cuts, built.work.cuts / 3);

    const UnionDepth deep = *penetration_depth(PosedCompound{&large, pose}, PosedCompound{&b, Pose()}, scratch);
    EXPECT_GE(deep.depth, deep.lower);
    EXPECT_LT(deep.work.cuts, 2000) << "of " << deep.work.facets << " facets";
  }
}

TEST(UnionDifference, LimitsAndOtherShapesAreRefused) {
  const Compound cube(ConvexShape(*ConvexPolytope::box({0.5, 0.5, 0.5})));
  const Compound ball(*ConvexShape::sphere(1));
  EXPECT_EQ(minkowski_difference({&cube, Pose()}, {&cube, Pose()}, 5).error().code, ErrorCode::limit_exceeded);
  const auto ended = minkowski_difference({&cube, Pose()}, {&cube, Pose()}, 1000, 5);
  ASSERT_FALSE(ended.has_value());
  EXPECT_EQ(ended.error().code, ErrorCode::limit_exceeded);
  EXPECT_EQ(ended.error().where, "max_work");
  EXPECT_EQ(minkowski_difference({&cube, Pose()}, {&ball, Pose()}).error().code, ErrorCode::unsupported);
}

}  // namespace
}  // namespace pd

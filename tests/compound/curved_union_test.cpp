/// @file
/// Unions with curved or swept parts: brackets within a budget of operations, `bracket_reached` where they are wider
/// than asked, and witnesses that lie on the bodies.

#include <gtest/gtest.h>

#include <cmath>

#include "compound/scene_compounds.hpp"
#include "oracle/member_oracle.hpp"
#include "pd/contact/manifold.hpp"
#include "pd/depth/scratch.hpp"
#include "scenes/shape_families.hpp"

namespace pd {
namespace {

constexpr std::int64_t kMostPairs = 12'000;  ///< the octree's 8,192, and what decides classes and slides placements

Pose turned(const Vec3& axis, const Vec3& t) {
  const double length = std::sqrt(1 + axis.squaredNorm());
  return *Pose::from_quaternion({1 / length, axis.x() / length, axis.y() / length, axis.z() / length}, t);
}
Pose at(const Vec3& t) { return turned(Vec3::Zero(), t); }

ConvexShape hull(const std::vector<Vec3>& points) { return *ConvexPolytope::from_points(points); }

double distance_outside(const PosedCompound& body, const Vec3& point) {
  double least = HUGE_VAL;
  const std::vector<PosedShape> parts = *body.body->posed(body.pose);
  for (const PosedShape& part : parts) {
    least = std::min(least, static_cast<double>(oracle::distance_outside(part, point)));
  }
  return least;
}

/// What every answer keeps, reached or not.
UnionDepth expect_kept(const PosedCompound& a, const PosedCompound& b, double size, double delta = 1e-2) {
  Scratch scratch;
  const UnionDepth answer = *penetration_depth(a, b, scratch, {.delta = delta});
  EXPECT_LE(answer.work.pairs, kMostPairs);
  EXPECT_LE(answer.lower, answer.upper);
  if (answer.contact == ContactClass::overlapping) {
    EXPECT_EQ(answer.bracket_reached, answer.upper <= (1 + delta) * answer.lower)
        << answer.lower << " " << answer.upper;
  }
  EXPECT_LE(distance_outside(a, answer.witness_a), 1e-9 * size);
  EXPECT_LE(distance_outside(b, answer.witness_b), 1e-9 * size);
  ManifoldScratch manifolds;
  const std::vector<PosedShape> parts_a = *a.body->posed(a.pose), parts_b = *b.body->posed(b.pose);
  const ContactManifold manifold =
      contact_manifold(parts_a[static_cast<std::size_t>(answer.part_a)],
                       parts_b[static_cast<std::size_t>(answer.part_b)], answer, 1e-3, manifolds);
  for (int i = 0; i < manifold.count; ++i) {
    const ContactPoint& point = manifold.points[static_cast<std::size_t>(i)];
    EXPECT_LE(distance_outside(a, point.position_a), 1e-7 * size) << "point " << i;
    EXPECT_LE(distance_outside(b, point.position_b), 1e-7 * size) << "point " << i;
  }
  // The way out leads out.
  for (const PosedShape& x : parts_a) {
    const PosedShape moved{x.shape,
                           Pose::from_trusted_matrix(x.pose.rotation(), x.pose.translation() + answer.translation)};
    for (const PosedShape& y : parts_b) {
      EXPECT_LE(penetration_depth(moved, y, scratch).lower, 1e-9 * size);
    }
  }
  return answer;
}

TEST(CurvedUnion, ThinEllipsoidOnBoxAndTetrahedron) {
  const Compound base = *Compound::from_parts(
      {{*ConvexPolytope::box({1, 1, 1}), Pose()}, {hull({{1, -1, -1}, {1, 1, -1}, {1, 0, 1}, {3, 0, 0}}), Pose()}});
  for (const int k : {4, 8, 10, 12, 16, 24}) {
    SCOPED_TRACE(k);
    const Compound thin(*ConvexShape::ellipsoid({1, 1, std::ldexp(1.0, -k)}));
    const Pose across = turned({0.2, 1, 0.1}, {1, 0.1, 0.2});
    EXPECT_TRUE(expect_kept({&thin, across}, {&base, Pose()}, 5).bracket_reached);
    EXPECT_TRUE(expect_kept({&base, Pose()}, {&thin, at({0.9, 0, 0.3})}, 5).bracket_reached);
  }
}

// Builds that check every surface take some twenty times as long: they ask a sample of the placements.
#ifdef PD_VALIDATE
constexpr int kPlacesInAStar = 1, kStepOverKinds = 7;
#else
constexpr int kPlacesInAStar = 3, kStepOverKinds = 1;
#endif

TEST(CurvedUnion, SmallBodiesInAStar) {
  const Compound star = compound_of(scenes::spiked_star(2));
  scenes::Random random(3);
  for (const double radius : {0.3, 0.01, 0.003, 7e-5}) {
    SCOPED_TRACE(radius);
    const Compound ball(*ConvexShape::sphere(radius));
    const Compound coin(*ConvexShape::cylinder(0.5, radius / 16, 2));
    for (int k = 0; k < kPlacesInAStar; ++k) {
      const Pose place = random.pose(random.vector(0, 0.4));
      EXPECT_TRUE(expect_kept({&ball, place}, {&star, Pose()}, 4).bracket_reached);
      expect_kept({&coin, place}, {&star, Pose()}, 4);
    }
  }
}

TEST(CurvedUnion, WideBracketsSaySo) {
  // A triangle and a segment, and a coin: P has walls as thin as the coin, and the octree's cells end at them.
  const Compound thin = *Compound::from_parts(
      {{hull({{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}}), Pose()}, {hull({{0, 0, -1}, {0, 0, 1}}), Pose()}});
  const Compound coin(*ConvexShape::cylinder(1, 0x1p-12, 2));
  expect_kept({&coin, Pose()}, {&thin, Pose()}, 2);
  expect_kept({&coin, at({0.1, 0.2, 0})}, {&thin, Pose()}, 2);
  expect_kept({&coin, turned({0.3, 0, 0}, Vec3::Zero())}, {&thin, Pose()}, 2);
}

TEST(CurvedUnion, WitnessesOfAllKinds) {
  scenes::Random random(8);
  const std::vector<ConvexShape> kinds{
      *ConvexShape::sphere(0.7),           *ConvexShape::ellipsoid({0.8, 0.5, 0.3}),
      *ConvexShape::cylinder(0.5, 0.7, 1), *ConvexShape::cone(0.6, 0.5, 0),
      *ConvexShape::capsule(0.3, 0.6, 2),  *ConvexShape(*ConvexPolytope::box({0.4, 0.5, 0.6})).with_margin(0.125)};
  int reached = 0, asked = 0;
  for (int k = 0; k < 36; k += kStepOverKinds) {
    SCOPED_TRACE(k);
    const auto part = [&](int i) {
      return Compound::Part{kinds[static_cast<std::size_t>(i)], random.pose(0.7 * random.direction())};
    };
    const Compound a = *Compound::from_parts({part(k % 6), part((k + 1) % 6)});
    const Compound b = *Compound::from_parts({part(k / 6), {*ConvexPolytope::box({0.5, 0.4, 0.8}), at({0.3, 0, 0})}});
    const Pose pose = random.pose(random.vector(0, 1.5));
    reached += expect_kept({&a, pose}, {&b, Pose()}, 4).bracket_reached ? 1 : 0;
    ++asked;
  }
  EXPECT_GE(reached, asked - 2);
}

}  // namespace
}  // namespace pd

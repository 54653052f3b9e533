/// @file
/// Bodies that fit together, turned as a whole: what is parallel stays so on the stored numbers (axes exchanged, one
/// rotation) or up to the rounding of two rotations (boxes face on face). The tightest answer against the search.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "pd/depth/penetration_depth.hpp"
#include "pd/depth/scratch.hpp"
#include "scenes/shape_families.hpp"

namespace pd {
namespace {

using Quaternion = std::array<double, 4>;

Quaternion product(const Quaternion& p, const Quaternion& q) {
  const Eigen::Quaterniond r = Eigen::Quaterniond(p[0], p[1], p[2], p[3]) * Eigen::Quaterniond(q[0], q[1], q[2], q[3]);
  return {r.w(), r.x(), r.y(), r.z()};
}

struct Pair {
  ConvexShape a, b;
  Quaternion turn_a, turn_b;
  Vec3 offset;  ///< of A from B
};

enum class Stored { matrix, quaternion };

Pose turned(const Quaternion& whole, const Quaternion& own, const Vec3& at, Stored stored) {
  const Mat3 rotation = Pose::from_quaternion(whole, Vec3::Zero())->rotation();
  const Vec3 place = rotation * at;
  if (stored == Stored::quaternion) return *Pose::from_quaternion(product(whole, own), place);
  return Pose::from_trusted_matrix(rotation * Pose::from_quaternion(own, Vec3::Zero())->rotation(), place);
}

/// The bits of the answer that a search ends with.
void expect_as_searched(const Pair& pair, const Quaternion& whole, Stored stored, Scratch& scratch, int& overlapping) {
  const PosedShape a{&pair.a, turned(whole, pair.turn_a, pair.offset, stored)};
  const PosedShape b{&pair.b, turned(whole, pair.turn_b, Vec3::Zero(), stored)};
  const PenetrationDepth found = penetration_depth(a, b, scratch);
  const PenetrationDepth searched = penetration_depth(a, b, scratch, {.method = Method::expansion});
  const PenetrationDepth of_all = penetration_depth(a, b, scratch, {.method = Method::overlay});
  ASSERT_EQ(found.contact, searched.contact);
  EXPECT_EQ(found.lower, searched.lower);
  EXPECT_EQ(found.upper, searched.upper);
  EXPECT_EQ(found.lower, of_all.lower);
  EXPECT_EQ(found.upper, of_all.upper);
  // Of a plane that two facets share either one may be measured.
  EXPECT_LE((found.translation - searched.translation).norm(), 0x1p-44 * found.upper);
  EXPECT_LE(found.translation.norm(), found.upper * (1 + 0x1p-50));
  EXPECT_EQ(found.normal, searched.normal);
  EXPECT_EQ(found.feature_a.kind, searched.feature_a.kind);
  EXPECT_EQ(found.feature_a.first, searched.feature_a.first);
  EXPECT_EQ(found.feature_b.kind, searched.feature_b.kind);
  EXPECT_EQ(found.feature_b.first, searched.feature_b.first);
  overlapping += found.contact == ContactClass::overlapping ? 1 : 0;
}

/// The upper box turned about the vertical, a millionth to a hundredth of its size in the other.
TEST(TurnedTogether, BoxesFaceOnFace) {
  scenes::Random random(3);
  Scratch scratch;
  int overlapping = 0;
  constexpr int kPairs = 400;
  for (int i = 0; i < kPairs; ++i) {
    SCOPED_TRACE(i);
    Vec3 a = random.point(0.1, 1), b = random.point(0.1, 1);
    // Planks and plates, and crumbs on large floors.
    if (i % 5 == 0) a.x() *= 1e-3;
    if (i % 7 == 0) b *= 1e3;
    if (i % 11 == 0) a *= 1e-5;
    const double sunk = a.minCoeff() * (i % 3 == 0 ? 1e-6 : i % 3 == 1 ? 1e-4 : 1e-2);
    const double half = i % 4 == 0 ? 0 : random.uniform(-1, 1), length = std::hypot(1, half);
    const double x = random.uniform(-0.9, 0.9) * b.x(), y = random.uniform(-0.9, 0.9) * b.y();
    const Pair pair{*ConvexPolytope::box(a),
                    *ConvexPolytope::box(b),
                    {1 / length, 0, 0, half / length},
                    {1, 0, 0, 0},
                    {x, y, a.z() + b.z() - sunk}};
    const Quaternion whole = random.quaternion();
    expect_as_searched(pair, whole, Stored::matrix, scratch, overlapping);
    expect_as_searched(pair, whole, Stored::quaternion, scratch, overlapping);
  }
  EXPECT_GE(overlapping, 2 * kPairs - 8);  // crumbs are lifted by rounding
}

/// Boxes and prisms by right angles and half turns of each other, and hulls of integer points: all edges that can be
/// are parallel.
TEST(TurnedTogether, BodiesBuiltAlongCommonAxes) {
  scenes::Random random(5);
  Scratch scratch;
  const double r = std::sqrt(0.5);
  const Quaternion turns[] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}, {r, r, 0, 0}, {r, 0, -r, 0}};
  int overlapping = 0, tried = 0;
  for (int i = 0; i < 120; ++i) {
    SCOPED_TRACE(i);
    const auto body = [&](int kind) -> ConvexShape {
      switch (kind) {
        case 0:
          return *ConvexPolytope::box({0.5, 0.75, 0.25 * random.integer(1, 4)});
        case 1:
          return *ConvexPolytope::from_points(scenes::prism(12));
        default:
          return *ConvexPolytope::from_points(scenes::integer_points(10, 2, random));
      }
    };
    ConvexShape first = body(i % 3);
    const Vec3 offset = i % 5 == 0 ? Vec3(0.25, 0.5, 0) : random.point(-0.5, 0.5);
    const Pair pair{std::move(first), body(i / 3 % 3), turns[i % 6], turns[i / 2 % 6], offset};
    const Quaternion whole = random.quaternion();
    for (const Stored stored : {Stored::matrix, Stored::quaternion}) {
      expect_as_searched(pair, whole, stored, scratch, overlapping);
      ++tried;
    }
  }
  EXPECT_GT(overlapping, tried * 3 / 4);
}

}  // namespace
}  // namespace pd

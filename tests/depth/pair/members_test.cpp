/// @file
/// The law of witnesses: whatever the kinds, the class and the method of an answer, its witnesses and the points of its
/// manifold are points of both bodies, posed and with their margins.

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "oracle/curved_oracle.hpp"
#include "oracle/member_oracle.hpp"
#include "pd/contact/manifold.hpp"
#include "pd/depth/penetration_depth.hpp"
#include "pd/depth/scratch.hpp"
#include "scenes/shape_families.hpp"

namespace pd {
namespace {

using scenes::Random;

constexpr double kOff = 1e-9;  ///< of the size
/// The same of the other points of a manifold, which are found across a normal that leaves open what the bracket does.
constexpr double kOffFaces = 1e-7;

struct NamedKind {
  std::string name;
  ConvexShape shape;
};

/// Every kind of shape, with sizes of one order and far apart ones.
std::vector<NamedKind> all_kinds(Random& random) {
  const auto size = [&] { return std::exp2(random.uniform(-1.0, 1.0)); };
  const auto points = [&](int n) {
    std::vector<Vec3> some;
    for (int i = 0; i < n; ++i) some.push_back(size() * random.direction());
    return ConvexShape(*ConvexPolytope::from_points(some));
  };
  const std::vector<Sphere> spheres{{{0, 0, 0}, size() / 2}, {{size(), 0, 0}, 0.25}, {{0, size(), 0.2}, 0.125}};
  return {
      {"box", ConvexShape(*ConvexPolytope::box({size(), size(), size()}))},
      {"hull", points(12)},
      {"triangle", points(3)},
      {"segment", points(2)},
      {"rounded box", *ConvexShape(*ConvexPolytope::box({size(), size(), size()})).with_margin(0.25)},
      {"sphere", *ConvexShape::sphere(size())},
      {"capsule", *ConvexShape::capsule(size() / 2, size(), random.integer(0, 2))},
      {"ellipsoid", *ConvexShape::ellipsoid({size(), size(), size()})},
      {"long ellipsoid", *ConvexShape::ellipsoid({0.01, 0.1, 2})},
      {"flat ellipsoid", *ConvexShape::ellipsoid({2, 2, 0x1p-16})},
      {"rounded ellipsoid", *ConvexShape::ellipsoid({size(), size(), size()})->with_margin(0.125)},
      {"cylinder", *ConvexShape::cylinder(size(), size(), random.integer(0, 2))},
      {"coin", *ConvexShape::cylinder(1, 0x1p-12, random.integer(0, 2))},
      {"cone", *ConvexShape::cone(size(), size(), random.integer(0, 2))},
      {"rounded cone", *ConvexShape::cone(size(), size(), random.integer(0, 2))->with_margin(0.125)},
      {"sphere hull", *ConvexShape::hull_of_spheres(spheres)},
  };
}

double size_of(const PosedShape& a, const PosedShape& b) {
  double size = 0;
  for (int k = 0; k < 3; ++k) {
    for (const double sign : {1.0, -1.0}) {
      size = std::max(size, std::abs(static_cast<double>(oracle::difference_support(a, b, sign * Vec3::Unit(k)))));
    }
  }
  return size;
}

class Judge {
 public:
  int pairs = 0;
  int touching = 0;
  int overlapping = 0;

  /// Whether the answer of this pair keeps the law.
  void expect_members(const PosedShape& a, const PosedShape& b, const std::string& what) {
    SCOPED_TRACE(what);
    const double allowed = kOff * size_of(a, b);
    const PenetrationDepth answer = penetration_depth(a, b, scratch_);
    ++pairs;
    touching += answer.contact == ContactClass::touching ? 1 : 0;
    overlapping += answer.contact == ContactClass::overlapping ? 1 : 0;
    EXPECT_LE(oracle::distance_outside(a, answer.witness_a), allowed) << to_string(answer.contact) << answer.depth;
    EXPECT_LE(oracle::distance_outside(b, answer.witness_b), allowed) << to_string(answer.contact) << answer.depth;
    const double allowed_on_faces = kOffFaces * size_of(a, b);
    const ContactManifold manifold = contact_manifold(a, b, answer, 1e-3, manifold_scratch_);
    for (int i = 0; i < manifold.count; ++i) {
      const ContactPoint& point = manifold.points[static_cast<std::size_t>(i)];
      EXPECT_LE(oracle::distance_outside(a, point.position_a), allowed_on_faces)
          << "point " << i << " of A, depth " << point.depth;
      EXPECT_LE(oracle::distance_outside(b, point.position_b), allowed_on_faces)
          << "point " << i << " of B, depth " << point.depth;
    }
  }

 private:
  Scratch scratch_;
  ManifoldScratch manifold_scratch_;
};

template <class Place>
void for_all_pairs(std::uint64_t seed, Place&& place) {
  Random random(seed);
  const std::vector<NamedKind> kinds_a = all_kinds(random), kinds_b = all_kinds(random);
  for (const NamedKind& a : kinds_a) {
    for (const NamedKind& b : kinds_b) place(a, b, random);
  }
}

TEST(Members, BodiesThatTouch) {
  Judge judge;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    for_all_pairs(seed, [&](const NamedKind& a, const NamedKind& b, Random& random) {
      const Vec3 n = seed == 1 ? Vec3(Vec3::Unit(random.integer(0, 2))) : random.direction();
      const Pose pose_a = seed == 3 ? *Pose::from_quaternion(random.quaternion(), Vec3::Zero()) : Pose();
      const double height = static_cast<double>(oracle::difference_support({&a.shape, pose_a}, {&b.shape, Pose()}, n));
      const Pose pose_b = *Pose::from_quaternion({1, 0, 0, 0}, -height * n);
      judge.expect_members({&a.shape, pose_a}, {&b.shape, pose_b}, a.name + " touches " + b.name);
    });
  }
  EXPECT_GT(judge.touching, judge.pairs / 6);
}

TEST(Members, BodiesAtOnePlace) {
  Judge judge;
  for (std::uint64_t seed = 11; seed <= 12; ++seed) {
    for_all_pairs(seed, [&](const NamedKind& a, const NamedKind& b, Random& random) {
      judge.expect_members({&a.shape, Pose()}, {&b.shape, Pose()}, a.name + " in " + b.name);
      const Pose turned = *Pose::from_quaternion(random.quaternion(), Vec3::Zero());
      judge.expect_members({&a.shape, turned}, {&b.shape, turned}, a.name + " in " + b.name + ", turned");
    });
  }
  EXPECT_GT(judge.overlapping, judge.pairs * 3 / 4);
}

TEST(Members, BodiesInOneLine) {
  Judge judge;
  for (std::uint64_t seed = 21; seed <= 22; ++seed) {
    for_all_pairs(seed, [&](const NamedKind& a, const NamedKind& b, Random& random) {
      const Vec3 along = random.uniform(0.05, 1.5) * Vec3::Unit(random.integer(0, 2));
      judge.expect_members({&a.shape, Pose()}, {&b.shape, *Pose::from_quaternion({1, 0, 0, 0}, along)},
                           a.name + " aligned with " + b.name);
    });
  }
  EXPECT_GT(judge.overlapping, judge.pairs / 4);
}

TEST(Members, BodiesAnywhere) {
  Judge judge;
  for (std::uint64_t seed = 31; seed <= 33; ++seed) {
    for_all_pairs(seed, [&](const NamedKind& a, const NamedKind& b, Random& random) {
      const Pose pose_a = *Pose::from_quaternion(random.quaternion(), 3 * random.direction());
      const Pose pose_b =
          *Pose::from_quaternion(random.quaternion(), pose_a.translation() + random.uniform(0, 2) * random.direction());
      judge.expect_members({&a.shape, pose_a}, {&b.shape, pose_b}, a.name + " and " + b.name);
    });
  }
  EXPECT_GT(judge.overlapping, judge.pairs / 4);
}

/// These stood in a report: witnesses lay a corner's or a whole radius away.
TEST(Members, BoxBesideEllipsoid) {
  Scratch scratch;
  const ConvexShape box(*ConvexPolytope::box({1, 1, 1}));
  const ConvexShape ellipsoid = *ConvexShape::ellipsoid({1, 0.5, 2});
  const Pose beside = *Pose::from_quaternion({1, 0, 0, 0}, {2, 0, 0});
  const PenetrationDepth answer = penetration_depth({&box, Pose()}, {&ellipsoid, beside}, scratch);
  EXPECT_EQ(answer.contact, ContactClass::touching);
  EXPECT_LE((answer.witness_a - Vec3(1, 0, 0)).norm(), 1e-5);
  Judge judge;
  judge.expect_members({&box, Pose()}, {&ellipsoid, beside}, "box and ellipsoid");
  judge.expect_members({&ellipsoid, beside}, {&box, Pose()}, "ellipsoid and box");
}

}  // namespace
}  // namespace pd

/// @file
/// The laws of witnesses and manifolds (`oracle/member_laws.hpp`) for every pair of kinds and each way to stand.
/// `member_pairs` judges random pairs by the hundred thousand.

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "oracle/curved_oracle.hpp"
#include "oracle/member_laws.hpp"
#include "pd/depth/penetration_depth.hpp"
#include "pd/depth/scratch.hpp"
#include "scenes/shape_families.hpp"

namespace pd {
namespace {

using scenes::Random;

using oracle::MemberKind;

class Judge {
 public:
  /// Whether the answer of this pair keeps the laws.
  void expect_members(const PosedShape& a, const PosedShape& b, const std::string& what) {
    SCOPED_TRACE(what);
    for (const oracle::BrokenLaw& broken : judge_.judge(a, b, DepthSettings(), ++seed_)) {
      ADD_FAILURE() << to_string(broken.law) << ": " << broken.what;
    }
  }

  [[nodiscard]] std::int64_t pairs() const { return touching() + overlapping() + judge_.counts().classes[0]; }
  [[nodiscard]] std::int64_t touching() const { return judge_.counts().classes[1]; }
  [[nodiscard]] std::int64_t overlapping() const { return judge_.counts().classes[2]; }

 private:
  oracle::MemberJudge judge_;
  std::uint64_t seed_ = 0;
};

template <class Place>
void for_all_pairs(std::uint64_t seed, Place&& place) {
  Random random(seed);
  std::vector<MemberKind> kinds_a, kinds_b;
  for (std::vector<MemberKind>* kinds : {&kinds_a, &kinds_b}) {
    for (int kind = 0; kind < oracle::kMemberKinds; ++kind) kinds->push_back(oracle::make_member(kind, 1, random));
  }
  for (const MemberKind& a : kinds_a) {
    for (const MemberKind& b : kinds_b) place(a, b, random);
  }
}

TEST(Members, BodiesThatTouch) {
  Judge judge;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    for_all_pairs(seed, [&](const MemberKind& a, const MemberKind& b, Random& random) {
      const Vec3 n = seed == 1 ? Vec3(Vec3::Unit(random.integer(0, 2))) : random.direction();
      const Pose pose_a = seed == 3 ? random.pose(Vec3::Zero()) : Pose();
      const double height = static_cast<double>(oracle::difference_support({&a.shape, pose_a}, {&b.shape, Pose()}, n));
      const Pose pose_b = *Pose::from_quaternion({1, 0, 0, 0}, -height * n);
      judge.expect_members({&a.shape, pose_a}, {&b.shape, pose_b}, a.name + " touches " + b.name);
    });
  }
  EXPECT_GT(judge.touching(), judge.pairs() / 6);
}

TEST(Members, BodiesAtOnePlace) {
  Judge judge;
  for_all_pairs(11, [&](const MemberKind& a, const MemberKind& b, Random& random) {
    judge.expect_members({&a.shape, Pose()}, {&b.shape, Pose()}, a.name + " in " + b.name);
    const Pose turned = random.pose(Vec3::Zero());
    judge.expect_members({&a.shape, turned}, {&b.shape, turned}, a.name + " in " + b.name + ", turned");
  });
  EXPECT_GT(judge.overlapping(), judge.pairs() * 3 / 4);
}

TEST(Members, BodiesInOneLine) {
  Judge judge;
  for (std::uint64_t seed = 21; seed <= 22; ++seed) {
    for_all_pairs(seed, [&](const MemberKind& a, const MemberKind& b, Random& random) {
      const int axis = random.integer(0, 2);
      const Vec3 along = random.uniform(0.05, 1.5) * Vec3::Unit(axis);
      judge.expect_members({&a.shape, Pose()}, {&b.shape, *Pose::from_quaternion({1, 0, 0, 0}, along)},
                           a.name + " aligned with " + b.name);
    });
  }
  EXPECT_GT(judge.overlapping(), judge.pairs() / 4);
}

TEST(Members, BodiesAnywhere) {
  Judge judge;
  for (std::uint64_t seed = 31; seed <= 33; ++seed) {
    for_all_pairs(seed, [&](const MemberKind& a, const MemberKind& b, Random& random) {
      const Pose pose_a = random.pose(3 * random.direction());
      const Pose pose_b = random.pose(pose_a.translation() + random.vector(0, 2));
      judge.expect_members({&a.shape, pose_a}, {&b.shape, pose_b}, a.name + " and " + b.name);
    });
  }
  EXPECT_GT(judge.overlapping(), judge.pairs() / 4);
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

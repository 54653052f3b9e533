/// @file
/// Smooth bodies against the direction sweep: brackets that hold, are tight, and hold what they promise at every delta;
/// and polytopes stopped early.

#include <gtest/gtest.h>

#include <cmath>

#include "oracle/curved_oracle.hpp"
#include "oracle/judged_pair.hpp"

namespace pd {
namespace {

ConvexShape random_shape(int kind, scenes::Random& random) {
  const auto size = [&] { return random.uniform(0.3, 1.5); };
  struct Axial {
    int axis;
    double half_height;
    double radius;
  };
  const auto axial = [&] { return Axial{random.integer(0, 2), size(), size()}; };
  switch (kind) {
    case 0:
      return *ConvexShape::ellipsoid(random.point(0.3, 1.5));
    case 1: {
      const Axial sizes = axial();
      return *ConvexShape::cylinder(sizes.radius, sizes.half_height, sizes.axis);
    }
    case 2: {
      const Axial sizes = axial();
      return *ConvexShape::cone(sizes.radius, sizes.half_height, sizes.axis);
    }
    case 3: {
      const Axial sizes = axial();
      return *ConvexShape::capsule(sizes.radius, sizes.half_height, sizes.axis);
    }
    case 4:
      return *ConvexShape::sphere(size());
    case 5: {
      const double half_height = size();
      return *ConvexShape::cylinder(size(), half_height, 2)->with_margin(0.1);
    }
    case 6: {
      std::vector<Sphere> spheres(static_cast<std::size_t>(random.integer(2, 6)));
      for (Sphere& s : spheres) s = {random.vector(0.3, 1.5), random.uniform(0, 0.8)};
      return *ConvexShape::hull_of_spheres(spheres);
    }
    default:
      return ConvexShape(*ConvexPolytope::box(random.point(0.3, 1.5)));
  }
}

/// Kinds that are searched for whatever the other body is.
constexpr int kSearched[] = {0, 1, 2, 6};

TEST(Smooth, NormalsBesideHugeMarginsAreUnitVectors) {
  // Brought to size 1 the cores are so small that squares of their lengths, or products of those, underflow.
  Scratch scratch;
  scenes::Random random(47);
  for (const double margin : {1e70, 1e140, 1e160}) {
    for (int kind = 0; kind < 8; ++kind) {
      for (int k = 0; k < 8; ++k) {
        const ConvexShape a = random_shape(kind, random);
        std::vector<Vec3> corners;
        for (int i = 0; i < 4; ++i) corners.push_back(3 * random.direction());
        const ConvexShape b = *ConvexShape(*ConvexPolytope::from_points(corners)).with_margin(margin);
        const Pose pose_a = random.pose(random.vector(0, 3));
        const Pose pose_b = random.pose(Vec3::Zero());
        SCOPED_TRACE("kind " + std::to_string(kind) + ", try " + std::to_string(k));
        const PenetrationDepth r = penetration_depth({&a, pose_a}, {&b, pose_b}, scratch);
        ASSERT_EQ(r.contact, ContactClass::overlapping);
        EXPECT_LT(std::abs(r.normal.norm() - 1), 1e-14) << margin;
        EXPECT_LE((r.translation / margin).norm(), r.upper / margin * (1 + 1e-14)) << margin;
        EXPECT_LE(r.lower, r.upper);
        EXPECT_GE(r.lower, margin * (1 - 1e-14));
      }
    }
  }
}

TEST(Smooth, BracketsAgreeWithTheSweep) {
  Scratch scratch;
  scenes::Random random(23);
  int overlapping = 0;
  int separated = 0;
  for (int kind_a = 0; kind_a < 8; ++kind_a) {
    for (int kind_b = 0; kind_b <= kind_a; ++kind_b) {
      for (int k = 0; k < 4; ++k) {
        const ConvexShape a = random_shape(kind_a, random);
        const ConvexShape b = random_shape(kind_b, random);
        const Pose pose_a = random.pose(random.direction());
        const double reach = k == 0 ? 0.01 : k == 3 ? 3.2 : 1.2;
        const Pose pose_b = random.pose(pose_a.translation() + reach * random.direction());
        SCOPED_TRACE("kinds " + std::to_string(kind_a) + ", " + std::to_string(kind_b) + ", try " + std::to_string(k));
        const oracle::Sweep sweep = oracle::sweep_directions({&a, pose_a}, {&b, pose_b}, 400, 4);
        const auto least = static_cast<double>(sweep.least);
        for (const double delta : {1e-2, 1e-6}) {
          const PenetrationDepth d = penetration_depth({&a, pose_a}, {&b, pose_b}, scratch, {.delta = delta});
          EXPECT_NEAR(d.normal.norm(), 1, 1e-15);
          const long double own = oracle::difference_support({&a, pose_a}, {&b, pose_b}, d.normal);
          if (std::abs(least) < 1e-9) continue;
          char numbers[400];
          std::snprintf(numbers, sizeof numbers,
                        "delta %g sweep %.17g own %.17g lower %.17g upper %.17g distance %.17g %.17g", delta, least,
                        static_cast<double>(own), d.lower, d.upper, d.distance_lower, d.distance_upper);
          SCOPED_TRACE(numbers);
          if (least > 0) {
            ++overlapping;
            ASSERT_EQ(d.contact, ContactClass::overlapping);
            EXPECT_LE(d.lower, least * (1 + 1e-12) + 1e-13);
            EXPECT_LE(d.upper, d.lower * (1 + delta) * (1 + 1e-12) + 1e-11);
            // The answer's own direction proves the upper bound; the sweep need not have found as good a one.
            EXPECT_LE(static_cast<double>(own), d.upper * (1 + 1e-12) + 1e-13);
            EXPECT_GE(static_cast<double>(own), d.lower * (1 - 1e-12) - 1e-13);
            EXPECT_LE(d.translation.norm(), d.upper * (1 + 1e-15));
          } else {
            ++separated;
            ASSERT_EQ(d.contact, ContactClass::separated);
            EXPECT_GE(d.distance_upper, -least * (1 - 1e-12) - 1e-13);
            EXPECT_GE(static_cast<double>(-own), d.distance_lower * (1 - 1e-9) - 1e-12);
            // Asked of smooth bodies; swept polytopes stopped early answer for their cores.
            if (a.polytope() == nullptr || b.polytope() == nullptr) {
              EXPECT_LE(d.distance_upper - d.distance_lower, delta * d.distance_upper + 1e-11);
            }
          }
        }
      }
    }
  }
  std::printf("%d overlapping, %d separated\n", overlapping, separated);
  EXPECT_GT(overlapping, 60);
  EXPECT_GT(separated, 20);
}

/// Pairs moved about contact by their own answer: slivers of nearly equal supports, from both sides.
/// A last triangle that is nearly a segment has weights that mean nothing.
TEST(Smooth, WitnessesLieOnTheirBodies) {
  Scratch scratch;
  scenes::Random random(77);
  const ConvexShape point(*ConvexPolytope::from_points(std::vector<Vec3>{Vec3::Zero()}));
  const auto off_surface = [&](const PosedShape& body, const Vec3& at) {
    DepthSettings fine;
    fine.delta = 1e-3;
    const PenetrationDepth found =
        penetration_depth({&point, *Pose::from_matrix(Mat3::Identity(), at)}, body, scratch, fine);
    return found.contact == ContactClass::overlapping ? found.lower : found.distance_lower;
  };
  int judged = 0;
  double worst = 0;
  for (int i = 0; i < 1500; ++i) {
    const ConvexShape a = random_shape(kSearched[i % 4], random), b = random_shape(random.integer(0, 7), random);
    const PosedShape posed_a{&a, random.pose(Vec3::Zero())};
    const PosedShape posed_b{&b, random.pose(random.vector(0.1, 1.2))};
    DepthSettings settings;
    settings.delta = 1e-6;
    const PenetrationDepth answer = penetration_depth(posed_a, posed_b, scratch, settings);
    if (answer.contact != ContactClass::overlapping) continue;
    ++judged;
    worst = std::max({worst, off_surface(posed_a, answer.witness_a), off_surface(posed_b, answer.witness_b)});
  }
  EXPECT_GT(judged, 900);
  EXPECT_LT(worst, 1e-4);
}

// A search for a contact that met its budget on a face without area once took its direction, none, for a way out.
TEST(Smooth, ContactBracketsHoldTheDepth) {
  Scratch scratch;
  scenes::Random random(77);
  int judged = 0;
  for (int i = 0; i < 6000; ++i) {
    const ConvexShape a = random_shape(kSearched[i % 4], random), b = random_shape(random.integer(0, 7), random);
    const PosedShape posed_a{&a, random.pose(Vec3::Zero())};
    const PosedShape posed_b{&b, random.pose(random.vector(0.1, 1.2))};
    DepthSettings settings;
    settings.bracket = Bracket::contact;
    settings.contact_tolerance = 4e-9;
    const PenetrationDepth contact = penetration_depth(posed_a, posed_b, scratch, settings);
    if (contact.contact != ContactClass::overlapping) continue;
    ++judged;
    const PenetrationDepth exact = penetration_depth(posed_a, posed_b, scratch);
    ASSERT_NEAR(contact.normal.norm(), 1, 1e-12) << i;
    ASSERT_LE(contact.lower, exact.upper + 1e-8) << i;
    ASSERT_GE(contact.upper, exact.lower - 1e-8) << i;
  }
  EXPECT_GT(judged, 5000);
}

TEST(Smooth, NearContactIsAnsweredInBoundedWork) {
  Scratch scratch;
  int asked = 0;
  std::int64_t most = 0;
  for (int kind_a = 0; kind_a < 8; ++kind_a) {
    for (int kind_b = 0; kind_b <= kind_a; ++kind_b) {
      for (int k = 0; k < 15; ++k) {
        const std::uint64_t seed = 1000 * kind_a + 100 * kind_b + k + 7;
        scenes::Random random(seed);
        const ConvexShape a = random_shape(kind_a, random);
        const ConvexShape b = random_shape(kind_b, random);
        if (a.polytope() != nullptr && b.polytope() != nullptr) continue;
        const Pose pose_a = random.pose(random.direction());
        const bool parallel = k % 3 == 2;
        const Pose pose_b =
            parallel ? *Pose::from_quaternion(pose_a.quaternion_wxyz(),
                                              pose_a.translation() + Vec3(kind_a == kind_b ? 0.1 : 0.0, 0, 0.3))
                     : random.pose(pose_a.translation() + 0.6 * random.direction());
        const PenetrationDepth first = penetration_depth({&a, pose_a}, {&b, pose_b}, scratch);
        if (first.contact != ContactClass::overlapping) continue;
        for (int step = 0; step < 24; ++step) {
          const double offset = step < 2 ? 0.0 : (step % 2 == 0 ? 1 : -1) * std::pow(10.0, -(2 + step / 2));
          const double base = step == 0 ? first.lower : first.depth;
          const Vec3 move = (base + offset) * first.normal;
          const Pose moved = *Pose::from_quaternion(pose_a.quaternion_wxyz(), pose_a.translation() + move);
          const PenetrationDepth d = penetration_depth({&a, moved}, {&b, pose_b}, scratch);
          SCOPED_TRACE("kinds " + std::to_string(kind_a) + ", " + std::to_string(kind_b) + ", try " +
                       std::to_string(k) + ", step " + std::to_string(step));
          ++asked;
          most = std::max(most, d.statistics.support_calls);
          // 212 at most, and 303 of 85,000. Where rounding turned a face over unnoticed, up to 16,431.
          EXPECT_LT(d.statistics.support_calls, 400);
          // The depth is 1-Lipschitz, and h(normal) falls by what A moved along it. L < 8 throughout.
          const double gone = move.dot(first.normal);
          const double rounding = 4e-13;
          const double signed_least = first.lower - move.norm() - rounding;
          const double signed_most = first.upper - gone + rounding;
          switch (d.contact) {
            case ContactClass::overlapping:
              EXPECT_LE(d.upper, d.lower * (1 + 1e-6) + 8e-12);
              EXPECT_LE(d.lower, signed_most);
              EXPECT_GE(d.upper, signed_least);
              break;
            case ContactClass::separated:
              EXPECT_LE(d.distance_upper, d.distance_lower * (1 + 1e-6) + 8e-12);
              EXPECT_GE(d.distance_upper, -signed_most);
              EXPECT_LE(d.distance_lower, -signed_least);
              break;
            case ContactClass::touching:
              EXPECT_GE(signed_most, -8e-12);
              EXPECT_LE(signed_least, 8e-12);
              break;
          }
        }
      }
    }
  }
  std::printf("%d asked, %lld supports at most\n", asked, static_cast<long long>(most));
  EXPECT_GT(asked, 5000);
}

TEST(Approximate, PolytopesStoppedEarlyKeepTheirBracket) {
  Scratch scratch;
  for (const scenes::PairFamily family :
       {scenes::PairFamily::sphere, scenes::PairFamily::box, scenes::PairFamily::roofs}) {
    for (const double delta : {1.0, 0.1, 1e-3}) {
      for (std::uint64_t seed = 1; seed <= 6; ++seed) {
        const oracle::JudgedPair pair = oracle::JudgedPair::of_family(family, 40, scenes::DepthClass::deep, seed);
        const PenetrationDepth d = penetration_depth(pair.a(), pair.b(), scratch, {.delta = delta});
        const oracle::Verdict& v = pair.verdict();
        ASSERT_EQ(d.contact, v.contact);
        if (v.contact != ContactClass::overlapping) continue;
        EXPECT_LE(v.depth.compare(d.lower), 0) << pair.name();
        EXPECT_GE(v.depth.compare(d.upper), 0) << pair.name();
        EXPECT_LE(d.upper, d.lower * (1 + delta) + 4e-14) << pair.name();
      }
    }
  }
}

}  // namespace
}  // namespace pd

/// @file
/// Bodies at rest on floors, frame by frame, as an engine asks: certified answers from the memory of the pair, in
/// doubles, however wide the floor is.
///
/// What a frame costs is counted, not timed: warm answers, and decisions left to exact numbers.

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>

#include "pd/depth/penetration_depth.hpp"
#include "pd/depth/scratch.hpp"
#include "pd/depth/warm_certificate.hpp"
#include "scenes/shape_families.hpp"

namespace pd {
namespace {

struct Counts {
  int frames = 0;
  int warm = 0;
  std::int64_t exact_signs = 0;
  double nanoseconds = 0;
};

ConvexShape rounded_box(const Vec3& half, double margin) {
  return *ConvexShape(*ConvexPolytope::box(half)).with_margin(margin);
}
ConvexShape rounded_points(const std::vector<Vec3>& points, double margin) {
  return *ConvexShape(*ConvexPolytope::from_points(points)).with_margin(margin);
}

/// A body's centre `height` above the floor's top, give or take what a step of an engine leaves; turned about the
/// upright axis, and tipped by rounding.
Counts rest(const ConvexShape& body, const ConvexShape& floor, double floor_top, double height, int frames) {
  Counts counts;
  Scratch scratch;
  WarmCertificate memory;
  scenes::Random random(7);
  DepthSettings settings;
  settings.bracket = Bracket::certified;
  const Pose below = *Pose::from_matrix(Mat3::Identity(), {0, -floor_top, 0});
  for (int i = 0; i < frames; ++i) {
    const auto [sine, cosine] = scenes::turn(0.07 + 1e-6 * random.uniform());
    const double x = 1e-6 * random.uniform(-1, 1), z = 1e-6 * random.uniform(-1, 1);
    const double norm = std::sqrt(1 + x * x + z * z);
    const Pose pose =
        *Pose::from_quaternion({cosine / norm, x / norm, sine / norm, z / norm},
                               {0.123 + 1e-7 * random.uniform(), height + 1e-5 * random.uniform(-1, 1), 0.2});
    const auto start = std::chrono::steady_clock::now();
    const PenetrationDepth answer = penetration_depth({&body, pose}, {&floor, below}, scratch, settings, &memory);
    counts.nanoseconds += 1e9 * std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    ++counts.frames;
    // Spheres and capsules over a face need no memory.
    const bool closed_form = answer.statistics.support_calls == 1 && answer.statistics.facets_visited == 1;
    counts.warm += answer.warm || (body.polytope() && body.polytope()->num_vertices() <= 2 && closed_form);
    counts.exact_signs += answer.statistics.exact_signs;
    // Doubles for polytopes; curved bodies stop at 1e-12 of the size.
    const double allowed = (body.polytope() ? 2e-14 : 1e-12) * 2 * floor.polytope()->radius();
    if (answer.contact == ContactClass::overlapping) {
      EXPECT_LE(answer.upper - answer.lower, allowed);
      EXPECT_LE(answer.depth, 4e-5 + allowed);
    } else {
      EXPECT_LE(answer.distance_upper - answer.distance_lower, allowed);
      EXPECT_LE(answer.distance, 4e-5 + allowed);
    }
    EXPECT_GE(answer.normal.y(), 1 - 1e-9);
  }
  std::printf("%3d of %d warm, %lld exact signs, %.0f ns\n", counts.warm, counts.frames,
              static_cast<long long>(counts.exact_signs), counts.nanoseconds / counts.frames);
  return counts;
}

constexpr int kFrames = 200;

void expect_cheap(const Counts& counts) {
  EXPECT_GE(counts.warm, 0.95 * counts.frames);
  EXPECT_LE(counts.exact_signs, 0.05 * counts.frames);
}

class OnAFloor : public testing::TestWithParam<double> {
 protected:
  [[nodiscard]] ConvexShape floor() const { return rounded_box({GetParam() - 0.04, 0.96, GetParam() - 0.04}, 0.04); }
};

TEST_P(OnAFloor, Box) { expect_cheap(rest(rounded_box({0.46, 0.46, 0.46}, 0.04), floor(), 1, 0.5, kFrames)); }
TEST_P(OnAFloor, Sphere) { expect_cheap(rest(rounded_points({Vec3::Zero()}, 0.5), floor(), 1, 0.5, kFrames)); }
TEST_P(OnAFloor, Capsule) {
  expect_cheap(rest(rounded_points({Vec3(-0.5, 0, 0), Vec3(0.5, 0, 0)}, 0.3), floor(), 1, 0.3, kFrames));
}
TEST_P(OnAFloor, Cylinder) {
  expect_cheap(rest(*ConvexShape::cylinder(0.46, 0.46, 1)->with_margin(0.04), floor(), 1, 0.5, kFrames));
}
INSTANTIATE_TEST_SUITE_P(Rest, OnAFloor, testing::Values(1.0, 20.0, 200.0, 1e4));

/// A card on a card, both as Bullet makes its default boxes: a margin of .04, or a tenth of the least half extent.
TEST(AtRest, CardsOnCards) {
  for (const double margin : {0.001, 0.0006}) {
    const ConvexShape card = rounded_box(Vec3(0.006, 0.44, 0.32) - Vec3::Constant(margin), margin);
    const ConvexShape lying = rounded_box(Vec3(0.44, 0.006, 0.32) - Vec3::Constant(margin), margin);
    expect_cheap(rest(card, lying, 0.006, 0.44, kFrames));
    expect_cheap(rest(lying, lying, 0.006, 0.006, kFrames));
  }
}

}  // namespace
}  // namespace pd

/// @file
/// Bodies apart from frame to frame: the last simplex or plane answers with one support nearly always, also where
/// bodies are slender, or stand on facets of many vertices; and says what a cold query says.

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "pd/depth/penetration_depth.hpp"
#include "pd/depth/scratch.hpp"
#include "pd/depth/warm_certificate.hpp"
#include "scenes/shape_families.hpp"

namespace pd {
namespace {

using scenes::Random;

constexpr DepthSettings kCertified{.bracket = Bracket::certified};

scenes::Points splinter(int n, Random& random) {
  scenes::Points points = scenes::sphere_hull(n, random);
  for (Vec3& p : points) p = p.cwiseProduct(Vec3(1, 0.03, 0.05));
  return points;
}
/// Its caps have n / 2 vertices.
scenes::Points coin(int n) {
  scenes::Points points;
  for (int i = 0; i < n / 2; ++i) {
    const auto [sine, cosine] = scenes::turn(2 * 3.14159265358979 * i / (n / 2));
    points.emplace_back(cosine, sine, -0.5);
    points.emplace_back(cosine, sine, 0.5);
  }
  return points;
}

struct Frames {
  int asked = 0, warm = 0, single = 0;
};

/// Six frames each of forty pairs, at a gap that is a share of the first body's thinnest extent.
Frames ask(const std::function<scenes::Points(Random&)>& body, double gap, bool beyond) {
  Random random(7);
  Scratch scratch;
  Frames frames;
  for (int pair = 0; pair < 40; ++pair) {
    const ConvexShape a(*ConvexPolytope::from_points(body(random))), b(*ConvexPolytope::from_points(body(random)));
    const Vec3 way = random.direction();
    const Pose start_a = random.pose(Vec3::Zero());
    const Pose start_b = random.pose(Vec3::Zero());
    WarmCertificate memory;
    for (int frame = 0; frame < 6; ++frame) {
      const auto [sine, cosine] = scenes::turn(0.005 * frame);
      const Mat3 turn{{cosine, -sine, 0}, {sine, cosine, 0}, {0, 0, 1}};
      const Pose pose_a = Pose::from_trusted_matrix(turn * start_a.rotation(), Vec3::Zero());
      double near = 0, far = 5;
      for (int step = 0; step < 40; ++step) {
        const double middle = (near + far) / 2;
        const Pose pose_b = Pose::from_trusted_matrix(start_b.rotation(), middle * way);
        (penetration_depth({&a, pose_a}, {&b, pose_b}, scratch, kCertified).distance < gap ? near : far) = middle;
      }
      const PosedShape at_a{&a, pose_a}, at_b{&b, Pose::from_trusted_matrix(start_b.rotation(), far * way)};
      DepthSettings settings = kCertified;
      if (beyond) settings.beyond = gap / 2;
      const PenetrationDepth answer = penetration_depth(at_a, at_b, scratch, settings, &memory);
      const PenetrationDepth cold = penetration_depth(at_a, at_b, scratch, kCertified);
      EXPECT_EQ(answer.contact, ContactClass::separated);
      EXPECT_LE(answer.distance_lower, cold.distance_upper);
      EXPECT_GE(answer.distance_upper, cold.distance_lower);
      EXPECT_GT(answer.distance_lower, beyond ? gap / 2 : 0);
      if (frame == 0) continue;
      ++frames.asked;
      frames.warm += answer.warm ? 1 : 0;
      frames.single += answer.statistics.support_calls == 1 ? 1 : 0;
    }
  }
  return frames;
}

TEST(ApartFrames, SlenderBodiesAreConfirmedByOneSupport) {
  for (const int n : {8, 32, 128}) {
    for (const double gap : {0.0005, 0.005, 0.05}) {
      SCOPED_TRACE(n);
      SCOPED_TRACE(gap);
      const Frames frames = ask([n](Random& random) { return splinter(n, random); }, gap, false);
      EXPECT_GE(frames.warm, frames.asked * 90 / 100);
      EXPECT_GE(frames.single, frames.asked * 55 / 100);
    }
  }
}

TEST(ApartFrames, FacetsOfManyVerticesAreConfirmedByOneSupport) {
  const Frames frames = ask([](Random&) { return coin(128); }, 0.1, false);
  EXPECT_GE(frames.warm, frames.asked * 95 / 100);
  EXPECT_GE(frames.single, frames.asked * 50 / 100);
}

TEST(ApartFrames, BeyondGoesOnWhereTheLastPlaneNoLongerTells) {
  for (const int n : {8, 32}) {
    SCOPED_TRACE(n);
    EXPECT_GE(ask([n](Random& random) { return splinter(n, random); }, 0.0005, true).asked, 100);
  }
  const Frames boxes = ask(
      [](Random& random) {
        const Vec3 half = random.point(0.3, 1);
        scenes::Points points;
        for (int i = 0; i < 8; ++i) {
          points.emplace_back(i & 1 ? half.x() : -half.x(), i & 2 ? half.y() : -half.y(), i & 4 ? half.z() : -half.z());
        }
        return points;
      },
      0.01, true);
  // Where one support does not tell, fifteen axes mostly do, without a second one.
  EXPECT_GE(boxes.single, boxes.asked * 80 / 100);
}

}  // namespace
}  // namespace pd

/// @file
/// Bodies at rest on floors of any width, frame by frame, as an engine asks for them: what `fixed_cases` counts the
/// instructions of and `resting_cost` times.
#pragma once

#include <cmath>
#include <optional>
#include <string_view>
#include <vector>

#include "pd/depth/penetration_depth.hpp"
#include "scenes/shape_families.hpp"

namespace pd::bench {

enum class RestingBody { box, hull_32, sphere, capsule, cylinder, cone };
enum class RestingGround { floor, triangle, sphere, capsule };

constexpr std::string_view kRestingBodies[] = {"box", "hull_32", "sphere", "capsule", "cylinder", "cone"};

/// As Bullet's float build makes them: a margin of .04 inside boxes and cylinders, outside hulls and cones. The body
/// stands on y = 0; each frame moves it by what a step of an engine leaves (1e-5 up or down, a tip of 1e-6).
class RestingCase {
 public:
  /// @param width  half the width of the floor, of the triangle, or of the capsule's core along x and z.
  RestingCase(RestingBody body, RestingGround ground, double width, int frames)
      : body_(body_of(body)), ground_(ground_of(ground, width)) {
    tolerance_ = 0x1p-30 * 2;
    below_ = *Pose::from_matrix(Mat3::Identity(), place_of(ground));
    const double height = height_of(body) + (ground == RestingGround::triangle ? kTriangleMargin : 0);
    scenes::Random random(7);
    for (int i = 0; i < frames; ++i) {
      const auto [sine, cosine] = scenes::turn(0.07 + 1e-6 * random.uniform());
      const double x = 1e-6 * random.uniform(-1, 1), z = 1e-6 * random.uniform(-1, 1);
      const double norm = std::sqrt(1 + x * x + z * z);
      poses_.push_back(
          *Pose::from_quaternion({cosine / norm, x / norm, sine / norm, z / norm},
                                 {0.123 + 1e-7 * random.uniform(), height + 1e-5 * random.uniform(-1, 1), 0.2}));
    }
  }

  [[nodiscard]] PosedShape body(int frame) const { return {&body_, poses_[static_cast<std::size_t>(frame)]}; }
  [[nodiscard]] PosedShape ground() const { return {&ground_, below_}; }
  [[nodiscard]] int frames() const { return static_cast<int>(poses_.size()); }
  /// What poses in single precision leave uncertain, as the glue takes it (`contact_tolerance`).
  [[nodiscard]] double tolerance() const { return tolerance_; }

 private:
  static constexpr double kMargin = 0.04;
  static constexpr double kTriangleMargin = 0.04;
  static constexpr double kRoundMargin = 0.5;

  static ConvexShape body_of(RestingBody body) {
    switch (body) {
      case RestingBody::box:
        return *ConvexShape(*ConvexPolytope::box(Vec3::Constant(0.5 - kMargin))).with_margin(kMargin);
      case RestingBody::hull_32: {
        // A prism of sixteen sides: it stands on a facet of sixteen corners.
        std::vector<Vec3> points;
        for (int i = 0; i < 16; ++i) {
          const auto [sine, cosine] = scenes::turn(i / 16.0);
          for (const double y : {-0.5, 0.5}) points.emplace_back(0.5 * cosine, y, 0.5 * sine);
        }
        return *ConvexShape(*ConvexPolytope::from_points(points)).with_margin(kMargin);
      }
      case RestingBody::sphere:
        return *ConvexShape(*ConvexPolytope::from_points(std::vector<Vec3>{Vec3::Zero()})).with_margin(0.5);
      case RestingBody::capsule:
        return *ConvexShape(*ConvexPolytope::from_points(std::vector<Vec3>{{-0.5, 0, 0}, {0.5, 0, 0}}))
                    .with_margin(0.3);
      case RestingBody::cylinder:
        return *ConvexShape::cylinder(0.5 - kMargin, 0.5 - kMargin, 1)->with_margin(kMargin);
      case RestingBody::cone:
        return *ConvexShape::cone(0.5, 0.5, 1)->with_margin(kMargin);
    }
    return ConvexShape(*ConvexPolytope::box(Vec3::Constant(1)));
  }
  static double height_of(RestingBody body) {
    switch (body) {
      case RestingBody::box:
      case RestingBody::sphere:
      case RestingBody::cylinder:
        return 0.5;
      case RestingBody::capsule:
        return 0.3;
      case RestingBody::hull_32:
      case RestingBody::cone:
        return 0.5 + kMargin;
    }
    return 0;
  }
  /// Of the ground's origin; round ones stand under the body.
  static Vec3 place_of(RestingGround ground) {
    switch (ground) {
      case RestingGround::floor:
        return {0, -1, 0};
      case RestingGround::triangle:
        return Vec3::Zero();
      case RestingGround::sphere:
      case RestingGround::capsule:
        break;
    }
    return {0.123, -kRoundMargin, 0.2};
  }
  static ConvexShape ground_of(RestingGround ground, double width) {
    if (ground == RestingGround::sphere || ground == RestingGround::capsule) {
      std::vector<Vec3> core{Vec3::Zero()};
      if (ground == RestingGround::capsule) core = {{-width, 0, -width}, {width, 0, width}};
      return *ConvexShape(*ConvexPolytope::from_points(core)).with_margin(kRoundMargin);
    }
    if (ground == RestingGround::floor) {
      return *ConvexShape(*ConvexPolytope::box({width - kMargin, 1 - kMargin, width - kMargin})).with_margin(kMargin);
    }
    const std::vector<Vec3> corners{{-width, 0, -width}, {width, 0, -width}, {0, 0, 1.5 * width}};
    return *ConvexShape(*ConvexPolytope::from_points(corners)).with_margin(kTriangleMargin);
  }

  ConvexShape body_;
  ConvexShape ground_;
  double tolerance_ = 0;
  Pose below_;
  std::vector<Pose> poses_;
};

/// Two bricks, one flush on the other and half its length aside, turned against it by what single precision leaves.
struct FlushBricks {
  /// @param gap  between them, below 0 where they overlap.
  explicit FlushBricks(double gap) {
    const Mat3 tipped{{1, 0x1p-22, 0}, {-0x1p-22, 1, -0x1p-21}, {0, 0x1p-21, 1}};
    upper_pose = Pose::from_trusted_matrix(tipped, {0.5, 0.5 + gap, 0});
    lower_pose = Pose::from_trusted_matrix(Mat3::Identity(), {0, 0, 0});
  }
  ConvexShape brick{*ConvexPolytope::box({0.5, 0.25, 0.5})};
  Pose upper_pose, lower_pose;
  [[nodiscard]] PosedShape upper() const { return {&brick, upper_pose}; }
  [[nodiscard]] PosedShape lower() const { return {&brick, lower_pose}; }
};

}  // namespace pd::bench

#include "pd/render/camera.hpp"

#include <gtest/gtest.h>

namespace pd::render {
namespace {

TEST(Camera, TargetProjectsToTheMiddle) {
  Camera camera;
  camera.eye = {4, -3, 2};
  camera.target = {1, 1, 1};
  const PicturePoint at = project(camera, {640, 480}, camera.target);
  EXPECT_NEAR(at.x, 320, 1e-9);
  EXPECT_NEAR(at.y, 240, 1e-9);
  EXPECT_NEAR(at.distance, (camera.eye - camera.target).norm(), 1e-12);
}

TEST(Camera, VerticalFieldSpansThePicture) {
  Camera camera;
  camera.eye = {0, -10, 0};
  camera.target = {0, 0, 0};
  const double half = 10 * std::tan(35.0 / 2 * 3.14159265358979323846 / 180);
  EXPECT_NEAR(project(camera, {800, 600}, {0, 0, half}).y, 0, 1e-9);
  EXPECT_NEAR(project(camera, {800, 600}, {0, 0, -half}).y, 600, 1e-9);
  EXPECT_NEAR(pixel_length(camera, {800, 600}, 10), 2 * half / 600, 1e-12);
}

TEST(Camera, BehindTheEyeIsNotInFront) {
  Camera camera;
  camera.eye = {0, -10, 0};
  EXPECT_LT(project(camera, {800, 600}, {0, -20, 0}).distance, 0);
}

// Every corner inside the free window, and at least one pair of opposite sides of the window reached.
TEST(Camera, FramedBoxIsSeenWholeAndFills) {
  const Size size{1280, 720};
  const Insets insets;
  for (const Vec3& up : {Vec3(0, 0, 1), Vec3(0, 1, 0)}) {
    for (const Vec3& half : {Vec3(1, 1, 1), Vec3(0.3, 0.2, 6), Vec3(20, 1, 0.5), Vec3(1e-4, 2e-4, 1e-4)}) {
      for (double azimuth = 0; azimuth < 360; azimuth += 45) {
        Box box;
        box.include(Vec3(5, -7, 3) - half);
        box.include(Vec3(5, -7, 3) + half);
        const Camera camera = frame_box(box, size, {azimuth, 20}, insets, up);
        double left = 1e9;
        double right = -1e9;
        double top = 1e9;
        double bottom = -1e9;
        for (int corner = 0; corner < 8; ++corner) {
          const Vec3 point((corner & 1) != 0 ? box.lower.x() : box.upper.x(),
                           (corner & 2) != 0 ? box.lower.y() : box.upper.y(),
                           (corner & 4) != 0 ? box.lower.z() : box.upper.z());
          const PicturePoint at = project(camera, size, point);
          ASSERT_GT(at.distance, 0);
          left = std::min(left, at.x);
          right = std::max(right, at.x);
          top = std::min(top, at.y);
          bottom = std::max(bottom, at.y);
        }
        EXPECT_GE(left, insets.left * size.width - 0.01);
        EXPECT_LE(right, (1 - insets.right) * size.width + 0.01);
        EXPECT_GE(top, insets.top * size.height - 0.01);
        EXPECT_LE(bottom, (1 - insets.bottom) * size.height + 0.01);
        const bool fills_across = right - left > (1 - insets.left - insets.right) * size.width - 0.1;
        const bool fills_down = bottom - top > (1 - insets.top - insets.bottom) * size.height - 0.1;
        EXPECT_TRUE(fills_across || fills_down) << "azimuth " << azimuth;
      }
    }
  }
}

}  // namespace
}  // namespace pd::render

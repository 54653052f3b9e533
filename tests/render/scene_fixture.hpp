/// @file
/// The small scene that the frame tests draw, and what they look for in it.
#pragma once

#include "pd/render/renderer.hpp"

namespace pd::render::test {

inline Pose placed(const Vec3& at) { return Pose::from_trusted_matrix(Mat3::Identity(), at); }

/// Three boxes, two of them overlapping by 0.1, and the arrow that parts them, in a colour that nothing else has.
inline Scene three_boxes() {
  const MeshRef box = box_mesh({0.5, 0.5, 0.5});
  Scene scene;
  scene.bodies.push_back({.mesh = box, .pose = placed({0, 0, 0.5}), .colour = palette::kBodyA});
  scene.bodies.push_back({.mesh = box, .pose = placed({0.2, 0.1, 1.4}), .colour = palette::kBodyB});
  scene.bodies.push_back({.mesh = box, .pose = placed({-1.5, 0.2, 0.5}), .colour = palette::categorical(2)});
  return scene;
}

inline Arrow long_arrow() { return {.from = {0.2, -0.6, 0.6}, .to = {0.2, -0.6, 1.6}}; }

/// Vermilion, whatever the light.
inline bool is_arrow_colour(const std::uint8_t* pixel) {
  return pixel[0] > 120 && pixel[0] > 2.2 * pixel[1] && pixel[0] > 2.5 * pixel[2];
}

}  // namespace pd::render::test

/// @file
/// What the passes share: their programs' places, the limits between opaque and translucent, colours as vectors.
#pragma once

#include <Eigen/Core>
#include <algorithm>

#include "pipeline/frame_setup.hpp"

namespace pd::render::detail {

/// Places in `programs_`.
enum ProgramIndex : std::size_t {
  kShadowProgram,
  kGhostShadowProgram,
  kSurfaceProgram,
  kGroundSurfaceProgram,
  kOcclusionProgram,
  kSmoothProgram,
  kBackdropProgram,
  kGroundProgram,
  kBodyProgram,
  kTranslucentProgram,
  kEdgeProgram,
  kOverlayProgram,
};

/// Below this a body is a ghost: it casts a lighter shadow and hides nothing.
inline constexpr float kOpaque = 0.995f;

/// A translucent body's shadow, as a share of its opacity.
inline constexpr float kGhostShadow = 0.75f;

/// Half the angle of the key light, as a tangent: soft enough to read as a studio lamp.
inline constexpr float kLightTangent = 0.13f;

/// Ink is pulled this share of the way to the eye, so that it wins over its own surface and over nothing else.
inline constexpr float kInkPull = 0.0012f;

inline Eigen::Vector3f to_vector(Colour colour) { return {colour.r, colour.g, colour.b}; }

inline Eigen::Vector4f to_vector(Colour colour, float opacity) { return {colour.r, colour.g, colour.b, opacity}; }

/// The same hue, more of it.
inline Colour saturated(Colour colour) {
  const float grey = 0.3f * colour.r + 0.59f * colour.g + 0.11f * colour.b;
  const auto push = [grey](float value) { return std::clamp(grey + 1.45f * (value - grey), 0.0f, 1.0f); };
  return {push(colour.r), push(colour.g), push(colour.b)};
}

/// 1 / (the scale that a model matrix applies), which turns its normals back to unit length.
inline float normal_scale(const Eigen::Matrix4f& model) {
  const float length = model.block<3, 1>(0, 0).norm();
  return length > 0 ? 1 / length : 1;
}

inline Eigen::Matrix4f body_model(const FrameSetup& frame, const Body& body) {
  return model_matrix(frame, body.pose, body.mesh->unit);
}

}  // namespace pd::render::detail

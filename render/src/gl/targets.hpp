/// @file
/// What a frame is drawn into, for one picture size.
#pragma once

#include "gl/gl_functions.hpp"
#include "pd/render/image.hpp"

namespace pd::render::detail {

/// A framebuffer with a readable colour or depth texture.
struct TextureTarget {
  GLuint framebuffer = 0;
  GLuint texture = 0;
  GLuint depth = 0;  ///< renderbuffer, or 0
  Size size{0, 0};
};

/// Shadow map, half-resolution surface and occlusion, the multisampled frame and its resolved copy.
class Targets {
 public:
  static constexpr int kShadowSide = 1280;

  /// @return ErrorCode::unsupported where the driver lacks a format or 4 samples.
  static Expected<Targets> create(const GlFunctions& gl, Size size);
  void destroy(const GlFunctions& gl);

  [[nodiscard]] Size size() const { return size_; }

  TextureTarget shadow;         ///< depth from the light
  TextureTarget surface;        ///< half size: view-space normal, distance along the line of sight (0: nothing)
  TextureTarget raw_occlusion;  ///< half size: ambient visibility, key visibility, distance; noisy
  TextureTarget occlusion;      ///< the same, smoothed
  TextureTarget resolved;       ///< display values
  GLuint frame = 0;             ///< multisampled

 private:
  Size size_{0, 0};
  GLuint frame_colour_ = 0;
  GLuint frame_depth_ = 0;
};

}  // namespace pd::render::detail

/// @file
/// From a scene to a picture.
#pragma once

#include <memory>

#include "pd/numeric/expected.hpp"
#include "pd/render/camera.hpp"
#include "pd/render/image.hpp"
#include "pd/render/offscreen_context.hpp"
#include "pd/render/scene.hpp"

namespace pd::render {

/// Owns a context and what it draws with (targets of the last size, meshes that are still alive). One thread at a time;
/// several renderers may work on several threads.
class Renderer {
 public:
  /// @return ErrorCode::unsupported: no such context here, or it lacks OpenGL 3.3 (the reason says what and where to
  /// get it).
  static Expected<Renderer> create(ContextKind kind = ContextKind::osmesa);

  ~Renderer();
  Renderer(Renderer&&) noexcept;
  Renderer& operator=(Renderer&&) noexcept;

  /// One opaque frame with shadows, ambient occlusion, ink, overlays and their labels. Requires sides in [16, 8192].
  /// @return ErrorCode::unsupported where the device refuses (no memory for a new size, current on another thread).
  /// The same calls give the same bytes on the same device; devices differ by their rasteriser's tolerance.
  Expected<Image> draw(const Scene& scene, const Camera& camera, Size size);

 private:
  struct State;
  explicit Renderer(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace pd::render

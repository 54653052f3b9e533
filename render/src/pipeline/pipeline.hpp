/// @file
/// The passes of a frame, in order: shadow map, half-size surface, occlusion and its smoothing, the multisampled
/// picture (bodies, ground, backdrop, ink, translucent surfaces, overlays), resolve.
#pragma once

#include <optional>

#include "gl/program.hpp"
#include "gl/targets.hpp"
#include "pipeline/device_meshes.hpp"
#include "pipeline/frame_setup.hpp"

namespace pd::render::detail {

class Pipeline {
 public:
  /// Requires the context to be current, here and in `draw`; `gl` outlives the pipeline.
  /// @return ErrorCode::unsupported with the driver's reason.
  static Expected<Pipeline> create(const GlFunctions& gl);

  /// Draws all but the words. @return the picture, or ErrorCode::unsupported where the size's targets are refused.
  Expected<Image> draw(const Scene& scene, const Camera& camera, Size size);

 private:
  /// What explains goes over what stands: later layers are never tinted by earlier ones.
  enum class Layer { ghost, solid, ball, mark };

  /// One side of one translucent surface, drawn far to near within its layer.
  struct Sheet {
    Layer layer;
    double distance;
    bool back;
    const DeviceMesh* mesh;
    Eigen::Matrix4f model;
    float normal_scale;
    Eigen::Vector4f colour;
    float hidden_opacity;
    bool edges;
  };

  Pipeline(const GlFunctions& gl, std::vector<Program> programs);

  void draw_shadow_map(const Scene& scene, const FrameSetup& frame);
  void draw_surface(const Scene& scene, const FrameSetup& frame);
  /// @param grainy  translucent casters leave a coarse pattern to smooth away.
  void draw_occlusion(const FrameSetup& frame, bool grainy);
  void draw_bodies(const Scene& scene, const FrameSetup& frame);
  void draw_ground_and_backdrop(const Scene& scene, const FrameSetup& frame);
  void draw_body_edges(const Scene& scene, const FrameSetup& frame);
  void draw_translucent(const Scene& scene, const FrameSetup& frame);
  void draw_overlays(const Scene& scene, const FrameSetup& frame);
  [[nodiscard]] Image read_back();

  [[nodiscard]] std::vector<Sheet> translucent_sheets(const Scene& scene, const FrameSetup& frame);
  void draw_ground_plane(const Program& program, const FrameSetup& frame) const;
  void draw_edges(const DeviceMesh& mesh) const;
  void bind_texture(int unit, GLuint texture) const;

  const GlFunctions* gl_;
  std::vector<Program> programs_;
  DeviceMeshes meshes_;
  std::optional<Targets> targets_;
  MeshRef ball_;
  GLuint empty_array_ = 0;
  GLuint overlay_array_ = 0;
  GLuint overlay_buffer_ = 0;
};

}  // namespace pd::render::detail

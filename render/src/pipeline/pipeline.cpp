#include "pipeline/pipeline.hpp"

#include <Eigen/Geometry>
#include <algorithm>

#include "pipeline/overlay_geometry.hpp"
#include "pipeline/pass_parts.hpp"
#include "pipeline/shaders.hpp"

namespace pd::render::detail {
Expected<Pipeline> Pipeline::create(const GlFunctions& gl) {
  const std::string backdrop = backdrop_fragment();
  const std::string ground = ground_fragment();
  const std::string body = body_fragment();
  const std::string translucent = translucent_fragment();
  const std::pair<std::string_view, std::string_view> sources[] = {
      {kShadowVertex, kOpaqueShadowFragment},
      {kShadowVertex, kShadowFragment},
      {kSurfaceVertex, kSurfaceFragment},
      {kGroundVertex, kGroundSurfaceFragment},
      {kFullScreenVertex, kOcclusionFragment},
      {kFullScreenVertex, kSmoothFragment},
      {kFullScreenVertex, backdrop},
      {kGroundVertex, ground},
      {kBodyVertex, body},
      {kBodyVertex, translucent},
      {kEdgeVertex, kEdgeFragment},
      {kOverlayVertex, kOverlayFragment},
  };
  std::vector<Program> programs;
  for (const auto& [vertex, fragment] : sources) {
    auto program = Program::build(gl, vertex, fragment);
    if (!program) {
      return program.error();
    }
    programs.push_back(*std::move(program));
  }
  return Pipeline(gl, std::move(programs));
}

Pipeline::Pipeline(const GlFunctions& gl, std::vector<Program> programs)
    : gl_(&gl), programs_(std::move(programs)), meshes_(gl), ball_(sphere_mesh(1)) {
  gl.GenVertexArrays(1, &empty_array_);
  gl.GenVertexArrays(1, &overlay_array_);
  gl.GenBuffers(1, &overlay_buffer_);
  gl.BindVertexArray(overlay_array_);
  gl.BindBuffer(GL_ARRAY_BUFFER, overlay_buffer_);
  const GLint counts[] = {3, 3, 4};
  std::size_t offset = 0;
  for (GLuint index = 0; index < 3; ++index) {
    gl.EnableVertexAttribArray(index);
    gl.VertexAttribPointer(index, counts[index], GL_FLOAT, GL_FALSE, sizeof(OverlayVertex),
                           reinterpret_cast<const void*>(offset));
    offset += sizeof(float) * static_cast<std::size_t>(counts[index]);
  }
  gl.BindVertexArray(0);
}

void Pipeline::bind_texture(int unit, GLuint texture) const {
  gl_->ActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
  gl_->BindTexture(GL_TEXTURE_2D, texture);
}

void Pipeline::draw_shadow_map(const Scene& scene, const FrameSetup& frame) {
  const GlFunctions& gl = *gl_;
  gl.BindFramebuffer(GL_FRAMEBUFFER, targets_->shadow.framebuffer);
  gl.Viewport(0, 0, Targets::kShadowSide, Targets::kShadowSide);
  gl.Clear(GL_DEPTH_BUFFER_BIT);
  gl.Enable(GL_POLYGON_OFFSET_FILL);
  gl.PolygonOffset(1.5f, 2);
  gl.Disable(GL_CULL_FACE);
  const auto cast = [&](const Program& program, const MeshRef& mesh, const Pose& pose, float density) {
    const DeviceMesh& device = meshes_.get(mesh);
    program.set("shadow", frame.shadow);
    program.set("density", density);
    program.set("model", model_matrix(frame, pose, mesh->unit));
    gl.BindVertexArray(device.surface);
    gl.DrawElements(GL_TRIANGLES, device.index_count, GL_UNSIGNED_INT, nullptr);
  };
  programs_[kShadowProgram].use();
  for (const Body& body : scene.bodies) {
    if (body.opacity >= kOpaque) {
      cast(programs_[kShadowProgram], body.mesh, body.pose, 1);
    }
  }
  const Program& ghost = programs_[kGhostShadowProgram];
  ghost.use();
  for (const Body& body : scene.bodies) {
    if (body.opacity < kOpaque) {
      cast(ghost, body.mesh, body.pose, kGhostShadow * body.opacity);
    }
  }
  for (const Solid& solid : scene.solids) {
    cast(ghost, solid.mesh, solid.pose, kGhostShadow * solid.opacity);
  }
  gl.Disable(GL_POLYGON_OFFSET_FILL);
  gl.Enable(GL_CULL_FACE);
}

void Pipeline::draw_ground_plane(const Program& program, const FrameSetup& frame) const {
  program.set("projection", frame.projection);
  program.set("centre", frame.ground_centre);
  program.set("axis_x", frame.ground_x);
  program.set("axis_y", frame.ground_y);
  program.set("eye", frame.eye);
  program.set("axes", frame.axes);
  program.set("reach", frame.ground_reach);
  gl_->BindVertexArray(empty_array_);
  gl_->Disable(GL_CULL_FACE);
  gl_->DrawArrays(GL_TRIANGLE_STRIP, 0, 4);
  gl_->Enable(GL_CULL_FACE);
}

void Pipeline::draw_surface(const Scene& scene, const FrameSetup& frame) {
  const GlFunctions& gl = *gl_;
  gl.BindFramebuffer(GL_FRAMEBUFFER, targets_->surface.framebuffer);
  gl.Viewport(0, 0, targets_->surface.size.width, targets_->surface.size.height);
  gl.ClearColor(0, 0, 0, 0);
  gl.Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  const Program& program = programs_[kSurfaceProgram];
  program.use();
  program.set("projection", frame.projection);
  program.set("axes", frame.axes);
  program.set("eye", frame.eye);
  for (const Body& body : scene.bodies) {
    if (body.opacity >= kOpaque) {
      const DeviceMesh& mesh = meshes_.get(body.mesh);
      const Eigen::Matrix4f model = body_model(frame, body);
      program.set("model", model);
      program.set("normal_scale", normal_scale(model));
      gl.BindVertexArray(mesh.surface);
      gl.DrawElements(GL_TRIANGLES, mesh.index_count, GL_UNSIGNED_INT, nullptr);
    }
  }
  if (scene.ground.visible) {
    const Program& ground = programs_[kGroundSurfaceProgram];
    ground.use();
    ground.set("view_normal", Eigen::Vector3f(frame.axes * frame.up));
    draw_ground_plane(ground, frame);
  }
}

void Pipeline::draw_occlusion(const FrameSetup& frame, bool grainy) {
  const GlFunctions& gl = *gl_;
  const Size half = targets_->surface.size;
  gl.Disable(GL_DEPTH_TEST);
  gl.Disable(GL_CULL_FACE);
  gl.Viewport(0, 0, half.width, half.height);
  gl.BindVertexArray(empty_array_);

  gl.BindFramebuffer(GL_FRAMEBUFFER, targets_->raw_occlusion.framebuffer);
  const Program& program = programs_[kOcclusionProgram];
  program.use();
  bind_texture(0, targets_->surface.texture);
  bind_texture(1, targets_->shadow.texture);
  program.set("surface", 0);
  program.set("shadow_map", 1);
  program.set("tangents", frame.tangents);
  program.set("texel", Eigen::Vector2f(1.0f / static_cast<float>(half.width), 1.0f / static_cast<float>(half.height)));
  Eigen::Matrix4f from_view = Eigen::Matrix4f::Identity();
  from_view.block<3, 3>(0, 0) = frame.axes.transpose();
  from_view.block<3, 1>(0, 3) = frame.eye;
  program.set("shadow_from_view", Eigen::Matrix4f(frame.shadow * from_view));
  program.set("light_in_view", Eigen::Vector3f(frame.axes * frame.to_light));
  program.set("shadow_texel", 1.0f / static_cast<float>(Targets::kShadowSide));
  program.set("shadow_width", frame.shadow_width);
  program.set("radius", frame.occlusion_radius);
  program.set("light_tangent", kLightTangent);
  gl.DrawArrays(GL_TRIANGLES, 0, 3);

  const Program& smooth = programs_[kSmoothProgram];
  smooth.use();
  smooth.set("raw", 0);
  const auto smooth_into = [&](const TextureTarget& to, const TextureTarget& from, int stride, int shift) {
    gl.BindFramebuffer(GL_FRAMEBUFFER, to.framebuffer);
    bind_texture(0, from.texture);
    smooth.set("stride", stride);
    smooth.set("shift", shift);
    gl.DrawArrays(GL_TRIANGLES, 0, 3);
  };
  smooth_into(targets_->occlusion, targets_->raw_occlusion, 1, 0);
  if (grainy) {
    // Twice more, wider and centred: -3 -1 1 3, then -6 -2 2 6.
    smooth_into(targets_->raw_occlusion, targets_->occlusion, 2, 1);
    smooth_into(targets_->occlusion, targets_->raw_occlusion, 4, 2);
  }
  gl.Enable(GL_CULL_FACE);
  gl.Enable(GL_DEPTH_TEST);
}

void Pipeline::draw_bodies(const Scene& scene, const FrameSetup& frame) {
  const Program& program = programs_[kBodyProgram];
  program.use();
  program.set("projection", frame.projection);
  program.set("axes", frame.axes);
  program.set("eye", frame.eye);
  program.set("up", frame.up);
  program.set("to_light", frame.to_light);
  program.set("occlusion", 0);
  for (const Body& body : scene.bodies) {
    if (body.opacity >= kOpaque) {
      const DeviceMesh& mesh = meshes_.get(body.mesh);
      const Eigen::Matrix4f model = body_model(frame, body);
      program.set("model", model);
      program.set("normal_scale", normal_scale(model));
      program.set("colour", to_vector(body.highlight ? saturated(body.colour) : body.colour, 1));
      gl_->BindVertexArray(mesh.surface);
      gl_->DrawElements(GL_TRIANGLES, mesh.index_count, GL_UNSIGNED_INT, nullptr);
    }
  }
}

void Pipeline::draw_ground_and_backdrop(const Scene& scene, const FrameSetup& frame) {
  const Eigen::Vector2f picture(static_cast<float>(targets_->size().width),
                                static_cast<float>(targets_->size().height));
  if (scene.ground.visible) {
    const Program& ground = programs_[kGroundProgram];
    ground.use();
    ground.set("occlusion", 0);
    ground.set("backdrop_top", to_vector(palette::kBackdropTop));
    ground.set("backdrop_bottom", to_vector(palette::kBackdropBottom));
    ground.set("picture", picture);
    ground.set("grid_step", frame.grid_step);
    ground.set("grid_offset", frame.grid_offset);
    ground.set("focus_radius", frame.focus_radius);
    draw_ground_plane(ground, frame);
  }
  const Program& backdrop = programs_[kBackdropProgram];
  backdrop.use();
  backdrop.set("backdrop_top", to_vector(palette::kBackdropTop));
  backdrop.set("backdrop_bottom", to_vector(palette::kBackdropBottom));
  backdrop.set("picture", picture);
  gl_->BindVertexArray(empty_array_);
  gl_->Disable(GL_CULL_FACE);
  gl_->DrawArrays(GL_TRIANGLES, 0, 3);
  gl_->Enable(GL_CULL_FACE);
}

void Pipeline::draw_edges(const DeviceMesh& mesh) const {
  gl_->BindVertexArray(mesh.edges);
  gl_->DrawElements(GL_TRIANGLES, mesh.edge_index_count, GL_UNSIGNED_INT, nullptr);
}

void Pipeline::draw_body_edges(const Scene& scene, const FrameSetup& frame) {
  const GlFunctions& gl = *gl_;
  gl.Enable(GL_BLEND);
  gl.DepthMask(GL_FALSE);
  gl.Disable(GL_CULL_FACE);
  const Program& program = programs_[kEdgeProgram];
  program.use();
  program.set("projection", frame.projection);
  program.set("eye", frame.eye);
  program.set("picture",
              Eigen::Vector2f(static_cast<float>(targets_->size().width), static_cast<float>(targets_->size().height)));
  program.set("towards_eye", kInkPull);
  program.set("back_share", 0.0f);
  for (const Body& body : scene.bodies) {
    if (body.opacity >= kOpaque && body.edges) {
      const Colour ink = body.highlight ? palette::mix(palette::kDepth, palette::kInk, 0.25f)
                                        : palette::mix(body.colour, palette::kInk, 0.72f);
      program.set("model", body_model(frame, body));
      program.set("colour", to_vector(ink, body.highlight ? 0.95f : 0.8f));
      program.set("width", std::max(1.0f, (body.highlight ? 2.2f : 1.4f) * frame.line_pixels));
      draw_edges(meshes_.get(body.mesh));
    }
  }
  gl.Enable(GL_CULL_FACE);
  gl.DepthMask(GL_TRUE);
  gl.Disable(GL_BLEND);
}

Image Pipeline::read_back() {
  const GlFunctions& gl = *gl_;
  const Size size = targets_->size();
  gl.BindFramebuffer(GL_READ_FRAMEBUFFER, targets_->frame);
  gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, targets_->resolved.framebuffer);
  gl.BlitFramebuffer(0, 0, size.width, size.height, 0, 0, size.width, size.height, GL_COLOR_BUFFER_BIT, GL_NEAREST);
  gl.BindFramebuffer(GL_READ_FRAMEBUFFER, targets_->resolved.framebuffer);
  gl.PixelStorei(GL_PACK_ALIGNMENT, 1);
  Image image(size);
  gl.ReadPixels(0, 0, size.width, size.height, GL_RGBA, GL_UNSIGNED_BYTE, image.bytes().data());
  gl.Finish();
  // Blending leaves alpha below 1 in places; the picture is opaque.
  for (std::size_t i = 3; i < image.bytes().size(); i += 4) {
    image.bytes()[i] = 255;
  }
  return image;
}

Expected<Image> Pipeline::draw(const Scene& scene, const Camera& camera, Size size) {
  const GlFunctions& gl = *gl_;
  // Near bodies first: what they hide is then never shaded.
  Scene sorted = scene;
  std::stable_sort(sorted.bodies.begin(), sorted.bodies.end(), [&](const Body& a, const Body& b) {
    return (a.pose.translation() - camera.eye).squaredNorm() < (b.pose.translation() - camera.eye).squaredNorm();
  });
  if (!targets_ || targets_->size() != size) {
    if (targets_) {
      targets_->destroy(gl);
      targets_.reset();
    }
    auto targets = Targets::create(gl, size);
    if (!targets) {
      return targets.error();
    }
    targets_ = *targets;
  }
  meshes_.collect();
  const FrameSetup frame = set_up_frame(sorted, camera, size);

  gl.Enable(GL_DEPTH_TEST);
  gl.DepthFunc(GL_LEQUAL);
  gl.DepthMask(GL_TRUE);
  gl.Disable(GL_BLEND);
  gl.BlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  gl.Enable(GL_CULL_FACE);
  gl.CullFace(GL_BACK);
  gl.FrontFace(GL_CW);  // the projection turns y round
  draw_shadow_map(sorted, frame);
  draw_surface(sorted, frame);
  const bool grainy = !sorted.solids.empty() || std::any_of(sorted.bodies.begin(), sorted.bodies.end(),
                                                            [](const Body& body) { return body.opacity < kOpaque; });
  draw_occlusion(frame, grainy);

  gl.BindFramebuffer(GL_FRAMEBUFFER, targets_->frame);
  gl.Viewport(0, 0, size.width, size.height);
  gl.Clear(GL_DEPTH_BUFFER_BIT);
  bind_texture(0, targets_->occlusion.texture);
  draw_bodies(sorted, frame);
  draw_ground_and_backdrop(sorted, frame);
  draw_body_edges(sorted, frame);
  draw_translucent(sorted, frame);
  draw_overlays(sorted, frame);
  return read_back();
}

}  // namespace pd::render::detail

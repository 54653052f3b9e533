/// @file
/// The passes that explain: translucent surfaces far to near, then arrows, discs and lines. Each is drawn twice, where
/// something opaque hides it (held back) and where nothing does.
#include <algorithm>

#include "pipeline/overlay_geometry.hpp"
#include "pipeline/pass_parts.hpp"
#include "pipeline/pipeline.hpp"

namespace pd::render::detail {

std::vector<Pipeline::Sheet> Pipeline::translucent_sheets(const Scene& scene, const FrameSetup& frame) {
  std::vector<Sheet> sheets;
  const auto add = [&](Layer layer, const MeshRef& mesh, const Pose& pose, double unit, const Eigen::Vector4f& colour,
                       float hidden, bool edges) {
    if (mesh->bounds.empty()) {
      return;
    }
    const Eigen::Matrix4f model = model_matrix(frame, pose, unit);
    const double to_world = unit / mesh->unit;
    const double radius = 0.5 * mesh->bounds.diagonal() * to_world * frame.scale;
    const double distance = (to_drawing(frame, pose.apply(to_world * mesh->bounds.centre())) - frame.eye).norm();
    const DeviceMesh* device = &meshes_.get(mesh);
    for (const bool back : {true, false}) {
      sheets.push_back({layer, back ? distance + radius : distance - radius, back, device, model, normal_scale(model),
                        colour, hidden, edges});
    }
  };
  for (const Body& body : scene.bodies) {
    if (body.opacity < kOpaque) {
      const Colour colour = body.highlight ? saturated(body.colour) : body.colour;
      add(Layer::ghost, body.mesh, body.pose, body.mesh->unit, to_vector(colour, body.opacity), 0, body.edges);
    }
  }
  for (const Solid& solid : scene.solids) {
    add(Layer::solid, solid.mesh, solid.pose, solid.mesh->unit, to_vector(solid.colour, solid.opacity),
        solid.hidden_opacity, solid.edges);
  }
  for (const Ball& ball : scene.balls) {
    add(ball.opacity < kOpaque ? Layer::ball : Layer::mark, ball_,
        Pose::from_trusted_matrix(Mat3::Identity(), ball.centre), ball.radius, to_vector(ball.colour, ball.opacity),
        0.8f * ball.opacity, false);
  }
  // Far sides of far things first: an outer shell's back lies behind, and its front before, everything inside it.
  std::stable_sort(sheets.begin(), sheets.end(), [](const Sheet& a, const Sheet& b) {
    return a.layer != b.layer ? a.layer < b.layer : a.distance > b.distance;
  });
  return sheets;
}

void Pipeline::draw_translucent(const Scene& scene, const FrameSetup& frame) {
  const GlFunctions& gl = *gl_;
  gl.Enable(GL_BLEND);
  gl.DepthMask(GL_FALSE);
  const Program& surface = programs_[kTranslucentProgram];
  const Program& ink = programs_[kEdgeProgram];
  surface.use();
  surface.set("projection", frame.projection);
  surface.set("axes", frame.axes);
  surface.set("eye", frame.eye);
  surface.set("up", frame.up);
  surface.set("to_light", frame.to_light);
  for (const Sheet& sheet : translucent_sheets(scene, frame)) {
    surface.use();
    surface.set("model", sheet.model);
    surface.set("normal_scale", sheet.normal_scale);
    gl.CullFace(sheet.back ? GL_FRONT : GL_BACK);
    gl.BindVertexArray(sheet.mesh->surface);
    // Back sides are fainter: the front is what has a shape.
    const float share = sheet.back ? 0.55f : 1;
    const auto draw = [&](GLenum test, float opacity) {
      if (opacity > 0) {
        gl.DepthFunc(test);
        surface.set("colour", Eigen::Vector4f(sheet.colour.x(), sheet.colour.y(), sheet.colour.z(), opacity * share));
        gl.DrawElements(GL_TRIANGLES, sheet.mesh->index_count, GL_UNSIGNED_INT, nullptr);
      }
    };
    draw(GL_GREATER, sheet.hidden_opacity);
    draw(GL_LEQUAL, sheet.colour.w());
    if (!sheet.back && sheet.edges) {
      ink.use();
      ink.set("model", sheet.model);
      const Colour line = palette::mix({sheet.colour.x(), sheet.colour.y(), sheet.colour.z()}, palette::kInk, 0.72f);
      ink.set("width", std::max(1.0f, 1.3f * frame.line_pixels));
      ink.set("back_share", 0.28f);
      gl.Disable(GL_CULL_FACE);
      const float strength = std::min(0.2f + 1.1f * sheet.colour.w(), 0.85f);
      if (sheet.hidden_opacity > 0) {
        gl.DepthFunc(GL_GREATER);
        ink.set("colour", to_vector(line, 0.7f * strength));
        draw_edges(*sheet.mesh);
      }
      gl.DepthFunc(GL_LEQUAL);
      ink.set("colour", to_vector(line, strength));
      draw_edges(*sheet.mesh);
      gl.Enable(GL_CULL_FACE);
    }
  }
  gl.CullFace(GL_BACK);
  gl.DepthFunc(GL_LEQUAL);
  gl.DepthMask(GL_TRUE);
  gl.Disable(GL_BLEND);
}

void Pipeline::draw_overlays(const Scene& scene, const FrameSetup& frame) {
  const OverlayGeometry geometry = overlay_geometry(scene, frame);
  if (geometry.ink.empty()) {
    return;
  }
  const GlFunctions& gl = *gl_;
  std::vector<OverlayVertex> vertices = geometry.halo;
  vertices.insert(vertices.end(), geometry.ink.begin(), geometry.ink.end());
  gl.BindVertexArray(overlay_array_);
  gl.BindBuffer(GL_ARRAY_BUFFER, overlay_buffer_);
  gl.BufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(vertices.size() * sizeof(OverlayVertex)), vertices.data(),
                GL_DYNAMIC_DRAW);
  const auto halo = static_cast<GLsizei>(geometry.halo.size());
  const auto ink = static_cast<GLsizei>(geometry.ink.size());
  const Program& program = programs_[kOverlayProgram];
  program.use();
  program.set("projection", frame.projection);
  program.set("to_light", frame.to_light);
  gl.Enable(GL_BLEND);
  gl.DepthMask(GL_FALSE);
  const auto draw = [&](GLenum test, float opacity, float flatness, GLint first, GLsizei count) {
    gl.DepthFunc(test);
    program.set("opacity", opacity);
    program.set("flatness", flatness);
    gl.DrawArrays(GL_TRIANGLES, first, count);
  };
  draw(GL_GREATER, 0.5f, 1, 0, halo);
  draw(GL_LEQUAL, 1, 1, 0, halo);
  // Hidden parts show through occluders, held back; they are drawn before the visible parts write their depth.
  draw(GL_GREATER, 0.72f, 0.4f, halo, ink);
  gl.DepthMask(GL_TRUE);
  draw(GL_LEQUAL, 1, 0.15f, halo, ink);
  gl.Disable(GL_BLEND);
}

}  // namespace pd::render::detail

#include "gl/targets.hpp"

#include <array>

namespace pd::render::detail {
namespace {

constexpr GLsizei kSamples = 4;

TextureTarget texture_target(const GlFunctions& gl, Size size, GLint internal_format, GLenum format, GLenum type,
                             GLenum attachment, bool with_depth) {
  TextureTarget target;
  target.size = size;
  gl.GenTextures(1, &target.texture);
  gl.BindTexture(GL_TEXTURE_2D, target.texture);
  gl.TexImage2D(GL_TEXTURE_2D, 0, internal_format, size.width, size.height, 0, format, type, nullptr);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  const bool from_light = attachment == GL_DEPTH_ATTACHMENT;
  const GLint wrap = from_light ? GL_CLAMP_TO_BORDER : GL_CLAMP_TO_EDGE;
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, wrap);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, wrap);
  if (from_light) {
    // Outside the light's view nothing stands in the way: depth 1 there.
    constexpr std::array<float, 4> kFar = {1, 1, 1, 1};
    gl.TexParameterfv(GL_TEXTURE_2D, GL_TEXTURE_BORDER_COLOR, kFar.data());
  }
  gl.GenFramebuffers(1, &target.framebuffer);
  gl.BindFramebuffer(GL_FRAMEBUFFER, target.framebuffer);
  gl.FramebufferTexture2D(GL_FRAMEBUFFER, attachment, GL_TEXTURE_2D, target.texture, 0);
  if (from_light) {
    gl.DrawBuffer(GL_NONE);
    gl.ReadBuffer(GL_NONE);
  }
  if (with_depth) {
    gl.GenRenderbuffers(1, &target.depth);
    gl.BindRenderbuffer(GL_RENDERBUFFER, target.depth);
    gl.RenderbufferStorageMultisample(GL_RENDERBUFFER, 0, GL_DEPTH_COMPONENT24, size.width, size.height);
    gl.FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, target.depth);
  }
  return target;
}

bool complete(const GlFunctions& gl, GLuint framebuffer) {
  gl.BindFramebuffer(GL_FRAMEBUFFER, framebuffer);
  return gl.CheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
}

void destroy_target(const GlFunctions& gl, const TextureTarget& target) {
  gl.DeleteFramebuffers(1, &target.framebuffer);
  gl.DeleteTextures(1, &target.texture);
  gl.DeleteRenderbuffers(1, &target.depth);
}

}  // namespace

Expected<Targets> Targets::create(const GlFunctions& gl, Size size) {
  GLint samples = 0;
  gl.GetIntegerv(GL_MAX_SAMPLES, &samples);
  if (samples < kSamples) {
    return Error{ErrorCode::unsupported, "the driver has no 4x multisampling", "renderer"};
  }
  const Size half{(size.width + 1) / 2, (size.height + 1) / 2};
  Targets targets;
  targets.size_ = size;
  targets.shadow = texture_target(gl, {kShadowSide, kShadowSide}, GL_DEPTH_COMPONENT32F, GL_DEPTH_COMPONENT, GL_FLOAT,
                                  GL_DEPTH_ATTACHMENT, false);
  targets.surface = texture_target(gl, half, GL_RGBA32F, GL_RGBA, GL_FLOAT, GL_COLOR_ATTACHMENT0, true);
  targets.raw_occlusion = texture_target(gl, half, GL_RGBA32F, GL_RGBA, GL_FLOAT, GL_COLOR_ATTACHMENT0, false);
  targets.occlusion = texture_target(gl, half, GL_RGBA32F, GL_RGBA, GL_FLOAT, GL_COLOR_ATTACHMENT0, false);
  targets.resolved = texture_target(gl, size, GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE, GL_COLOR_ATTACHMENT0, false);

  gl.GenFramebuffers(1, &targets.frame);
  gl.BindFramebuffer(GL_FRAMEBUFFER, targets.frame);
  gl.GenRenderbuffers(1, &targets.frame_colour_);
  gl.BindRenderbuffer(GL_RENDERBUFFER, targets.frame_colour_);
  gl.RenderbufferStorageMultisample(GL_RENDERBUFFER, kSamples, GL_RGBA8, size.width, size.height);
  gl.FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, targets.frame_colour_);
  gl.GenRenderbuffers(1, &targets.frame_depth_);
  gl.BindRenderbuffer(GL_RENDERBUFFER, targets.frame_depth_);
  gl.RenderbufferStorageMultisample(GL_RENDERBUFFER, kSamples, GL_DEPTH_COMPONENT24, size.width, size.height);
  gl.FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, targets.frame_depth_);

  for (const GLuint framebuffer :
       {targets.shadow.framebuffer, targets.surface.framebuffer, targets.raw_occlusion.framebuffer,
        targets.occlusion.framebuffer, targets.resolved.framebuffer, targets.frame}) {
    if (!complete(gl, framebuffer)) {
      targets.destroy(gl);
      return Error{ErrorCode::unsupported, "the driver refuses a framebuffer format", "renderer"};
    }
  }
  return targets;
}

void Targets::destroy(const GlFunctions& gl) {
  for (const TextureTarget* target : {&shadow, &surface, &raw_occlusion, &occlusion, &resolved}) {
    destroy_target(gl, *target);
  }
  gl.DeleteFramebuffers(1, &frame);
  gl.DeleteRenderbuffers(1, &frame_colour_);
  gl.DeleteRenderbuffers(1, &frame_depth_);
}

}  // namespace pd::render::detail

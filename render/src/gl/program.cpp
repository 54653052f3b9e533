#include "gl/program.hpp"

#include <array>

namespace pd::render::detail {
namespace {

Expected<GLuint> compile(const GlFunctions& gl, GLenum stage, std::string_view source) {
  const GLuint shader = gl.CreateShader(stage);
  const char* text = source.data();
  const auto length = static_cast<GLint>(source.size());
  gl.ShaderSource(shader, 1, &text, &length);
  gl.CompileShader(shader);
  GLint compiled = 0;
  gl.GetShaderiv(shader, GL_COMPILE_STATUS, &compiled);
  if (compiled != GL_TRUE) {
    std::array<char, 1024> log{};
    gl.GetShaderInfoLog(shader, static_cast<GLsizei>(log.size()), nullptr, log.data());
    gl.DeleteShader(shader);
    return Error{ErrorCode::unsupported, std::string("the driver refuses a shader: ") + log.data(), "renderer"};
  }
  return shader;
}

}  // namespace

Expected<Program> Program::build(const GlFunctions& gl, std::string_view vertex_source,
                                 std::string_view fragment_source) {
  const auto vertex = compile(gl, GL_VERTEX_SHADER, vertex_source);
  if (!vertex) {
    return vertex.error();
  }
  const auto fragment = compile(gl, GL_FRAGMENT_SHADER, fragment_source);
  if (!fragment) {
    return fragment.error();
  }
  const GLuint id = gl.CreateProgram();
  gl.AttachShader(id, *vertex);
  gl.AttachShader(id, *fragment);
  gl.LinkProgram(id);
  gl.DeleteShader(*vertex);
  gl.DeleteShader(*fragment);
  GLint linked = 0;
  gl.GetProgramiv(id, GL_LINK_STATUS, &linked);
  if (linked != GL_TRUE) {
    std::array<char, 1024> log{};
    gl.GetProgramInfoLog(id, static_cast<GLsizei>(log.size()), nullptr, log.data());
    return Error{ErrorCode::unsupported, std::string("the driver refuses a program: ") + log.data(), "renderer"};
  }
  return Program(gl, id);
}

GLint Program::location(const char* name) const {
  const auto known = locations_.find(std::string_view(name));
  if (known != locations_.end()) {
    return known->second;
  }
  const GLint found = gl_->GetUniformLocation(id_, name);
  locations_.emplace(name, found);
  return found;
}

}  // namespace pd::render::detail

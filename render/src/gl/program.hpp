/// @file
/// A linked shader program and its uniforms by name.
#pragma once

#include <Eigen/Core>
#include <map>
#include <string>
#include <string_view>

#include "gl/gl_functions.hpp"

namespace pd::render::detail {

class Program {
 public:
  /// Compiles and links. @return ErrorCode::unsupported with the driver's log.
  static Expected<Program> build(const GlFunctions& gl, std::string_view vertex_source,
                                 std::string_view fragment_source);

  void use() const { gl_->UseProgram(id_); }
  /// Setters need the program in use; a name that the compiler has dropped is ignored.
  void set(const char* name, int value) const { gl_->Uniform1i(location(name), value); }
  void set(const char* name, float value) const { gl_->Uniform1f(location(name), value); }
  void set(const char* name, const Eigen::Vector2f& v) const { gl_->Uniform2f(location(name), v.x(), v.y()); }
  void set(const char* name, const Eigen::Vector3f& v) const { gl_->Uniform3f(location(name), v.x(), v.y(), v.z()); }
  void set(const char* name, const Eigen::Vector4f& v) const {
    gl_->Uniform4f(location(name), v.x(), v.y(), v.z(), v.w());
  }
  void set(const char* name, const Eigen::Matrix3f& m) const {
    gl_->UniformMatrix3fv(location(name), 1, GL_FALSE, m.data());
  }
  void set(const char* name, const Eigen::Matrix4f& m) const {
    gl_->UniformMatrix4fv(location(name), 1, GL_FALSE, m.data());
  }

 private:
  Program(const GlFunctions& gl, GLuint id) : gl_(&gl), id_(id) {}
  [[nodiscard]] GLint location(const char* name) const;

  const GlFunctions* gl_;
  GLuint id_;
  mutable std::map<std::string, GLint, std::less<>> locations_;
};

}  // namespace pd::render::detail

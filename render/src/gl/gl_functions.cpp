#include "gl/gl_functions.hpp"

namespace pd::render::detail {

Expected<GlFunctions> load_gl_functions(const OffscreenContext& context) {
  GlFunctions gl;
#define PD_GL_LOAD(type, name)                                                     \
  gl.name = reinterpret_cast<type>(context.function("gl" #name));                  \
  if (gl.name == nullptr) {                                                        \
    return Error{ErrorCode::unsupported, "OpenGL 3.3 lacks gl" #name, "renderer"}; \
  }
  PD_GL_FUNCTIONS(PD_GL_LOAD)
#undef PD_GL_LOAD
  return gl;
}

}  // namespace pd::render::detail

/// @file
/// EGL on Mesa's surfaceless platform: no window system, no surface, hardware where Mesa drives it.
#include <EGL/egl.h>
#include <EGL/eglext.h>

#include <array>
#include <cstring>

#include "context/contexts.hpp"
#include "context/shared_library.hpp"

namespace pd::render::detail {
namespace {

struct EglFunctions {
  decltype(eglGetProcAddress)* function = nullptr;
  decltype(eglInitialize)* initialize = nullptr;
  decltype(eglBindAPI)* bind_api = nullptr;
  decltype(eglChooseConfig)* choose_config = nullptr;
  decltype(eglCreateContext)* create_context = nullptr;
  decltype(eglDestroyContext)* destroy_context = nullptr;
  decltype(eglMakeCurrent)* make_current = nullptr;
  decltype(eglQueryString)* query_string = nullptr;
};

class EglContext final : public OffscreenContext {
 public:
  EglContext(SharedLibrary library, const EglFunctions& functions, EGLDisplay display, EGLContext context)
      : library_(std::move(library)), functions_(functions), display_(display), context_(context) {}
  // The display is one per process and shared by all contexts on it: it is not terminated here.
  ~EglContext() override {
    functions_.make_current(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    functions_.destroy_context(display_, context_);
  }
  EglContext(const EglContext&) = delete;
  EglContext& operator=(const EglContext&) = delete;

  bool make_current() override {
    // The bound API is a thread's own.
    return functions_.bind_api(EGL_OPENGL_API) == EGL_TRUE &&
           functions_.make_current(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_) == EGL_TRUE;
  }
  Function function(const char* name) const override { return functions_.function(name); }

 private:
  SharedLibrary library_;
  EglFunctions functions_;
  EGLDisplay display_;
  EGLContext context_;
};

Error refusal(const char* message) { return Error{ErrorCode::unsupported, message, "renderer"}; }

}  // namespace

Expected<std::unique_ptr<OffscreenContext>> create_egl_context() {
  SharedLibrary library{"libEGL.so.1"};
  if (!library.opened()) {
    return refusal("libEGL.so.1 is not installed (Debian packages libegl1 and libegl-mesa0)");
  }
  EglFunctions egl;
  if (!library.find("eglGetProcAddress", egl.function) || !library.find("eglInitialize", egl.initialize) ||
      !library.find("eglBindAPI", egl.bind_api) || !library.find("eglChooseConfig", egl.choose_config) ||
      !library.find("eglCreateContext", egl.create_context) ||
      !library.find("eglDestroyContext", egl.destroy_context) || !library.find("eglMakeCurrent", egl.make_current) ||
      !library.find("eglQueryString", egl.query_string)) {
    return refusal("libEGL.so.1 lacks an EGL 1.4 function");
  }
  const char* extensions = egl.query_string(EGL_NO_DISPLAY, EGL_EXTENSIONS);
  const auto get_display = reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(egl.function("eglGetPlatformDisplayEXT"));
  if (extensions == nullptr || std::strstr(extensions, "EGL_MESA_platform_surfaceless") == nullptr ||
      get_display == nullptr) {
    return refusal("EGL has no surfaceless platform (Debian package libegl-mesa0 brings it)");
  }
  EGLDisplay display = get_display(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
  if (display == EGL_NO_DISPLAY || egl.initialize(display, nullptr, nullptr) != EGL_TRUE) {
    return refusal("EGL's surfaceless display does not start (Debian package libgl1-mesa-dri brings its drivers)");
  }
  // No kind of surface is asked for; the default would ask for windows.
  constexpr std::array<EGLint, 5> kConfigAttributes = {EGL_SURFACE_TYPE, 0, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT,
                                                       EGL_NONE};
  EGLConfig config = nullptr;
  EGLint count = 0;
  if (egl.bind_api(EGL_OPENGL_API) != EGL_TRUE ||
      egl.choose_config(display, kConfigAttributes.data(), &config, 1, &count) != EGL_TRUE || count < 1) {
    return refusal("EGL offers no desktop OpenGL");
  }
  constexpr std::array<EGLint, 7> kContextAttributes = {
      EGL_CONTEXT_MAJOR_VERSION,           3,       EGL_CONTEXT_MINOR_VERSION, 3, EGL_CONTEXT_OPENGL_PROFILE_MASK,
      EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE};
  EGLContext context = egl.create_context(display, config, EGL_NO_CONTEXT, kContextAttributes.data());
  if (context == EGL_NO_CONTEXT) {
    return refusal("EGL refuses an OpenGL 3.3 core context");
  }
  return std::unique_ptr<OffscreenContext>(std::make_unique<EglContext>(std::move(library), egl, display, context));
}

}  // namespace pd::render::detail

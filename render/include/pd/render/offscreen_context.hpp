/// @file
/// An OpenGL 3.3 core context without a window: OSMesa or EGL surfaceless behind one interface, both loaded at run
/// time.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "pd/numeric/expected.hpp"

namespace pd::render {

enum class ContextKind {
  osmesa,  ///< libOSMesa.so.8: software, runs anywhere, the default
  egl,     ///< libEGL.so.1 on Mesa's surfaceless platform
};

/// The words of `--renderer`: "osmesa", "egl".
[[nodiscard]] std::string_view to_string(ContextKind kind);

/// @return ErrorCode::bad_value for any other word.
Expected<ContextKind> context_kind(std::string_view word);

/// One context, owned; current on one thread at a time. It has no usable default framebuffer: draw into your own.
class OffscreenContext {
 public:
  virtual ~OffscreenContext() = default;
  OffscreenContext(const OffscreenContext&) = delete;
  OffscreenContext& operator=(const OffscreenContext&) = delete;

  /// Makes the context current on the calling thread. @return false where the system refuses.
  [[nodiscard]] virtual bool make_current() = 0;

  using Function = void (*)();
  /// A GL function by name, or nullptr.
  [[nodiscard]] virtual Function function(const char* name) const = 0;

 protected:
  OffscreenContext() = default;
};

/// @return ErrorCode::unsupported with the plain reason: which library or which capability is missing, and the Debian
/// package that brings it.
Expected<std::unique_ptr<OffscreenContext>> create_context(ContextKind kind);

}  // namespace pd::render

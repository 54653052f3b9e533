#include "pd/render/offscreen_context.hpp"

#include "context/contexts.hpp"

namespace pd::render {

std::string_view to_string(ContextKind kind) { return kind == ContextKind::osmesa ? "osmesa" : "egl"; }

Expected<ContextKind> context_kind(std::string_view word) {
  for (const ContextKind kind : {ContextKind::osmesa, ContextKind::egl}) {
    if (word == to_string(kind)) {
      return kind;
    }
  }
  return Error{ErrorCode::bad_value, "no renderer '" + std::string(word) + "'; there are osmesa and egl", "renderer"};
}

Expected<std::unique_ptr<OffscreenContext>> create_context(ContextKind kind) {
  return kind == ContextKind::osmesa ? detail::create_osmesa_context() : detail::create_egl_context();
}

}  // namespace pd::render

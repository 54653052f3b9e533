#include "pd/render/renderer.hpp"

#include <cassert>

#include "pipeline/pipeline.hpp"
#include "text/labels.hpp"

namespace pd::render {

struct Renderer::State {
  std::unique_ptr<OffscreenContext> context;
  detail::GlFunctions gl;
  std::optional<detail::Pipeline> pipeline;
};

Renderer::Renderer(std::unique_ptr<State> state) : state_(std::move(state)) {}
Renderer::~Renderer() = default;
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;

Expected<Renderer> Renderer::create(ContextKind kind) {
  auto context = create_context(kind);
  if (!context) {
    return context.error();
  }
  auto state = std::make_unique<State>();
  state->context = *std::move(context);
  if (!state->context->make_current()) {
    return Error{ErrorCode::unsupported, std::string(to_string(kind)) + " refuses to make its context current",
                 "renderer"};
  }
  const auto gl = detail::load_gl_functions(*state->context);
  if (!gl) {
    return gl.error();
  }
  state->gl = *gl;
  auto pipeline = detail::Pipeline::create(state->gl);
  if (!pipeline) {
    return pipeline.error();
  }
  state->pipeline.emplace(*std::move(pipeline));
  return Renderer(std::move(state));
}

Expected<Image> Renderer::draw(const Scene& scene, const Camera& camera, Size size) {
  assert(size.width >= 16 && size.height >= 16 && size.width <= 8192 && size.height <= 8192);
  if (!state_->context->make_current()) {
    return Error{ErrorCode::unsupported, "the context cannot be made current on this thread", "renderer"};
  }
  auto picture = state_->pipeline->draw(scene, camera, size);
  if (!picture) {
    return picture.error();
  }
  Image image = *std::move(picture);
  detail::draw_labels(image, scene, camera);
  return image;
}

}  // namespace pd::render

/// @file
/// The makers behind `create_context`.
#pragma once

#include "pd/render/offscreen_context.hpp"

namespace pd::render::detail {

Expected<std::unique_ptr<OffscreenContext>> create_osmesa_context();
Expected<std::unique_ptr<OffscreenContext>> create_egl_context();

}  // namespace pd::render::detail

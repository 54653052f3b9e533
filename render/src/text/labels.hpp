/// @file
/// The words that belong to places of a scene: arrows' values, labels, the scale bar.
#pragma once

#include <string>

#include "pd/render/image.hpp"
#include "pd/render/scene.hpp"

namespace pd::render::detail {

void draw_labels(Image& image, const Scene& scene, const Camera& camera);

/// "1 m", "20 cm", "5 mm", "10 µm"; from metres.
[[nodiscard]] std::string length_text(double metres);

}  // namespace pd::render::detail

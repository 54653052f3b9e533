/// @file
/// Arrows, contact discs and lines as triangles, with sizes on the screen rather than in the world.
#pragma once

#include <array>
#include <vector>

#include "pipeline/frame_setup.hpp"

namespace pd::render::detail {

struct OverlayVertex {
  std::array<float, 3> position;  ///< drawing space
  std::array<float, 3> normal;
  std::array<float, 4> tint;
};

/// Triangle lists, counter-clockwise from outside. The halo goes below the ink and sets it off from any background.
struct OverlayGeometry {
  std::vector<OverlayVertex> halo;
  std::vector<OverlayVertex> ink;
};

OverlayGeometry overlay_geometry(const Scene& scene, const FrameSetup& frame);

}  // namespace pd::render::detail

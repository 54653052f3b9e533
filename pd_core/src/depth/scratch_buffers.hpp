/// @file
/// What a Scratch holds.
#pragma once

#include <vector>

#include "depth/decomposition_engine.hpp"
#include "depth/exact_surface.hpp"
#include "depth/overlay_engine.hpp"
#include "depth/plane_faces.hpp"
#include "depth/smooth_difference.hpp"
#include "depth/surface.hpp"
#include "depth/tied_facets.hpp"

namespace pd::detail {

struct ScratchBuffers {
  Surface surface;
  ExactSurface exact_surface;
  PosedVerticesPair posed;
  std::vector<std::int32_t> stack;
  std::vector<PointPair> points;
  OverlayDepthBuffers overlay;
  DecompositionBuffers decomposition;
  TiedFacetsBuffers tied_facets;
  PlaneFaces faces;
};

}  // namespace pd::detail

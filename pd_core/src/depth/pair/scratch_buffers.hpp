/// @file
/// What a Scratch holds.
#pragma once

#include <vector>

#include "depth/certificate/support_faces.hpp"
#include "depth/difference/smooth_difference.hpp"
#include "depth/expansion/exact_hull.hpp"
#include "depth/expansion/inner_surface.hpp"
#include "depth/facets/decomposition_depth.hpp"
#include "depth/facets/near_facets.hpp"
#include "depth/facets/overlay_depth.hpp"

namespace pd::detail {

struct ScratchBuffers {
  InnerSurface surface;
  ExactHull exact_hull;
  PosedVerticesPair posed;
  std::vector<std::int32_t> stack;
  std::vector<PointPair> points;
  OverlayDepthBuffers overlay;
  DecompositionBuffers decomposition;
  NearFacetsBuffers near_facets;
  SupportFaces faces;
};

}  // namespace pd::detail

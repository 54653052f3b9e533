/// @file
/// One answer about two bodies.
#pragma once

#include "pd/depth/depth_answer.hpp"
#include "pd/shape/convex_shape.hpp"

namespace pd::detail {

/// One answer, with the bodies that it was made for. Valid while the buffers of the call are held, and until the pair's
/// memory meets other shapes.
struct PairAnswer {
  PenetrationDepth depth;
  PosedShape a;
  PosedShape b;
  bool boxes = false;  ///< two btBoxShapes, both taken sharp
};

}  // namespace pd::detail

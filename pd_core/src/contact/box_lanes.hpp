/// @file
/// A box in lanes, one an axis, as the kernels of two boxes' contacts read it (box_axes.hpp, box_faces.hpp).
#pragma once

namespace pd::detail {

/// The fourth lane is room, and 0.
struct BoxLanes {
  double x[4], y[4], z[4];  ///< of its axes
  double half[4];           ///< extents
};

}  // namespace pd::detail

/// @file
/// Depth of two boxes by the kernel for boxes (gauss_boxes.hpp), with a certificate in doubles.
///
/// Planes whose normals lie next to the winner's are as far as its foot, which lies in P. Where the bracket is too wide
/// (edges nearly but not quite parallel, unless they cross along the winner's normal), where the faces that meet in the
/// winner's plane do not hold the point below the origin, and where the class is in doubt, the answer is `undecided`.
#pragma once

#include "depth/facets/gauss_sat.hpp"
#include "pd/shape/pose.hpp"

namespace pd::detail {

struct BoxBody {
  const ConvexPolytope& polytope;
  const BoxFrame& frame;
  const Pose& pose;
};

enum class BoxQuestion : std::uint8_t {
  depth,         ///< boxes apart need a direction only
  signed_depth,  ///< < 0 of boxes apart; touching ones are answered as well
  near_pieces    ///< facets of P that may be the nearest, for a proof on the stored numbers
};

/// Requires extents between 2^-100 and 2^100. Constant time, no allocation.
/// @param near  filled for `near_pieces`, the nearest piece first; two to an axis, one on either side, as far as
/// these may be the nearest; all others are `near->beyond` or farther. None where the class is in doubt.
[[nodiscard]] GaussSatDepth gauss_sat_of_boxes(const BoxBody& a, const BoxBody& b, const BracketWidth& width,
                                               BoxQuestion question, NearGaussPieces* near);

}  // namespace pd::detail

/// @file
/// The depth of two boxes is found by the kernel for boxes (gauss_boxes.hpp), with a certificate in doubles.
///
/// A plane with a normal close to the winner's cannot be nearer than the winner's foot point, because that point lies
/// in P. The answer is `undecided` in three cases. The bracket is too wide: edges are nearly but not quite parallel,
/// and do not cross along the winner's normal. Or the faces that meet in the winner's plane do not hold the point below
/// the origin. Or the class is in doubt.
#pragma once

#include "depth/facets/gauss_sat.hpp"
#include "pd/shape/pose.hpp"

namespace pd::detail {

/// A box as a polytope, with its frame and pose.
struct BoxBody {
  const ConvexPolytope& polytope;
  const BoxFrame& frame;
  const Pose& pose;
};

enum class BoxQuestion : std::uint8_t {
  depth,         ///< boxes apart need a direction only
  signed_depth,  ///< < 0 for boxes apart; touching ones are answered as well
  near_pieces    ///< facets of P that may be the nearest, for a proof on the stored numbers
};

/// Answers a question about two boxes. Requires extents between 2^-100 and 2^100. Constant time, no allocation.
/// @param near  filled for `near_pieces`, the nearest piece first: an axis has two pieces, one on either side, and
/// those
///              that may be the nearest are listed. All others are `near->beyond` or farther. The list is empty if the
///              class is in doubt.
[[nodiscard]] GaussSatDepth gauss_sat_of_boxes(const BoxBody& a, const BoxBody& b, const BracketWidth& width,
                                               BoxQuestion question, NearGaussPieces* near);

}  // namespace pd::detail

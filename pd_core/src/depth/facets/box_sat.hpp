/// @file
/// Depth of two boxes, in doubles with a certificate: the fifteen axes of separation (box_sat_kernels.hpp), no search.
///
/// Why it proves anything: every facet of P is spanned by two generators. A computed normal turns from the true one by
/// rounding over the sine of their angle, and h_P changes by at most that times the reach. Two generators parallel up
/// to rounding are taken for parallel: turning one into the other's direction moves no point of P by more than that
/// sine times its length.
///
/// The certificate fails, and the caller grows a surface, where the bracket is too wide (edges nearly but not quite
/// parallel), where the point below the origin is not inside the winner, and where the class is in doubt.
#pragma once

#include <optional>

#include "depth/difference/bracket_width.hpp"
#include "pd/shape/convex_polytope.hpp"
#include "pd/shape/feature.hpp"
#include "pd/shape/pose.hpp"

namespace pd::detail {

/// A box whose edges run along the axes of its own frame.
struct BoxFrame {
  Vec3 centre;
  Vec3 half_extents;
};

/// Centre and half extents, rounded, of a polytope that is exactly such a box.
std::optional<BoxFrame> box_frame(const ConvexPolytope& p);

enum class BoxPairStatus : std::uint8_t { certified, separated, undecided };

struct BoxPairDepth {
  BoxPairStatus status = BoxPairStatus::undecided;
  double lower = 0;
  double upper = 0;
  Vec3 normal = Vec3::UnitX();  ///< unit; separating when status says so
  Feature feature_a;
  Feature feature_b;
  Vec3 point_a = Vec3::Zero();  ///< witness on A, relative to A's translation
};

/// @param width  the certified bracket's greatest width.
/// Requires extents between 2^-100 and 2^100. Constant time, no allocation.
BoxPairDepth box_pair_depth(const ConvexPolytope& a, const BoxFrame& frame_a, const Pose& pose_a,
                            const ConvexPolytope& b, const BoxFrame& frame_b, const Pose& pose_b,
                            const BracketWidth& width);

}  // namespace pd::detail

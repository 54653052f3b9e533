/// @file
/// The boundary of a polygon whose rings touch, as closed walks that keep the interior on their left.
///
/// At a point where rings touch, the parts of the interior that meet there are corners of their own: a walk that
/// arrives along one edge leaves along the edge on the other side of the same part. Moved a little into its part, every
/// corner is alone, and the walks are simple curves that do not meet: triangulation and boundary need no more. The
/// interior is connected where one walk runs counter-clockwise.
#pragma once

#include <optional>
#include <vector>

#include "planar/ring_check.hpp"

namespace pd::detail {

/// Corners in flat form, ring after ring.
struct RingLinks {
  std::vector<Point2> points;
  std::vector<std::int32_t> ring_start;      ///< one more at the end
  std::vector<std::int32_t> next, previous;  ///< along the walks
  std::vector<std::int32_t> next_here;       ///< through the corners at one point
  std::vector<std::int32_t> edge;            ///< the given edge that the edge from a corner is a part of
  std::vector<std::int32_t> vertex;          ///< the given vertex at the corner's point
  std::optional<RingFault> fault;            ///< cut_in_two, by given vertices
};

/// Splits the edges that are touched, and links the corners.
[[nodiscard]] RingLinks link_touching_rings(const Rings& rings, const std::vector<RingTouch>& touches);

}  // namespace pd::detail

/// @file
/// The arcs of a normal diagram as straight segments: the sphere of directions seen through six gnomonic charts, the
/// faces of a cube.
///
/// [A] section 2.2 projects each of two hemispheres centrally to a plane, where arcs that reach the equator become
/// rays. A cube's faces keep everything bounded: in the chart of an axis w a direction n with <n, w> > 0 is the point
/// (x, y) = (<n, u>, <n, v>) / <n, w>, and each chart keeps the square |x|, |y| <= 1. Lemma 2.3 stays: directions of a
/// chart make at most 54.7 degrees with its axis.
///
/// Charts hold doubles. They serve to find and to order; whether two arcs cross is decided by `edge_crossing`.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "structure/overlay/overlay_walk.hpp"

namespace pd::detail {

/// Part of an arc in a chart, x0 <= x1. Each end lies within kChartError of the true one, or of a point of the true
/// arc's great circle where the chart or the arc was cut.
struct ChartSegment {
  double x0, y0, x1, y1;
  std::int32_t edge;  ///< the half-edge with the lower index
};

inline constexpr int kCharts = 6;

/// A chart's coordinates err by less: unit normals by 16u (rounded exactly in the body's frame, turned by a rotation
/// and by the cube's), quarter points by as much again, chart coordinates by twice the sum over <n, w> >= 1/4; the rest
/// is room.
inline constexpr double kChartError = 0x1p-44;

/// Charts overlap by this much at their seams, so that a crossing on a seam lies inside one of them.
inline constexpr double kChartOverlap = 0x1p-36;

/// The arcs of B's diagram (or, for A, of the diagram of -A, the mirror image), cut into the charts. Arcs of more than
/// a quarter of a circle are cut before, so that a chord never comes near the centre. Time O(edges).
void clip_to_charts(const PosedPair& pair, bool of_a, std::array<std::vector<ChartSegment>, kCharts>& charts);

}  // namespace pd::detail

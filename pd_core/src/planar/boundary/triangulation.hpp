/// @file
/// The plane round a polygon in triangles: its interior, its holes and what lies outside up to an enclosing box, with
/// the neighbours of every triangle. Every edge of the polygon is an edge of it ([D] section 4, step 1).
///
/// Each region is cut into monotone pieces by a sweep and those into triangles, in time O(n log n) (de Berg et al.,
/// "Computational geometry", chapter 3), all by exact signs. Diagonals are then flipped towards a Delaunay
/// triangulation, so that few triangles are long: what searches them by their place then meets few.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "pd/planar/polygon.hpp"

namespace pd::detail {

struct Triangle {
  /// Counter-clockwise. If rings touch, a triangle inside has the vertex of its own corner, one outside the first
  /// vertex at the point.
  std::array<std::int32_t, 3> vertex;
  std::array<std::int32_t, 3> neighbour;  ///< across the edge from vertex[k] to vertex[k + 1]; -1 past the box
  bool inside;                            ///< in the polygon
};

struct Triangulation {
  std::vector<Point2> points;       ///< the polygon's, then the four corners of the box
  std::vector<Triangle> triangles;  ///< those inside come first
  std::vector<std::int32_t> owner;  ///< of the edge from polygon vertex v to the next: the triangle on its inner side
  int num_inside = 0;
};

/// `with_outside` false leaves out the holes and what lies round the polygon.
[[nodiscard]] Triangulation triangulate(const Polygon& polygon, bool with_outside = true);

}  // namespace pd::detail

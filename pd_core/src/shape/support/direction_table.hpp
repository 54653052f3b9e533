/// @file
/// Which vertices can be farthest in a direction: lists for the cells of a cube of directions.
///
/// The six sides of the cube [-1, 1]^3 are cut into squares; a cell is the cone of directions through one. Its list
/// holds every vertex that is farthest in some direction of the cell, and few others, in single precision. A search for
/// a support reads one short list. Cells are about as many as vertices, up to 24,576, so that lists stay short; fewer
/// where slender normal cones cross many cells.
///
/// Directions are those of the frame in which the ellipsoid of the body's second moments is a ball, so that needles and
/// flat bodies have lists as short as those of round ones.
///
/// Found as follows. A vertex is left out if a neighbour is farther at all four corners of the cell, and so in all its
/// directions. Those farthest somewhere are none of these, and hang together: where the farthest vertex changes as a
/// direction moves through the cell, it does along an edge. So vertices are visited from the one farthest at the cell's
/// middle, on along the edges of those that stay.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <vector>

#include "pd/shape/convex_polytope.hpp"

namespace pd::detail {

/// A direction for searches in single precision: scaled by a power of two so that its largest coordinate lies in
/// [1, 2). False for those that this cannot do (zero, subnormal, nearly overflowing, not finite).
inline bool scale_for_search(const Vec3& direction, Vec3& scaled) {
  const auto bits = std::bit_cast<std::uint64_t>(direction.cwiseAbs().maxCoeff());
  const std::uint64_t exponent = bits >> 52;
  if (exponent == 0 || exponent >= 2046) return false;
  scaled = std::bit_cast<double>((2046 - exponent) << 52) * direction;
  return true;
}

/// The number of the cell that holds a direction (not zero), in a table of `cells` x `cells` squares a side: sides +x,
/// -x, +y, ..., rows and columns by the next two coordinates in cyclic order.
inline std::int32_t cell_of(float dx, float dy, float dz, std::int32_t cells) {
  const float cyclic[5] = {dx, dy, dz, dx, dy};
  const float x = std::abs(dx), y = std::abs(dy), z = std::abs(dz);
  const bool y_leads = y > x;
  const float larger = y_leads ? y : x;
  const int axis = z > larger ? 2 : (y_leads ? 1 : 0);
  const float half = 0.5F * static_cast<float>(cells);
  const float scale = half / (z > larger ? z : larger);
  const auto place = [&](float t) {
    const auto i = static_cast<std::int32_t>(t * scale + half);
    return i < cells ? i : cells - 1;
  };
  const std::int32_t side = 2 * axis + (std::signbit(cyclic[axis]) ? 1 : 0);
  return (side * cells + place(cyclic[axis + 1])) * cells + place(cyclic[axis + 2]);
}

/// Takes a direction into the frame of a table.
inline void into_frame(const float* frame, float& x, float& y, float& z) {
  x = frame[0] * x + frame[1] * y + frame[2] * z;
  y = frame[3] * y + frame[4] * z;
  z = frame[5] * z;
}

/// The first block of every cell in the order of cells, so that it is found without another look; then the further
/// blocks of those that have any.
struct DirectionTable {
  std::int32_t cells = 0;                           ///< squares along an edge of the cube
  std::vector<std::int32_t> more;                   ///< [6 cells^2 + 1]: where a cell's further blocks begin
  std::vector<ConvexPolytope::VertexBlock> blocks;  ///< [more.back()]
  float frame[6] = {};                              ///< as `Storage::table_frame`
};

/// @param polytope  complete but for its table; at least one vertex. Coordinates are those of the frame, from
/// the vertices' mean. Blocks are filled up with their cell's first vertex; ids rise within a cell. Time O(n) on round
/// bodies.
[[nodiscard]] DirectionTable direction_table(const ConvexPolytope::Storage& polytope);

/// The vertex farthest in a direction, up to single precision; the least id of those equal in it. Requires a table.
int farthest_in_table(const ConvexPolytope::Storage& polytope, float x, float y, float z);
inline int farthest_in_table(const ConvexPolytope::Storage& polytope, const Vec3& scaled) {
  return farthest_in_table(polytope, static_cast<float>(scaled.x()), static_cast<float>(scaled.y()),
                           static_cast<float>(scaled.z()));
}

}  // namespace pd::detail

/// @file
/// Vertices as arrays of coordinates: the farthest in a direction, and all of them turned.
///
/// Compiled for several instruction sets and chosen at run time, in a fixed order of lanes without contraction: the
/// same bits on every instruction set.
#pragma once

#include <cstdint>

#include "pd/shape/convex_polytope.hpp"
#include "shape/support/vertex_pair.hpp"

namespace pd::detail {

/// Padded to a multiple of kVertexBlock with copies of entry 0.
struct VertexArrays {
  const double* x;
  const double* y;
  const double* z;
  int count;
};
inline constexpr int kVertexBlock = 8;
static_assert(ConvexPolytope::kPadding % kVertexBlock == 0);

inline VertexArrays arrays_of(const ConvexPolytope& p) { return {p.x(), p.y(), p.z(), p.num_vertices()}; }

/// The lowest index among the maximisers of x[i] dx + y[i] dy + z[i] dz.
int farthest_vertex(const VertexArrays& vertices, double dx, double dy, double dz);

/// The same for two bodies in one direction.
VertexPair farthest_vertices(const VertexArrays& a, const VertexArrays& b, double dx, double dy, double dz);

/// The same in four directions, given by their x, then y, then z: together they take little longer than one.
void farthest_in_four_directions(const VertexArrays& a, const VertexArrays& b, const double (&directions)[12],
                                 VertexPair (&pairs)[4]);

/// The lowest id among the maximisers of x dx + y dy + z dz in single precision, over a block and `count` >= 0 more,
/// in which ids rise.
int farthest_of_blocks(const ConvexPolytope::VertexBlock& first, const ConvexPolytope::VertexBlock* more, int count,
                       float dx, float dy, float dz);

/// Writes sign * rotation * vertex for every vertex and its padding; `rotation` is column by column.
void transform_vertices(const VertexArrays& vertices, const double* rotation, double sign, double* x, double* y,
                        double* z);

/// Vertices of two bodies by their ids, and where they meet: row i of `out`, four doubles wide, is
/// B's matrix * b - A's matrix * a + offset for the pair (a, b) = ids[2 i], ids[2 i + 1], followed by these two ids.
struct PosedBodies {
  VertexArrays a;
  VertexArrays b;
  double matrix_a[9];  ///< row by row
  double matrix_b[9];
  double offset[3];
};
void pose_pairs(const PosedBodies& bodies, const std::int32_t* ids, int count, double* out);

}  // namespace pd::detail

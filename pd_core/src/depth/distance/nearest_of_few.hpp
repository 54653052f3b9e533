/// @file
/// The point of P nearest to the origin for two bodies whose vertices are few enough to be scanned: Gilbert, Johnson,
/// Keerthi 1988 as one kernel. It proves nothing: closest_of_few.hpp does.
///
/// Each step keeps the face of the simplex that holds its nearest point. After the first step that face holds the
/// newest vertex, so that three edges and three triangles are all there is to look at: one lane each.
///
/// Compiled for several instruction sets; every lane on its own: the same bits on each.
#pragma once

#include <cstdint>

#include "shape/support/vertex_arrays.hpp"

namespace pd::detail {

struct FewVertices {
  VertexArrays a;  ///< of -A, turned
  VertexArrays b;  ///< of B, turned
  double offset[3];
};

struct NearestGoal {
  double gap;     ///< a nearest point no farther behind its plane ends the search
  double beyond;  ///< so does a plane farther from the origin,
  double within;  ///< and a point of P that is no farther
  /// A plane at more than `apart` must have shown the bodies apart after so many supports, and the first one must lie
  /// no deeper than `deepest`.
  double apart;
  int shown_after;
  double deepest;
};

struct NearestOfFew {
  enum class Status : std::uint8_t {
    nearest,   ///< no support lies farther: of the simplex the nearest point is known as well as rounding lets it
    beyond,    ///< the plane is farther than asked
    undecided  ///< the origin may lie in P
  };
  Status status = Status::undecided;
  int supports = 0;
  double direction[3] = {0, 0, 0};  ///< unit; of the last support
  double height = 0;                ///< of the plane there: <x, direction> <= -height in P
  VertexPair support{0, 0};
  int count = 0;
  VertexPair simplex[3];
  double points[3][3];  ///< of P, by the simplex' vertices
  double weights[3];    ///< of the nearest point; they sum to 1 up to rounding
};

/// @param start      vertices of P to begin with, at most four.
/// @param direction  where to look first if there are none, any length but 0.
NearestOfFew nearest_of_few(const FewVertices& bodies, const VertexPair* start, int count, const double (&direction)[3],
                            const NearestGoal& goal);

}  // namespace pd::detail

/// @file
/// The point of P nearest to the origin for two bodies whose vertices are few enough to be scanned: Gilbert, Johnson,
/// Keerthi 1988 as one kernel (simplex_lanes.hpp). It proves nothing: closest_of_few.hpp does.
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

/// The same as they are, and what turns them, column by column.
struct FewVerticesInFrames {
  VertexArrays a;
  VertexArrays b;
  const double* rotation_a;
  const double* rotation_b;
};

struct NearestGoal {
  double gap;     ///< a nearest point no farther behind its plane ends the search
  double beyond;  ///< so does a plane farther from the origin,
  double within;  ///< and a point of P that is no farther
};

struct NearestOfFew {
  enum class Status : std::uint8_t {
    nearest,   ///< no support lies farther: of the simplex the nearest point is known as well as rounding lets it
    beyond,    ///< the plane is farther than asked
    enclosed,  ///< the simplex is a tetrahedron that holds the origin, up to rounding
    undecided  ///< the origin may lie in P
  };
  Status status = Status::undecided;
  int supports = 0;
  double direction[3] = {0, 0, 0};  ///< unit; of the last support
  double height = 0;                ///< of the plane there: <x, direction> <= -height in P
  VertexPair support{0, 0};
  int count = 0;
  VertexPair simplex[4];
  double points[3][3];  ///< nearest: of P, by the simplex' vertices
  double weights[3];    ///< nearest: of that point; they sum to 1 up to rounding
};

/// @param start  vertices of P to begin with, one to four.
NearestOfFew nearest_of_few(const FewVertices& bodies, const VertexPair* start, int count, const NearestGoal& goal);

struct NearestLaneFace;
struct LanePoint;
/// `add_vertex` (simplex_lanes.hpp) for a search whose supports come from elsewhere.
bool add_to_face(NearestLaneFace& face, const LanePoint& s);

/// The nearest point of one to three vertices of P, for bodies of any size, and `direction` from there to the origin.
NearestOfFew nearest_on_simplex(const LanePoint* corners, int count);

/// The vertices of A and B farthest in a direction of P, of any length: turned, but not moved.
struct SupportOfFew {
  VertexPair ids;
  double on_a[3];
  double on_b[3];
};
SupportOfFew support_of_few(const FewVerticesInFrames& bodies, const double (&direction)[3]);

}  // namespace pd::detail

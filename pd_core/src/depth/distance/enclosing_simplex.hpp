/// @file
/// A tetrahedron of vertices of P that holds the origin, or a plane that parts the two: the search for closest points
/// (gjk.hpp) as a test for overlap, which ends at the first of either.
#pragma once

#include <cstdint>
#include <span>

#include "depth/difference/polytope_difference.hpp"

namespace pd::detail {

struct EnclosingSimplex {
  enum class Status : std::uint8_t {
    encloses,  ///< up to rounding: the tetrahedron may be flat
    apart,     ///< <x, normal> <= upper < 0 for every point x of P
    unclear    ///< the origin is on P's boundary, about, or rounding hides where it is
  };
  Status status = Status::unclear;
  int count = 0;
  DifferenceVertex simplex[4];  ///< encloses: its corners; apart: of three at most the one nearest to the origin
  Vec3 normal = Vec3::UnitX();  ///< unit
  double upper = 0;
  DifferenceVertex separating{Vec3::Zero(), -1, -1};  ///< the vertex of P next to that plane
};

/// @param start  four vertices of P to begin with, whatever they span.
/// Requires a reach between 2^-100 and 2^100 and `prepare_supports` called.
EnclosingSimplex enclosing_simplex(const PolytopeDifference& difference, std::span<const DifferenceVertex, 4> start,
                                   std::vector<std::int32_t>& stack, std::int64_t& support_calls);

}  // namespace pd::detail

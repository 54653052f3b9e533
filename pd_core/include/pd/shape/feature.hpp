/// @file
/// A face of one convex body by its numbers: how depths, manifolds and structures name where two bodies meet.
#pragma once

#include <cstdint>

#include "pd/numeric/language.hpp"

namespace pd {

/// A face of one body: a vertex id, the two ids of an edge, or a facet.
struct Feature {
  enum class Kind : std::uint8_t { none, vertex, edge, facet };
  Kind kind = Kind::none;
  std::int32_t first = -1;   ///< vertex, first vertex of the edge, or facet index (ConvexPolytope's own numbering)
  std::int32_t second = -1;  ///< second vertex of the edge
};

}  // namespace pd

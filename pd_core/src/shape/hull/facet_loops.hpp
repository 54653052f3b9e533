/// @file
/// From a triangulated hull to its facets: coplanar triangles merged, vertices inside facets and edges dropped.
#pragma once

#include <cstdint>
#include <vector>

#include "shape/hull/quickhull.hpp"

namespace pd::detail {

/// Facet f is the loop vertices[offsets[f]] .. vertices[offsets[f + 1] - 1], counter-clockwise from outside. The loops
/// close a surface: every directed edge occurs once, and so does its reverse.
struct FacetLoops {
  std::vector<std::int32_t> offsets{0};
  std::vector<std::int32_t> vertices;

  void end_facet() { offsets.push_back(static_cast<std::int32_t>(vertices.size())); }
  [[nodiscard]] int size() const { return static_cast<int>(offsets.size()) - 1; }
};

/// The facets of the hull, as loops of point indices. The hull must be compact. Two triangles belong to one facet when
/// coplanar triangles connect them (union-find over exact tests); a point is a vertex when three facets or more meet in
/// it. Time O(n alpha(n)).
[[nodiscard]] FacetLoops merge_facets(const Quickhull& hull, int num_points);

}  // namespace pd::detail

/// @file
/// Faces of a union's parts that lie inside of the union: where facets of two parts coincide, and where such facets
/// surround an edge or a vertex.
///
/// Let the points of a face of A_i, but for its rim, lie in the interior of A. For every b the points b - a have all of
/// b - A around them, so that no facet of a P_ij made of that face is part of the boundary of P.
#pragma once

#include <set>
#include <utility>
#include <vector>

#include "compound/part_differences.hpp"

namespace pd::detail {

class BuriedFaces {
 public:
  /// Requires polytopes. Knows such faces where all parts have one pose, as those of a star-shaped body have.
  explicit BuriedFaces(PosedParts parts);

  /// True is certain.
  [[nodiscard]] bool holds(std::int32_t part, const Feature& face) const;

 private:
  using Edge = std::pair<std::int32_t, std::int32_t>;  ///< two points, the lesser number first
  static Edge edge(std::int32_t p, std::int32_t q) { return p < q ? Edge(p, q) : Edge(q, p); }

  std::vector<std::vector<std::int32_t>> points_;  ///< by part and vertex: the number of the point
  std::vector<std::vector<char>> buried_;          ///< by part and facet
  std::vector<char> bare_points_;                  ///< by point: on a facet that is not buried
  std::set<Edge> bare_edges_;
};

}  // namespace pd::detail

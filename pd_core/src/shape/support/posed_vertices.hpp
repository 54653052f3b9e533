/// @file
/// The vertices of a polytope at a pose: for queries that ask for many supports of a small body.
#pragma once

#include <vector>

#include "pd/shape/convex_polytope.hpp"
#include "shape/support/vertex_arrays.hpp"

namespace pd::detail {

/// A buffer; grows to the largest body that it has held.
class PosedVertices {
 public:
  /// sign * rotation * vertex for every vertex; valid until the next call.
  VertexArrays transform(const ConvexPolytope& p, const Mat3& rotation, double sign) {
    const std::size_t size = static_cast<std::size_t>(p.padded_size());
    if (coordinates_.size() < 3 * size) coordinates_.resize(3 * size);
    double* const x = coordinates_.data();
    transform_vertices(arrays_of(p), rotation.data(), sign, x, x + size, x + 2 * size);
    return {x, x + size, x + 2 * size, p.num_vertices()};
  }

 private:
  std::vector<double> coordinates_;
};

}  // namespace pd::detail

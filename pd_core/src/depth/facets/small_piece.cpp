#include "depth/facets/small_piece.hpp"

#include "shape/normal_matrix.hpp"

namespace pd::detail {

SmallPieces::SmallPieces(const Pose& pose_a, const Pose& pose_b, const PolytopeDifference& difference)
    : difference_(difference),
      map_a_(small_gauss_map(difference.a())),
      map_b_(small_gauss_map(difference.b())),
      normals_a_(-normal_matrix(pose_a)),
      normals_b_(normal_matrix(pose_b)) {}

void SmallPieces::name(const SmallPiece& piece, const DifferenceVertex& s, NearFacets& out) const {
  if (piece.edge_a >= 0) {
    out.kind = NearFacetsBuffers::Kind::edges;
    out.edge_a[0] = map_a_.from[piece.edge_a];
    out.edge_a[1] = map_a_.to[piece.edge_a];
    out.edge_b[0] = map_b_.from[piece.edge_b];
    out.edge_b[1] = map_b_.to[piece.edge_b];
    return;
  }
  const bool of_a = piece.facet_a >= 0;
  out.kind = of_a ? NearFacetsBuffers::Kind::facet_of_a : NearFacetsBuffers::Kind::facet_of_b;
  out.facet = of_a ? piece.facet_a : piece.facet_b;
  out.vertex = of_a ? s.b : s.a;
}

}  // namespace pd::detail

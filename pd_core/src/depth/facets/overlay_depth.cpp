#include "depth/facets/overlay_depth.hpp"

#include <span>

#include "depth/facets/facet_enumeration.hpp"

namespace pd::detail {

OverlayDepth overlay_depth(const PosedPair& pair, OverlayDepthBuffers& buffers, bool exactly, double upper) {
  OverlayDepth result;
  const std::optional<FlatDifference> flat = flat_difference(pair);
  if (flat && !contains_origin(pair, *flat, buffers.loop)) return result;
  if (flat && flat->affine_dimension < 2) {
    result.contact = ContactClass::touching;
    return result;
  }
  if (flat && pair.a().affine_dimension() < 2 && pair.b().affine_dimension() < 2) {
    // Two crossing segments: the parallelogram has no overlay, only its plane.
    result.contact = ContactClass::touching;
    result.has_facet = true;
    result.facet = FacetOfDifference::from_edges(0, 1, 0, 1);
    return result;
  }

  OverlayWalk walk(pair, buffers.overlay);
  PlaneSearch search(walk, buffers.candidates, upper);
  walk.run([&](std::span<const OverlayPiece> pieces) { return search.consume(pieces); });

  const std::optional<OverlayPiece> piece = search.piece(exactly);
  result.facets_visited = search.visited();
  result.exact_comparisons = search.exact_comparisons();
  result.has_facet = piece.has_value();
  if (piece) result.facet = facet_of(pair, *piece);
  result.contact = search.outside() ? ContactClass::separated
                   : search.zero()  ? ContactClass::touching
                                    : ContactClass::overlapping;
  return result;
}

}  // namespace pd::detail

#include "pd/structure/overlay.hpp"

#include <array>

#include "structure/overlay/face_sum.hpp"
#include "structure/overlay/overlay_walk.hpp"

namespace pd {

namespace {

class CountOnly final : public OverlayVisitor {
 public:
  bool visit(std::span<const OverlayFacet>) override { return true; }
};

}  // namespace

Overlay::Overlay() : buffers_(std::make_unique<detail::OverlayBuffers>()) {}
Overlay::~Overlay() = default;
Overlay::Overlay(Overlay&&) noexcept = default;
Overlay& Overlay::operator=(Overlay&&) noexcept = default;

OverlayCounts Overlay::walk(const ConvexPolytope& a, const Pose& pose_a, const ConvexPolytope& b, const Pose& pose_b,
                            OverlayPieces pieces, OverlayVisitor& visitor) {
  OverlayCounts counts;
  const detail::PosedPair pair(a, pose_a, b, pose_b);
  const bool united = pieces == OverlayPieces::united;
  if (united && detail::flat_difference(pair)) return counts;
  detail::OverlayWalk walk(pair, *buffers_);
  std::array<OverlayFacet, detail::OverlayBuffers::kBlock> facets;
  walk.run([&](std::span<const detail::OverlayPiece> block) {
    std::size_t filled = 0;
    for (const detail::OverlayPiece& piece : block) {
      if (united) {
        const auto whole = detail::whole_facet(walk, piece);
        if (!whole) continue;
        facets[filled++] = {whole->on_a, whole->on_b};
      } else {
        const detail::FacetOfDifference facet = detail::facet_of(pair, piece);
        facets[filled++] = {facet.on_a, facet.on_b};
      }
      switch (piece.kind) {
        case detail::OverlayPiece::Kind::facet_of_a:
          ++counts.facet_vertex;
          break;
        case detail::OverlayPiece::Kind::facet_of_b:
          ++counts.vertex_facet;
          break;
        case detail::OverlayPiece::Kind::edges:
          ++counts.edge_edge;
      }
    }
    return filled == 0 || visitor.visit(std::span<const OverlayFacet>(facets.data(), filled));
  });
  return counts;
}

OverlayCounts Overlay::count(const ConvexPolytope& a, const Pose& pose_a, const ConvexPolytope& b, const Pose& pose_b,
                             OverlayPieces pieces) {
  CountOnly counter;
  return walk(a, pose_a, b, pose_b, pieces, counter);
}

}  // namespace pd

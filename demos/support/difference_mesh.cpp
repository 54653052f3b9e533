#include "support/difference_mesh.hpp"

#include <array>
#include <map>
#include <memory>
#include <utility>

namespace pd::demo {

namespace {

namespace palette = render::palette;

constexpr double kCosineOfCrease = 0.9848;  ///< 10 degrees: flatter edges are not inked

std::array<float, 3> to_floats(const Vec3& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

}  // namespace

render::Colour colour_of(DifferenceFacetKind kind) {
  switch (kind) {
    case DifferenceFacetKind::facet_vertex:
    case DifferenceFacetKind::facet_edge:
    case DifferenceFacetKind::facet_facet:
      return palette::kFacetVertex;
    case DifferenceFacetKind::vertex_facet:
    case DifferenceFacetKind::edge_facet:
      return palette::kVertexFacet;
    case DifferenceFacetKind::edge_edge:
      break;
  }
  return palette::kEdgeEdge;
}

render::MeshRef difference_mesh(const MinkowskiDifference& p, const std::function<bool(std::size_t)>& wanted,
                                const std::function<render::Colour(std::size_t)>& colour_of_facet) {
  auto mesh = std::make_shared<render::Mesh>();
  std::map<std::pair<std::int32_t, std::int32_t>, std::size_t> facet_of_edge;
  for (std::size_t f = 0; f < p.facets.size(); ++f) {
    const MinkowskiDifference::Facet& facet = p.facets[f];
    for (std::int32_t k = 0; k < facet.count; ++k) {
      const std::int32_t from = p.corners[static_cast<std::size_t>(facet.first + k)];
      const std::int32_t to = p.corners[static_cast<std::size_t>(facet.first + (k + 1) % facet.count)];
      facet_of_edge[{from, to}] = f;
    }
  }
  const auto position = [&](std::int32_t v) { return p.vertices[static_cast<std::size_t>(v)].position; };
  for (std::size_t f = 0; f < p.facets.size(); ++f) {
    if (!wanted(f)) continue;
    const MinkowskiDifference::Facet& facet = p.facets[f];
    const render::Colour colour = colour_of_facet ? colour_of_facet(f) : colour_of(facet.kind);
    const auto first = static_cast<std::uint32_t>(mesh->vertices.size());
    for (std::int32_t k = 0; k < facet.count; ++k) {
      const std::int32_t from = p.corners[static_cast<std::size_t>(facet.first + k)];
      const std::int32_t to = p.corners[static_cast<std::size_t>(facet.first + (k + 1) % facet.count)];
      mesh->vertices.push_back({to_floats(position(from)), to_floats(facet.normal), {colour.r, colour.g, colour.b, 1}});
      mesh->bounds.include(position(from));
      if (k >= 2) {
        const auto corner = first + static_cast<std::uint32_t>(k);
        mesh->triangles.insert(mesh->triangles.end(), {first, corner - 1, corner});
      }
      const auto neighbour = facet_of_edge.find({to, from});
      const bool inner = neighbour != facet_of_edge.end() && wanted(neighbour->second);
      if (inner && neighbour->second < f) continue;  // inked from the other side
      if (inner && p.facets[neighbour->second].normal.dot(facet.normal) > kCosineOfCrease) continue;
      const Vec3 other = inner ? p.facets[neighbour->second].normal : Vec3(-facet.normal);
      mesh->feature_edges.push_back(
          {to_floats(position(from)), to_floats(position(to)), to_floats(facet.normal), to_floats(other)});
    }
  }
  return mesh;
}

}  // namespace pd::demo

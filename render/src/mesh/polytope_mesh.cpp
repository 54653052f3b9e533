#include <cassert>
#include <cmath>
#include <numbers>

#include "mesh/mesh_builder.hpp"

namespace pd::render {
namespace {

const double kFeatureCosine = std::cos(10 * std::numbers::pi / 180);

}  // namespace

MeshRef polytope_mesh(const ConvexPolytope& polytope, std::span<const Colour> facet_colours) {
  assert(facet_colours.empty() || facet_colours.size() == static_cast<std::size_t>(polytope.num_facets()));
  detail::MeshBuilder builder;
  std::vector<Vec3> loop;
  for (int facet = 0; facet < polytope.num_facets(); ++facet) {
    loop.clear();
    for (const std::int32_t v : polytope.facet_vertices(facet)) {
      loop.push_back(polytope.vertex(v));
    }
    std::array<float, 4> tint{};
    if (!facet_colours.empty()) {
      const Colour colour = facet_colours[static_cast<std::size_t>(facet)];
      tint = {colour.r, colour.g, colour.b, 1};
    }
    builder.add_polygon(loop, polytope.facet_normal(facet), tint);
  }
  for (int h = 0; h < polytope.num_half_edges(); ++h) {
    const HalfEdge& edge = polytope.half_edge(h);
    if (h > edge.twin) {
      continue;  // each edge once
    }
    const int other = polytope.half_edge(edge.twin).facet;
    const bool bare = edge.facet < 0 || other < 0;  // the edge of a segment
    const Vec3 left = bare ? Vec3::UnitX() : polytope.facet_normal(edge.facet);
    const Vec3 right = bare ? Vec3(-left) : polytope.facet_normal(other);
    if (left.dot(right) < kFeatureCosine) {
      builder.add_edge(polytope.vertex(edge.origin), polytope.vertex(polytope.target(h)), left, right);
    }
  }
  if (polytope.num_half_edges() == 0) {
    builder.add_edge(polytope.vertex(0), polytope.vertex(0), Vec3::UnitX(), -Vec3::UnitX());
  }
  return builder.finish();
}

}  // namespace pd::render

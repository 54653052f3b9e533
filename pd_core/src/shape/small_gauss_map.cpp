#include "shape/small_gauss_map.hpp"

namespace pd::detail {

void fill_small_gauss_map(const ConvexPolytope::Storage& s, SmallGaussMap& out) {
  const auto vertex = [&](std::int32_t v) { return Vec3(s.x[v], s.y[v], s.z[v]); };
  out.facets = static_cast<std::uint8_t>(s.num_facets);
  for (int i = 0; i < SmallGaussMap::kMostFacets; ++i) {
    const int f = i < s.num_facets ? i : 0;
    const Vec3& n = s.facet_normals[f];
    out.nx[i] = n.x();
    out.ny[i] = n.y();
    out.nz[i] = n.z();
    out.height[i] = n.dot(vertex(s.facet_vertices[s.facet_offsets[f]]));
  }
  int count = 0;
  for (int h = 0; h < s.num_half_edges; ++h) {
    const HalfEdge& e = s.half_edges[h];
    if (e.twin < h) continue;
    const HalfEdge& back = s.half_edges[e.twin];
    out.from[count] = static_cast<std::uint8_t>(e.origin);
    out.to[count] = static_cast<std::uint8_t>(back.origin);
    out.left[count] = static_cast<std::uint8_t>(e.facet);
    out.right[count] = static_cast<std::uint8_t>(back.facet);
    ++count;
  }
  out.edges = static_cast<std::uint8_t>(count);
  for (int g = 0; g < SmallGaussMap::kMostFacets / SmallGaussMap::kFacetGroup; ++g) {
    for (unsigned set = 0; set < 1U << SmallGaussMap::kFacetGroup; ++set) {
      std::uint64_t found = 0;
      for (int e = 0; e < count; ++e) {
        const auto holds = [&](int facet) {
          return facet / SmallGaussMap::kFacetGroup == g && (set >> facet % SmallGaussMap::kFacetGroup & 1) != 0;
        };
        if (holds(out.left[e])) found |= std::uint64_t{1} << e;
        if (holds(out.right[e])) found |= std::uint64_t{1} << (32 + e);
      }
      out.edges_of_facets[g][set] = found;
    }
  }
}

}  // namespace pd::detail

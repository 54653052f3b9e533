#include "shape/small_gauss_map.hpp"

namespace pd::detail {

void fill_small_gauss_map(const ConvexPolytope::Storage& s, SmallGaussMap& out) {
  const auto vertex = [&](std::int32_t v) { return Vec3(s.x[v], s.y[v], s.z[v]); };
  out.facets = static_cast<std::uint8_t>(s.num_facets);
  for (int i = 0; i < SmallGaussMap::kFacetSlots; ++i) {
    const int f = i < s.num_facets ? i : 0;
    const Vec3& n = s.facet_normals[f];
    out.nx[i] = n.x();
    out.ny[i] = n.y();
    out.nz[i] = n.z();
    const std::int32_t on = s.first_corner(f);
    out.height[i] = n.dot(vertex(on));
  }
  int count = 0;
  for (int h = 0; h < s.num_half_edges; ++h) {
    const HalfEdge e = s.half_edge(h);
    if (e.twin < h) continue;
    const HalfEdge back = s.half_edge(e.twin);
    out.edge[count] = {static_cast<std::uint8_t>(e.origin), static_cast<std::uint8_t>(back.origin),
                       static_cast<std::uint8_t>(e.facet), static_cast<std::uint8_t>(back.facet)};
    out.left[count] = out.edge[count].left;
    out.right[count] = out.edge[count].right;
    ++count;
  }
  out.edges = static_cast<std::uint8_t>(count);
}

}  // namespace pd::detail

#include "depth/facets/shared_facets.hpp"

#include <algorithm>

#include "structure/overlay/facet_of_difference.hpp"

namespace pd::detail {

namespace {

/// The sine of two normals above which doubles tell that they are not opposite.
constexpr double kClearlyApart = 0x1p-30;

bool is_large(const ConvexPolytope& body, int facet) {
  const auto edges = static_cast<double>(body.facet_vertices(facet).size());
  return edges * edges >= body.num_edges();
}

Vec3 normal_of(const PosedDiagram& diagram, int facet) {
  const PosedDiagram::Facet& f = diagram.facets[static_cast<std::size_t>(facet)];
  return {f.normal[0], f.normal[1], f.normal[2]};
}

bool are_opposite(const OverlayWalk& walk, int of_a, int of_b) {
  const Vec3 m = normal_of(walk.buffers().a, of_a).stableNormalized();
  const Vec3 n = normal_of(walk.buffers().b, of_b).stableNormalized();
  if (!(m.dot(n) < 0) || m.cross(n).squaredNorm() > kClearlyApart * kClearlyApart) return false;
  const PosedPair& pair = walk.pair();
  const auto a = FacetOfDifference::corners(pair.a(), of_a), b = FacetOfDifference::corners(pair.b(), of_b);
  const PairVector u = PairVector::edge_b(b[0], b[1]), v = PairVector::edge_b(b[0], b[2]);
  return pair.sign_determinant(PairVector::edge_a(a[0], a[1]), u, v) == 0 &&
         pair.sign_determinant(PairVector::edge_a(a[0], a[2]), u, v) == 0;
}

}  // namespace

void find_shared_facets(const OverlayWalk& walk, SharedFacets& shared) {
  const ConvexPolytope &a = walk.pair().a(), &b = walk.pair().b();
  shared.count = 0;
  shared.of_a.assign(static_cast<std::size_t>(a.num_facets()), -1);
  shared.of_b.assign(static_cast<std::size_t>(b.num_facets()), -1);
  shared.large_a.clear();
  for (int f = 0; f < a.num_facets(); ++f) {
    if (is_large(a, f)) shared.large_a.push_back(f);
  }
  if (shared.large_a.empty()) return;
  for (int g = 0; g < b.num_facets(); ++g) {
    if (!is_large(b, g)) continue;
    const auto f = std::find_if(shared.large_a.begin(), shared.large_a.end(),
                                [&](std::int32_t of_a) { return are_opposite(walk, of_a, g); });
    if (f == shared.large_a.end()) continue;
    shared.of_a[static_cast<std::size_t>(*f)] = shared.of_b[static_cast<std::size_t>(g)] = shared.count++;
  }
}

}  // namespace pd::detail

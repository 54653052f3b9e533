#include "depth/certificate/nearest_facet_proof.hpp"

#include <algorithm>
#include <cmath>

namespace pd::detail {

namespace {

/// The two ids when exactly two are distinct.
std::optional<std::pair<std::int32_t, std::int32_t>> two_of(std::int32_t x, std::int32_t y, std::int32_t z) {
  if (x == y && x == z) return std::nullopt;
  if (x == y || x == z) return std::pair{x, x == y ? z : y};
  if (y == z) return std::pair{x, y};
  return std::nullopt;
}

bool positive(const FacetPlane& plane) { return plane.known() && to_double(plane.distance) > plane.distance_error; }

/// Whether the plane's normal points to the side of the origin, in doubles: no decision rests on it.
bool faces_origin(const PosedPair& pair, const FacetOfDifference& facet) {
  return pair.approximate(facet.u).cross(pair.approximate(facet.v)).dot(pair.approximate(facet.point())) < 0;
}

FacetOfDifference by_points(const SurfaceCorners& t) {
  const VertexPair &p = t.v[0], &q = t.v[1], &r = t.v[2];
  return {{Feature::Kind::vertex, p.a, -1},
          {Feature::Kind::vertex, p.b, -1},
          PairVector::difference(p.a, p.b, q.a, q.b),
          PairVector::difference(p.a, p.b, r.a, r.b),
          p.a,
          p.b};
}

bool nearer_than(const FacetPlane& plane, double beyond) {
  return to_double(plane.distance) + plane.distance_error < beyond;
}

/// The plane of a triangle across a coordinate axis, told by stored coordinates: its three vertices of A, and those of
/// B, agree in one that is known exactly.
bool classify_across_axis(const PosedPair& pair, const SurfaceCorners& t, ProvenFacet& found) {
  const VertexPair &p = t.v[0], &q = t.v[1], &r = t.v[2];
  for (int k = 0; k < 3; ++k) {
    if (!pair.has_own_coordinate(k)) continue;
    const double* const a = pair.own_coordinate_a(k).x;
    const double* const b = pair.own_coordinate_b(k).x;
    if (a[p.a] != a[q.a] || a[p.a] != a[r.a] || b[p.b] != b[q.b] || b[p.b] != b[r.b]) continue;
    if (!set_axis_plane(pair, PairVector::point(p.a, p.b), k, found.plane)) return false;
    found.facet = by_points(t);
    return true;
  }
  return false;
}

/// The plane of a triangle's three points as that of a facet of A, a facet of B or two edges, which other decisions can
/// be read off; else by its points.
ProvenFacet classify(const PosedPair& pair, const SurfaceCorners& t) {
  const VertexPair &p = t.v[0], &q = t.v[1], &r = t.v[2];
  ProvenFacet found;
  if (classify_across_axis(pair, t, found)) return found;
  const auto measured = [&](const FacetOfDifference& facet) {
    found = {facet, measure_facet(pair, facet)};
    return positive(found.plane);
  };
  // A flat body's polygon has two facets, which face opposite ways.
  if (p.a == q.a && p.a == r.a) {
    for (int f = -1, tries = 0; tries < 2; ++tries) {
      f = facet_holding(pair.b(), p.b, q.b, r.b, f);
      if (f < 0) break;
      if (measured(FacetOfDifference::from_facet_of_b(pair.b(), f, p.a))) return found;
    }
  } else if (p.b == q.b && p.b == r.b) {
    for (int f = -1, tries = 0; tries < 2; ++tries) {
      f = facet_holding(pair.a(), p.a, q.a, r.a, f);
      if (f < 0) break;
      if (measured(FacetOfDifference::from_facet_of_a(pair.a(), f, p.b))) return found;
    }
  } else {
    const auto on_a = two_of(p.a, q.a, r.a);
    const auto on_b = two_of(p.b, q.b, r.b);
    if (on_a && on_b) {
      auto [a0, a1] = *on_a;
      const auto [b0, b1] = *on_b;
      // One of the two directions has the origin behind its plane: the one that doubles favour is tried first.
      if (faces_origin(pair, FacetOfDifference::from_edges(a0, a1, b0, b1))) std::swap(a0, a1);
      if (measured(FacetOfDifference::from_edges(a0, a1, b0, b1))) return found;
      if (measured(FacetOfDifference::from_edges(a1, a0, b0, b1))) return found;
    }
  }
  measured(by_points(t));
  return found;
}

bool lies_in(const SurfaceCorners& t, const SupportFaces& faces) {
  return std::all_of(std::begin(t.v), std::end(t.v), [&](const VertexPair& p) {
    return std::binary_search(faces.on_a.begin(), faces.on_a.end(), p.a) &&
           std::binary_search(faces.on_b.begin(), faces.on_b.end(), p.b);
  });
}

/// Whether a body is its own image in its origin. Vertices are in lexicographic order, which the image reverses.
bool symmetric(const ConvexPolytope& body) {
  const int last = body.num_vertices() - 1;
  for (const double* const x : {body.x(), body.y(), body.z()}) {
    for (int v = 0; 2 * v <= last; ++v) {
      if (x[v] != -x[last - v]) return false;
    }
  }
  return true;
}

/// Whether the faces hold the triangle's image in the origin, and P is its own: bodies at one place tie at every facet,
/// which fractions would take long to say.
bool ties_with_opposite(const PosedPair& pair, const SurfaceCorners& t, const SupportFaces& faces) {
  if (!pair.at_one_place()) return false;
  const int last_a = pair.a().num_vertices() - 1, last_b = pair.b().num_vertices() - 1;
  SurfaceCorners image;
  std::transform(std::begin(t.v), std::end(t.v), std::begin(image.v), [&](const VertexPair& p) {
    return VertexPair{last_a - p.a, last_b - p.b};
  });
  return lies_in(image, faces) && symmetric(pair.a()) && symmetric(pair.b());
}

/// Sign of x's distance less y's, both positive: in double-double, else as fractions.
/// @param tied  whether they are known to be equal, asked before fractions are.
template <class Tied>
int compare_distances(const PosedPair& pair, const ProvenFacet& x, const ProvenFacet& y, Tied&& tied) {
  const double gap = to_double(x.plane.distance - y.plane.distance);
  const double error = (x.plane.distance_error + y.plane.distance_error) * (1 + 0x1p-40);
  if (std::abs(gap) > error) return gap < 0 ? -1 : 1;
  if (error == 0 || tied()) return 0;
  return compare(squared_distance(pair, x.facet), squared_distance(pair, y.facet));
}

}  // namespace

std::optional<ProvenFacet> prove_nearest_facet(const PosedPair& pair, std::span<const SurfaceCorners> near,
                                               double beyond, bool first_of_equals, SupportFaces& faces) {
  if (near.empty()) return std::nullopt;
  ProvenFacet best = classify(pair, near.front());
  // Each round either ends or goes on with a plane that is certainly nearer.
  for (std::size_t chosen = 0;;) {
    if (!positive(best.plane) || !collect_faces(pair, best.facet, best.plane, faces)) return std::nullopt;
    bool nearer = false;
    for (std::size_t i = 0; i < near.size() && !nearer; ++i) {
      if (i == chosen || lies_in(near[i], faces)) continue;
      const ProvenFacet other = classify(pair, near[i]);
      if (!positive(other.plane)) return std::nullopt;
      const int order = compare_distances(pair, other, best, [&] { return ties_with_opposite(pair, near[i], faces); });
      if (order == 0 && !(first_of_equals && chosen == 0)) return std::nullopt;
      if (order < 0) {
        best = other;
        chosen = i;
        nearer = true;
      }
    }
    if (nearer) continue;
    if (!nearer_than(best.plane, beyond)) return std::nullopt;
    return best;
  }
}

std::optional<ProvenFacet> prove_supporting_facet(const PosedPair& pair, const FacetOfDifference& facet,
                                                  double beyond) {
  const ProvenFacet found{facet, measure_facet(pair, facet)};
  if (!positive(found.plane) || !nearer_than(found.plane, beyond)) return std::nullopt;
  return found;
}

std::optional<ProvenFacet> prove_facet(const PosedPair& pair, const FacetOfDifference& facet, double beyond,
                                       SupportFaces& faces) {
  const std::optional<ProvenFacet> found = prove_supporting_facet(pair, facet, beyond);
  if (!found || !collect_faces(pair, facet, found->plane, faces)) return std::nullopt;
  return found;
}

}  // namespace pd::detail

#include "depth/pair/polytope_exact.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>

#include "depth/certificate/nearest_facet_proof.hpp"
#include "depth/expansion/exact_expanding_polytope.hpp"
#include "depth/facets/gauss_ties.hpp"
#include "depth/facets/unique_nearest_facet.hpp"
#include "depth/pair/double_answer.hpp"
#include "depth/pair/polytope_double.hpp"

namespace pd::detail {

namespace {

/// More faces that may be nearest are left to exact arithmetic.
constexpr std::size_t kMaxNearFaces = 16;

/// Supports of an exact expansion, after which facets tie: all facets of P take the time of some N / 4 supports then,
/// for bodies of N vertices together (prisms of 64 turned by noise: 40 million instructions for 432 supports, 3.3 for
/// all facets).
constexpr int exact_steps(int vertices) { return std::max(24, vertices / 4); }

ExactDirection normal_of(const PosedPair& posed, const FacetOfDifference& facet) {
  return ExactDirection(cross(posed.exact(facet.u), posed.exact(facet.v)));
}

SurfaceCorners corners_of(const InnerSurface& surface, int f) {
  DifferenceVertex corners[3];
  face_corners(surface, f, corners);
  return {{{corners[0].a, corners[0].b}, {corners[1].a, corners[1].b}, {corners[2].a, corners[2].b}}};
}

VertexPair any_vertex(PolytopeQuery& query, const ExpansionResult& surface) {
  if (!query.within_range()) return {0, 0};
  const DifferenceVertex s = query.with_supports().support(surface.normal, nullptr);
  return {s.a, s.b};
}

/// Vertices of P to look for the closest point from: those next to the plane that the expansion ended with.
std::span<const DifferenceVertex> first_simplex(PolytopeQuery& query, const ExpansionResult& ended,
                                                std::array<DifferenceVertex, 4>& vertices) {
  if (ended.status != ExpansionStatus::separated) {
    vertices[0] = query.with_supports().support(ended.normal, nullptr);
    return std::span(vertices).first(1);
  }
  const InnerSurface& surface = query.buffers.surface;
  std::size_t count = 3;
  if (ended.face >= 0) {
    DifferenceVertex corners[3];
    face_corners(surface, ended.face, corners);
    std::copy_n(corners, count, vertices.begin());
  } else {
    count = std::min(count, surface.vertices.size());
    std::copy_n(surface.vertices.begin(), count, vertices.begin());
  }
  vertices[count++] = ended.separating;
  return std::span(vertices).first(count);
}

/// The bits of what follows are those of the simplex, however the search came to it.
void sort_simplex(std::span<VertexPair> simplex) {
  std::sort(simplex.begin(), simplex.end(),
            [](const VertexPair& p, const VertexPair& q) { return std::pair(p.a, p.b) < std::pair(q.a, q.b); });
}

bool answer_from_proof(PolytopeQuery& query, const std::optional<ProvenFacet>& proven, PenetrationDepth& out) {
  if (!proven) return false;
  answer_overlapping(query.exact(), proven->facet, proven->plane, query.buffers.faces, query.pair.margins,
                     query.bracket, out);
  return true;
}

/// The nearest facet proved among `near`; every other piece of the surface is `beyond` or farther (in the caller's
/// lengths).
/// @param first_of_equals  as in `prove_nearest_facet`.
std::optional<ProvenFacet> prove_nearest(PolytopeQuery& query, std::span<const SurfaceCorners> near, double beyond,
                                         bool first_of_equals) {
  const PosedPair& posed = query.exact();
  return prove_nearest_facet(posed, near, beyond * posed.inwards(), first_of_equals, query.buffers.faces);
}

/// Returns three corners of a piece.
SurfaceCorners corners_of(const PosedPair& posed, const GaussPiece& piece) {
  const VertexPair first{piece.a[0], piece.b[0]};
  if (piece.is_of_edges()) return {{first, {piece.a[1], piece.b[0]}, {piece.a[0], piece.b[1]}}};
  if (piece.facet_a >= 0) {
    const auto loop = posed.a().facet_vertices(piece.facet_a);
    return {{{loop[0], first.b}, {loop[1], first.b}, {loop[2], first.b}}};
  }
  const auto loop = posed.b().facet_vertices(piece.facet_b);
  return {{{first.a, loop[0]}, {first.a, loop[1]}, {first.a, loop[2]}}};
}

/// True if the edges of boxes that are parallel up to rounding are exactly parallel.
/// @param pairs  as `NearGaussPieces::parallel`
bool are_parallel(const PosedPair& posed, unsigned pairs) {
  for (int i = 0; i < 9; ++i) {
    if ((pairs >> i & 1U) == 0 || (i % 4 == 0 && posed.same_rotation())) continue;
    // Edge k of a box runs from vertex 0 to vertex 4 >> k.
    if (!posed.parallel(PairVector::edge_a(0, 4 >> i / 3), PairVector::edge_b(0, 4 >> i % 3))) return false;
  }
  return true;
}

/// An exact search that is not observed, where no other facet is as near: the same facet without big numbers.
/// @param ended  where it is none: see UniqueNearestFacet::ended.
bool answer_from_unique_facet(PolytopeQuery& query, std::span<const VertexPair> start,
                              std::optional<SurfaceCorners>& ended, PenetrationDepth& out) {
  if (query.buffers.surface.watch) return false;
  const PosedPair& posed = query.exact();
  const UniqueNearestFacet nearest =
      unique_nearest_facet(posed, start, 4 * ExpansionBudget::min_steps(query.vertices()), query.buffers.faces);
  out.statistics.support_calls += nearest.support_calls;
  out.statistics.facets_visited += nearest.facets_visited;
  ended = nearest.ended;
  return answer_from_proof(query, nearest.found, out);
}

/// The origin is known to lie in P: in its interior, or `nearest` says where.
void expand_exactly(PolytopeQuery& query, std::span<const VertexPair> seed, const ExactClosestPoint* nearest,
                    PenetrationDepth& out) {
  const PosedPair& posed = query.exact();
  const ExactDepth exact = exact_expanding_polytope(posed, seed.data(), static_cast<int>(seed.size()),
                                                    exact_steps(query.vertices()), query.buffers.surface.watch);
  out.statistics.support_calls += exact.support_calls;
  out.statistics.facets_visited += exact.facets_visited;
  const Margins& margins = query.pair.margins;
  if (!exact.complete) {
    answer_by_overlay(query, out);
  } else if (exact.contact == ContactClass::overlapping) {
    const FacetOfDifference facet = facet_of_direction(posed, *exact.normal);
    answer_overlapping(posed, facet, margins, query.bracket, query.buffers.faces, out);
  } else {
    answer_touching(posed, *exact.normal, *nearest, margins, out);
  }
}

/// What the enumeration of facets or the decomposition has found.
void answer_from_facet(PolytopeQuery& query, const OverlayDepth& found, PenetrationDepth& out) {
  const PosedPair& posed = query.exact();
  const Margins& margins = query.pair.margins;
  out.statistics.facets_visited += found.facets_visited;
  out.statistics.exact_signs += found.exact_comparisons;
  if (found.contact == ContactClass::overlapping) {
    answer_overlapping(posed, found.facet, margins, query.bracket, query.buffers.faces, out);
    return;
  }
  const VertexPair any{0, 0};
  const ExactClosestPoint nearest = exact_closest_point(posed, &any, 1);
  if (nearest.apart) {
    answer_separated(posed, nearest, margins, out);
  } else if (found.has_facet) {
    answer_touching(posed, normal_of(posed, found.facet), nearest, margins, out);
  } else {
    const ExactDepth flat = exact_expanding_polytope(posed, &any, 1, std::numeric_limits<int>::max());
    answer_touching(posed, *flat.normal, nearest, margins, out);
  }
}

}  // namespace

bool answer_by_overlay(PolytopeQuery& query, PenetrationDepth& out, double upper) {
  const PosedPair& posed = query.exact();
  out.method = Method::overlay;
  const bool exactly = query.bracket == Bracket::tightest;
  const double scaled_upper = upper * posed.inwards();
  answer_from_facet(query, overlay_depth(posed, query.buffers.overlay, exactly, scaled_upper), out);
  return true;
}

bool answer_by_decomposition(PolytopeQuery& query, const ExpansionResult& surface, PenetrationDepth& out) {
  const PosedPair& posed = query.exact();
  out.method = Method::decomposition;
  if (!(surface.lower > 0)) {
    const VertexPair any = any_vertex(query, surface);
    const ExactClosestPoint nearest = exact_closest_point(posed, &any, 1);
    if (nearest.apart) {
      answer_separated(posed, nearest, query.pair.margins, out);
      return true;
    }
  }
  DecompositionBuffers& buffers = query.buffers.decomposition;
  buffers.vertices.clear();
  if (query.within_range()) {
    for (const DifferenceVertex& v : query.buffers.surface.vertices) buffers.vertices.push_back({v.a, v.b});
  }
  DecompositionSettings settings;
  if (surface.lower > 0) settings.upper = surface.upper * posed.inwards();
  settings.vertices = buffers.vertices;
  settings.seed = query.settings.seed;
  settings.exactly = query.bracket == Bracket::tightest;
  settings.may_enumerate = query.settings.method != Method::decomposition;
  const DecompositionDepth found = decomposition_depth(posed, settings, query.buffers.overlay, buffers);
  if (found.enumerated) out.method = Method::overlay;
  out.statistics.pair_evaluations += found.lines.pair_evaluations;
  out.statistics.block_bounds += found.lines.block_bounds;
  out.statistics.lines_scanned += found.lines.lines_scanned;
  answer_from_facet(query, found.nearest, out);
  return true;
}

bool prove_surface(PolytopeQuery& query, PenetrationDepth& out) {
  const ExpansionResult& surface = query.surface;
  // Keys err by the error of a point and of the distance itself; what lies beyond is certainly farther.
  const InnerSurface& faces = query.buffers.surface;
  const double error = face_error(query.difference);
  const double limit = surface.lower + 8 * error;
  std::array<SurfaceCorners, kMaxNearFaces> near;
  std::size_t count = 0;
  near[count++] = corners_of(faces, surface.face);
  for (int f = 0; f < faces.slots(); ++f) {
    if (f == surface.face || !(faces.key(f) <= limit * limit)) continue;
    if (count == near.size()) return false;
    near[count++] = corners_of(faces, f);
  }
  // An exact expansion from the nearest face would end at its facet, too, of several equally near.
  const bool first_of_equals = surface.status == ExpansionStatus::certified;
  return answer_from_proof(query,
                           prove_nearest(query, std::span(near).first(count), limit - 2 * error, first_of_equals), out);
}

bool prove_near_facets(PolytopeQuery& query, double beyond, PenetrationDepth& out) {
  const std::vector<SurfaceCorners>& near = query.buffers.near_facets.nearest;
  if (!(beyond > 0) || near.size() > kMaxNearFaces) return false;
  return answer_from_proof(query, prove_nearest(query, near, beyond, false), out);
}

bool prove_gauss_maps(PolytopeQuery& query, const GaussSatDepth& found, NearGaussPieces& near, PenetrationDepth& out) {
  if (near.count == 0 || !(near.beyond > 0)) return false;
  // The proofs take the origin to lie behind every piece.
  const double error = kGaussLowerError * query.difference.reach();
  for (int i = 0; i < near.count; ++i) {
    if (!(near.pieces[i].key > error * error)) return false;
  }
  const PosedPair& posed = query.exact();
  SupportFaces& faces = query.buffers.faces;
  if (!are_parallel(posed, near.parallel)) return false;
  const NearFacets& alone = found.nearest;
  if (alone.beyond > 0 && !found.foot) {
    const double beyond = alone.beyond * posed.inwards();
    if (answer_from_proof(query, prove_facet(posed, facet_of(posed, alone), beyond, faces), out)) return true;
  }
  if (near.count == 1) return false;
  const auto among_coplanar = [&] {
    if (near.count > static_cast<int>(kMaxNearFaces)) return false;
    std::array<SurfaceCorners, kMaxNearFaces> corners;
    const auto count = static_cast<std::size_t>(near.count);
    for (std::size_t i = 0; i < count; ++i) corners[i] = corners_of(posed, near.pieces[i].piece);
    return answer_from_proof(query, prove_nearest(query, std::span(corners).first(count), near.beyond, false), out);
  };
  const auto one_by_one = [&] {
    return near.all_told && answer_from_proof(query, nearest_of_ties(posed, query.with_supports(), near, faces), out);
  };
  // Flush faces lie in one plane where rotations are one but for axes, or leave an axis as it is; others by rounding.
  // Bodies at one place tie with their images, exactly.
  if (posed.in_one_frame() || posed.at_one_place()) return among_coplanar();
  return posed.has_an_own_coordinate() ? among_coplanar() || one_by_one() : one_by_one() || among_coplanar();
}

bool answer_by_exact_expansion(PolytopeQuery& query, PenetrationDepth& out) {
  const SurfaceCorners start = corners_of(query.buffers.surface, query.surface.face);
  std::optional<SurfaceCorners> ended;
  if (!answer_from_unique_facet(query, start.v, ended, out)) expand_exactly(query, start.v, nullptr, out);
  return true;
}

bool answer_by_closest_point(PolytopeQuery& query, PenetrationDepth& out) {
  const ExpansionResult& surface = query.surface;
  std::array<DifferenceVertex, 4> vertices;
  std::array<VertexPair, 4> start;
  std::size_t count = 0;
  // Also where a slender body's first simplex is flat to doubles: the bodies may be far apart.
  const bool in_doubles = surface.status == ExpansionStatus::separated || (surface.face < 0 && query.within_range());
  if (in_doubles) {
    const ClosestPoint nearest = closest_point(query, first_simplex(query, surface, vertices), out.statistics);
    if (answer_apart(query, nearest, out) && query.bracket == Bracket::certified) return true;
    for (; count < static_cast<std::size_t>(nearest.count); ++count) {
      start[count] = {nearest.simplex[count].a, nearest.simplex[count].b};
    }
    sort_simplex(std::span(start).first(count));
  }
  // Squares of very small numbers vanish, and doubles may know no simplex at all.
  if (count == 0) start[count++] = any_vertex(query, surface);
  const PosedPair& posed = query.exact();
  const Margins& margins = query.pair.margins;
  if (in_doubles) {
    SupportFaces& faces = query.buffers.faces;
    const auto proof = prove_separation(posed, std::span(start).first(count), faces);
    if (proof && answer_separated(posed, *proof, faces, margins, query.bracket, out)) return true;
  }
  std::optional<SurfaceCorners> ended;
  if (answer_from_unique_facet(query, std::span(start).first(count), ended, out)) return true;
  if (ended) {
    count = std::size(ended->v);
    std::copy_n(ended->v, count, start.begin());
    sort_simplex(std::span(start).first(count));
    SupportFaces& faces = query.buffers.faces;
    const auto proof = prove_separation(posed, std::span(start).first(count), faces);
    if (proof && answer_separated(posed, *proof, faces, margins, query.bracket, out)) return true;
  }
  const ExactClosestPoint nearest = exact_closest_point(posed, start.data(), static_cast<int>(count));
  if (nearest.apart) {
    answer_separated(posed, nearest, margins, out);
  } else {
    expand_exactly(query, std::span(nearest.simplex).first(static_cast<std::size_t>(nearest.count)), &nearest, out);
  }
  return true;
}

}  // namespace pd::detail

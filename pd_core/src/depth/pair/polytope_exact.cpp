#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "depth/certificate/nearest_facet_proof.hpp"
#include "depth/expansion/exact_expanding_polytope.hpp"
#include "depth/expansion/expanding_polytope.hpp"
#include "depth/pair/polytope_query.hpp"

namespace pd::detail {

namespace {

/// More faces that may be nearest are left to exact arithmetic.
constexpr std::size_t kMaxNearFaces = 16;

ExactDirection normal_of(const PosedPair& posed, const FacetOfDifference& facet) {
  return ExactDirection(cross(posed.exact(facet.u), posed.exact(facet.v)));
}

}  // namespace

void PolytopeQuery::solve_exactly(const ExpansionResult& result) {
  const PosedPair posed(*pair_.a, *pair_.pose_a, *pair_.b, *pair_.pose_b);
  if (start_count_ > 0) {
    const auto proof = prove_separation(posed, std::span(start_).first(start_count_), buffers_.faces);
    if (proof && finish_apart(posed, *proof, buffers_.faces, pair_.margins, bracket_, out_)) {
      count_stages(posed);
      return;
    }
  } else {
    start_[0] = any_vertex(result);
    start_count_ = 1;
  }
  const ExactNearest nearest = exact_nearest(posed, start_, start_count_);
  if (nearest.apart) {
    finish_apart(posed, nearest, pair_.margins, out_);
  } else {
    finish_from(posed, nearest.simplex.data(), nearest.count, &nearest);
  }
  count_stages(posed);
}

/// The nearest face of the surface proved to lie in the nearest facet of P, mostly without big numbers. False where
/// that fails.
bool PolytopeQuery::solve_by_proof(const ExpansionResult& result) {
  if (!(result.lower > 0) || result.face < 0) return false;
  // Keys err by the error of a point and of the distance itself; what lies beyond is certainly farther.
  const Surface& surface = buffers_.surface;
  const double error = face_error(difference_);
  const double limit = result.lower + 8 * error;
  std::array<SurfaceCorners, kMaxNearFaces> near;
  std::size_t count = 0;
  const auto add = [&](int f) {
    for (int i = 0; i < 3; ++i) {
      const DifferenceVertex& v = surface.vertices[surface.face(f).v[i]];
      near[count].v[i] = {v.a, v.b};
    }
    ++count;
  };
  add(result.face);
  for (int f = 0; f < surface.slots(); ++f) {
    if (f == result.face || !(surface.key(f) <= limit * limit)) continue;
    if (count == near.size()) return false;
    add(f);
  }
  const PosedPair posed(*pair_.a, *pair_.pose_a, *pair_.b, *pair_.pose_b);
  const double beyond = std::ldexp(limit - 2 * error, -posed.scale_exponent());
  const auto proven = prove_nearest_facet(posed, std::span(near).first(count), beyond, buffers_.faces);
  if (proven) {
    finish_overlapping(posed, proven->facet, proven->plane, buffers_.faces, pair_.margins, bracket_, out_);
  }
  count_stages(posed);
  return proven.has_value();
}

void PolytopeQuery::solve_overlapping_exactly(const ExpansionResult& result) {
  const PosedPair posed(*pair_.a, *pair_.pose_a, *pair_.b, *pair_.pose_b);
  VertexPair seed[3];
  for (int i = 0; i < 3; ++i) {
    const DifferenceVertex& v = buffers_.surface.vertices[buffers_.surface.face(result.face).v[i]];
    seed[i] = {v.a, v.b};
  }
  finish_from(posed, seed, 3, nullptr);
  count_stages(posed);
}

/// The origin is known to lie in P.
void PolytopeQuery::finish_from(const PosedPair& posed, const VertexPair* seed, int count,
                                const ExactNearest* nearest) {
  const ExactDepth exact = exact_expanding_polytope(
      posed, seed, count, 4 * ExpansionBudget::min_steps(pair_.a->num_vertices() + pair_.b->num_vertices()));
  out_.statistics.support_calls += exact.support_calls;
  out_.statistics.facets_visited += exact.facets_visited;
  if (!exact.complete) {
    solve_by_overlay();
  } else if (exact.contact == ContactClass::overlapping) {
    finish_overlapping(posed, facet_of_direction(posed, *exact.normal), pair_.margins, bracket_, buffers_.faces, out_);
  } else {
    finish_touching(posed, *exact.normal, *nearest, pair_.margins, out_);
  }
}

/// @param upper  of the cores' depth.
void PolytopeQuery::solve_by_overlay(double upper) {
  const PosedPair posed(*pair_.a, *pair_.pose_a, *pair_.b, *pair_.pose_b);
  out_.method = Method::overlay;
  const OverlayDepth overlay =
      overlay_depth(posed, buffers_.overlay, bracket_ == Bracket::tightest, std::ldexp(upper, -posed.scale_exponent()));
  finish_nearest(posed, overlay);
}

/// By supports along the normals of the surface's nearest faces.
void PolytopeQuery::tighten_upper(ExpansionResult& result) {
  result.upper = std::min(result.upper, upper_bound_of_nearest_faces(difference_, buffers_.surface, buffers_.stack,
                                                                     out_.statistics.support_calls));
}

/// Of the few pieces that may be nearest, the one that is. Those pieces and what lies beyond cover the boundary of P,
/// as the triangles of a surface enclose a ball: the proof is the same.
bool PolytopeQuery::prove_tied(const TiedFacets& found) {
  const std::vector<SurfaceCorners>& near = buffers_.tied_facets.nearest;
  if (!(found.beyond > 0) || near.size() > kMaxNearFaces) return false;
  const PosedPair posed(*pair_.a, *pair_.pose_a, *pair_.b, *pair_.pose_b);
  const double beyond = std::ldexp(found.beyond, -posed.scale_exponent());
  const auto proven = prove_nearest_facet(posed, near, beyond, buffers_.faces);
  if (proven) {
    finish_overlapping(posed, proven->facet, proven->plane, buffers_.faces, pair_.margins, bracket_, out_);
  }
  count_stages(posed);
  return proven.has_value();
}

/// [A] section 2, under the bound that the expansion leaves and with the vertices of P that it found.
void PolytopeQuery::solve_by_decomposition(ExpansionResult result) {
  const PosedPair posed(*pair_.a, *pair_.pose_a, *pair_.b, *pair_.pose_b);
  out_.method = Method::decomposition;
  if (!(result.lower > 0)) {
    const VertexPair any = any_vertex(result);
    const ExactNearest nearest = exact_nearest(posed, &any, 1);
    if (nearest.apart) {
      finish_apart(posed, nearest, pair_.margins, out_);
      count_stages(posed);
      return;
    }
  }
  DecompositionBuffers& buffers = buffers_.decomposition;
  buffers.vertices.clear();
  if (within_range()) {
    for (const DifferenceVertex& v : buffers_.surface.vertices) buffers.vertices.push_back({v.a, v.b});
  }
  DecompositionSettings settings;
  if (result.lower > 0) {
    if (settings_.method == Method::decomposition) tighten_upper(result);
    settings.upper = std::ldexp(result.upper, -posed.scale_exponent());
  }
  settings.vertices = buffers.vertices;
  settings.seed = settings_.seed;
  settings.exactly = bracket_ == Bracket::tightest;
  settings.may_enumerate = settings_.method != Method::decomposition;
  const DecompositionDepth found = decomposition_depth(posed, settings, buffers_.overlay, buffers);
  if (found.enumerated) out_.method = Method::overlay;
  out_.statistics.pair_evaluations += found.lines.pair_evaluations;
  out_.statistics.block_bounds += found.lines.block_bounds;
  out_.statistics.lines_scanned += found.lines.lines_scanned;
  finish_nearest(posed, found.nearest);
}

void PolytopeQuery::finish_nearest(const PosedPair& posed, const OverlayDepth& found) {
  out_.statistics.facets_visited += found.facets_visited;
  out_.statistics.exact_signs += found.exact_comparisons;
  if (found.contact == ContactClass::overlapping) {
    finish_overlapping(posed, found.facet, pair_.margins, bracket_, buffers_.faces, out_);
  } else {
    const VertexPair any{0, 0};
    const ExactNearest nearest = exact_nearest(posed, &any, 1);
    if (nearest.apart) {
      finish_apart(posed, nearest, pair_.margins, out_);
    } else if (found.has_facet) {
      finish_touching(posed, normal_of(posed, found.facet), nearest, pair_.margins, out_);
    } else {
      const ExactDepth flat = exact_expanding_polytope(posed, &any, 1, std::numeric_limits<int>::max());
      finish_touching(posed, *flat.normal, nearest, pair_.margins, out_);
    }
  }
  count_stages(posed);
}

VertexPair PolytopeQuery::any_vertex(const ExpansionResult& result) const {
  if (!within_range()) return {0, 0};
  const DifferenceVertex s = difference_.support(result.normal, nullptr);
  return {s.a, s.b};
}

/// The finishing step itself decides one sign exactly.
void PolytopeQuery::count_stages(const PosedPair& posed) {
  out_.statistics.exact_signs += 1 + posed.stages().double_double + posed.stages().exact;
}

}  // namespace pd::detail

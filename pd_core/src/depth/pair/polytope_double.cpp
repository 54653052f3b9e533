#include <algorithm>
#include <cmath>

#include "depth/difference/barycentric.hpp"
#include "depth/distance/gjk.hpp"
#include "depth/expansion/cached_surface.hpp"
#include "depth/pair/polytope_query.hpp"

namespace pd::detail {

namespace {

/// The face of one body that a face of the surface uses: one, two or three of its vertices.
Feature feature(const ConvexPolytope& body, const DifferenceVertex (&corners)[3], std::int32_t DifferenceVertex::*id) {
  const std::int32_t ids[3] = {corners[0].*id, corners[1].*id, corners[2].*id};
  if (ids[0] == ids[1] && ids[0] == ids[2]) return {Feature::Kind::vertex, ids[0], -1};
  if (ids[0] == ids[1] || ids[0] == ids[2] || ids[1] == ids[2]) {
    const std::int32_t other = ids[0] == ids[1] ? ids[2] : ids[1];
    return {Feature::Kind::edge, std::min(ids[0], other), std::max(ids[0], other)};
  }
  const int first = body.first_half_edge(ids[0]);
  for (int h = first; h < first + static_cast<int>(body.neighbours(ids[0]).size()); ++h) {
    const int f = body.half_edge(h).facet;
    if (f < 0) break;
    const auto loop = body.facet_vertices(f);
    if (std::find(loop.begin(), loop.end(), ids[1]) != loop.end() &&
        std::find(loop.begin(), loop.end(), ids[2]) != loop.end()) {
      return {Feature::Kind::facet, f, -1};
    }
  }
  return {Feature::Kind::vertex, ids[0], -1};
}

std::int32_t first_vertex(const ConvexPolytope& body, const Feature& feature) {
  return feature.kind == Feature::Kind::facet ? body.facet_vertices(feature.first)[0] : feature.first;
}

}  // namespace

/// @param lower, upper  of the cores' depth.
void PolytopeQuery::set_depth(double lower, double upper, const Vec3& normal) {
  const double margin = pair_.margins.a + pair_.margins.b;
  out_.contact = ContactClass::overlapping;
  // The sums round once; |translation| exceeds its length by the rounding of three products.
  out_.lower = (lower + margin) * (1 - 0x1p-52);
  out_.upper = (upper + margin) * (1 + 0x1p-50);
  out_.depth = (upper + margin) * (1 + 0x1p-52);
  out_.normal = normal;
  out_.translation = out_.depth * normal;
}

void PolytopeQuery::fill_overlapping(const ExpansionResult& result) {
  set_depth(result.lower, result.upper, result.normal);
  DifferenceVertex corners[3];
  double weights[3];
  face_below_origin(result.face, result.normal, corners, weights);
  fill_overlapping(corners, weights);
}

/// Witnesses and features; depth and normal are set.
void PolytopeQuery::fill_overlapping(const DifferenceVertex (&corners)[3], const double (&weights)[3]) {
  fill_witnesses(corners, weights, 3);
  out_.witness_b = out_.witness_a + out_.translation;
  out_.feature_a = feature(*pair_.a, corners, &DifferenceVertex::a);
  out_.feature_b = feature(*pair_.b, corners, &DifferenceVertex::b);
  pair_features();
}

void PolytopeQuery::corners_of(int f, DifferenceVertex (&corners)[3]) const {
  for (int i = 0; i < 3; ++i) corners[i] = buffers_.surface.vertices[buffers_.surface.face(f).v[i]];
}

/// Coplanar faces share a facet of P: steps from f across the edge that the projection lies beyond, while the
/// neighbour is as near, until the projection lies inside. Gives the last face's corners and where it lies on them.
void PolytopeQuery::face_below_origin(int f, const Vec3& normal, DifferenceVertex (&corners)[3],
                                      double (&weights)[3]) const {
  const Surface& surface = buffers_.surface;
  const double key = std::max(0.0, surface.key(f));
  for (int step = 0; step < surface.size(); ++step) {
    corners_of(f, corners);
    project_origin(corners, normal, weights);
    const int least = static_cast<int>(std::min_element(weights, weights + 3) - weights);
    if (weights[least] >= 0) return;
    // weights[i] belongs to vertex i, whose opposite edge runs from vertex i + 1.
    const int next = surface.face(f).adj[(least + 1) % 3] >> 2;
    const double level = std::sqrt(key) + 64 * 0x1p-53 * difference_.reach();
    if (std::sqrt(std::max(0.0, surface.key(next))) > level) return;
    f = next;
  }
}

void PolytopeQuery::fill_witnesses(const DifferenceVertex* corners, const double* weights, int count) {
  Vec3 a = Vec3::Zero();
  Vec3 b = Vec3::Zero();
  double total = 0;
  for (int i = 0; i < count; ++i) {
    const double w = std::max(0.0, weights[i]);
    a += w * pair_.a->vertex(corners[i].a);
    b += w * pair_.b->vertex(corners[i].b);
    total += w;
  }
  const double share = 1 / total;
  out_.witness_a = pair_.pose_a->apply(share * a) - pair_.margins.a * out_.normal;
  out_.witness_b = pair_.pose_b->apply(share * b) + pair_.margins.b * out_.normal;
}

/// A facet's partner is a vertex, also where the two bodies' facets are parallel.
void PolytopeQuery::pair_features() {
  if (out_.feature_b.kind == Feature::Kind::facet && out_.feature_a.kind != Feature::Kind::vertex) {
    out_.feature_a = {Feature::Kind::vertex, first_vertex(*pair_.a, out_.feature_a), -1};
  } else if (out_.feature_a.kind == Feature::Kind::facet && out_.feature_b.kind != Feature::Kind::vertex) {
    out_.feature_b = {Feature::Kind::vertex, first_vertex(*pair_.b, out_.feature_b), -1};
  }
}

/// Between the bounds that the expansion leaves. False when doubles do not narrow the bracket enough (do not prove the
/// facet, where the tightest one is asked for).
bool PolytopeQuery::solve_among_ties(const ExpansionResult& result) {
  const TiedFacets found =
      nearest_tied_facet(*pair_.a, *pair_.pose_a, *pair_.b, *pair_.pose_b, difference_, buffers_.surface,
                         {result.lower, result.upper, kCertifiedWidth}, buffers_.stack, buffers_.tied_facets);
  out_.statistics.support_calls += found.support_calls;
  out_.statistics.facets_visited += found.facets;
  out_.statistics.pair_evaluations += found.pairs;
  out_.method = Method::decomposition;
  if (bracket_ == Bracket::tightest) return prove_tied(found);
  if (found.certified) fill_tied(found);
  return found.certified;
}

void PolytopeQuery::fill_tied(const TiedFacets& found) {
  set_depth(found.lower, found.upper, found.normal);
  if (found.kind == TiedFacetsBuffers::Kind::edges) {
    const auto [a, b] = std::pair(found.edge_a, found.edge_b);
    const double s = found.along_a, t = found.along_b;
    const DifferenceVertex corners[4] = {difference_.vertex(a[0], b[0]), difference_.vertex(a[1], b[0]),
                                         difference_.vertex(a[0], b[1]), difference_.vertex(a[1], b[1])};
    const double weights[4] = {(1 - s) * (1 - t), s * (1 - t), (1 - s) * t, s * t};
    fill_witnesses(corners, weights, 4);
    out_.witness_b = out_.witness_a + out_.translation;
    out_.feature_a = {Feature::Kind::edge, std::min(a[0], a[1]), std::max(a[0], a[1])};
    out_.feature_b = {Feature::Kind::edge, std::min(b[0], b[1]), std::max(b[0], b[1])};
    return;
  }
  const bool of_a = found.kind == TiedFacetsBuffers::Kind::facet_of_a;
  const Feature facet{Feature::Kind::facet, found.facet, -1};
  const Feature vertex{Feature::Kind::vertex, found.vertex, -1};
  out_.feature_a = of_a ? facet : vertex;
  out_.feature_b = of_a ? vertex : facet;
  if (of_a) {
    out_.witness_b = pair_.pose_b->apply(pair_.b->vertex(found.vertex)) + pair_.margins.b * out_.normal;
    out_.witness_a = out_.witness_b - out_.translation;
  } else {
    out_.witness_a = pair_.pose_a->apply(pair_.a->vertex(found.vertex)) - pair_.margins.a * out_.normal;
    out_.witness_b = out_.witness_a + out_.translation;
  }
}

/// False when doubles do not narrow the bracket enough or cannot tell the class.
bool PolytopeQuery::fill_separated(const ExpansionResult& result) {
  const DifferenceVertex first = difference_.support(result.normal, nullptr);
  return fill_separated({&first, 1});
}

/// The same from vertices of P that may be near the origin.
bool PolytopeQuery::fill_separated(std::span<const DifferenceVertex> start) {
  const double margin = pair_.margins.a + pair_.margins.b;
  // What is left after the margins may be far smaller than the cores' distance: no relative error of that would do.
  const double relative = margin > 0 ? 0.0 : settings_.delta;
  const NearestResult nearest =
      nearest_point(difference_, start, relative, kCertifiedWidth, buffers_.stack, out_.statistics.support_calls);
  for (int i = 0; i < nearest.count; ++i) start_[i] = {nearest.simplex[i].a, nearest.simplex[i].b};
  start_count_ = nearest.count;
  if (!nearest.certified) return false;
  out_.normal = nearest.normal;
  const double round = 4 * 0x1p-53 * (nearest.upper + margin);
  if (margin > 0 && nearest.lower - margin <= round && nearest.upper - margin >= -round) return false;
  remember_apart(std::span(start_).first(static_cast<std::size_t>(start_count_)));
  fill_witnesses(nearest.simplex, nearest.weights, nearest.count);
  DifferenceVertex corners[3];
  for (int i = 0; i < 3; ++i) corners[i] = nearest.simplex[std::min(i, nearest.count - 1)];
  out_.feature_a = feature(*pair_.a, corners, &DifferenceVertex::a);
  out_.feature_b = feature(*pair_.b, corners, &DifferenceVertex::b);
  pair_features();
  if (nearest.lower > margin) {
    out_.contact = ContactClass::separated;
    out_.distance_lower = nearest.lower - margin - round;
    out_.distance_upper = nearest.upper - margin + round;
    out_.distance = std::clamp((out_.witness_a - out_.witness_b).norm(), out_.distance_lower, out_.distance_upper);
  } else {
    out_.contact = ContactClass::overlapping;
    out_.lower = margin - nearest.upper - round;
    out_.depth = margin - nearest.lower + round;
    out_.upper = out_.depth * (1 + 0x1p-50);
    out_.translation = out_.depth * out_.normal;
    out_.witness_b = out_.witness_a + out_.translation;
  }
  return true;
}

}  // namespace pd::detail

#include "depth/pair/double_answer.hpp"

#include <algorithm>
#include <cmath>

#include "numeric/unit_roundoff.hpp"

namespace pd::detail {

namespace {

constexpr double kLeastWideContact = 1e-6;

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

void set_depth(const PolytopePair& pair, double lower, double upper, const Vec3& normal, PenetrationDepth& out) {
  const double margin = pair.margins.both();
  out.contact = ContactClass::overlapping;
  // The sums round once; |translation| exceeds its length by the rounding of three products.
  out.lower = (lower + margin) * (1 - 0x1p-52);
  out.upper = (upper + margin) * (1 + 0x1p-50);
  out.depth = (upper + margin) * (1 + 0x1p-52);
  out.normal = normal;
  out.translation = out.depth * normal;
}

void set_signed_distance(double margin, double core_lower, double core_upper, PenetrationDepth& out) {
  // The difference and the sum round once each.
  const double round = 4 * kUnitRoundoff * (std::max(std::abs(core_lower), std::abs(core_upper)) + margin);
  const double lower = core_lower - margin - round;
  const double upper = core_upper - margin + round;
  if (lower > 0 || (margin == 0 && core_lower > 0)) {
    out.contact = ContactClass::separated;
    out.distance_lower = lower;
    out.distance_upper = upper;
    out.distance = std::clamp((out.witness_a - out.witness_b).norm(), out.distance_lower, out.distance_upper);
  } else if (upper < 0) {
    out.contact = ContactClass::overlapping;
    out.lower = -upper;
    out.depth = -lower;
    out.upper = out.depth * (1 + 0x1p-50);
    out.translation = out.depth * out.normal;
    out.witness_b = out.witness_a + out.translation;
  } else {
    out.contact = ContactClass::touching;
    out.upper = -lower * (1 + 0x1p-50);
    out.distance_upper = upper;
  }
}

void keep_wide_contact(double size, PenetrationDepth& out) {
  if (out.bracket_reached || out.contact != ContactClass::touching || out.distance_upper > out.upper) return;
  if (!(out.upper > kLeastWideContact * size)) return;
  out.contact = ContactClass::overlapping;
  out.depth = out.upper * (1 - 0x1p-50);
  out.distance_upper = 0;
  out.translation = out.depth * out.normal;
  out.witness_b = out.witness_a + out.translation;
}

void set_witnesses(const PolytopePair& pair, const DifferenceVertex* corners, const double* weights, int count,
                   PenetrationDepth& out) {
  Vec3 a = Vec3::Zero();
  Vec3 b = Vec3::Zero();
  double total = 0;
  for (int i = 0; i < count; ++i) {
    const double w = std::max(0.0, weights[i]);
    a += w * pair.a->vertex(corners[i].a);
    b += w * pair.b->vertex(corners[i].b);
    total += w;
  }
  const double share = 1 / total;
  out.witness_a = pair.pose_a->apply(share * a) - pair.margins.a * out.normal;
  out.witness_b = pair.pose_b->apply(share * b) + pair.margins.b * out.normal;
}

void set_witnesses_of_depth(const PolytopePair& pair, const DifferenceVertex* corners, const double* weights, int count,
                            PenetrationDepth& out) {
  Vec3 a = Vec3::Zero();
  double total = 0;
  for (int i = 0; i < count; ++i) {
    const double w = std::max(0.0, weights[i]);
    a += w * pair.a->vertex(corners[i].a);
    total += w;
  }
  out.witness_a = pair.pose_a->apply(1 / total * a) - pair.margins.a * out.normal;
  out.witness_b = out.witness_a + out.translation;
}

void set_features(const PolytopePair& pair, const DifferenceVertex (&corners)[3], PenetrationDepth& out) {
  out.feature_a = feature(*pair.a, corners, &DifferenceVertex::a);
  out.feature_b = feature(*pair.b, corners, &DifferenceVertex::b);
  if (out.feature_b.kind == Feature::Kind::facet && out.feature_a.kind != Feature::Kind::vertex) {
    out.feature_a = {Feature::Kind::vertex, first_vertex(*pair.a, out.feature_a), -1};
  } else if (out.feature_a.kind == Feature::Kind::facet && out.feature_b.kind != Feature::Kind::vertex) {
    out.feature_b = {Feature::Kind::vertex, first_vertex(*pair.b, out.feature_b), -1};
  }
}

void set_contact(const PolytopePair& pair, const DifferenceVertex (&corners)[3], const double (&weights)[3],
                 PenetrationDepth& out) {
  set_witnesses_of_depth(pair, corners, weights, 3, out);
  set_features(pair, corners, out);
}

}  // namespace pd::detail

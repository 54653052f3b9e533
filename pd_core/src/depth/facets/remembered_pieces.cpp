#include "depth/facets/remembered_pieces.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <tuple>

#include "depth/facets/gauss_foot.hpp"
#include "numeric/lanes.hpp"
#include "numeric/unit_roundoff.hpp"
#include "shape/small_gauss_map.hpp"

namespace pd::detail {

namespace {

/// In units of the reach; measured.
constexpr double kBand = 0x1p-4;
/// Movements and planes err by less than this, in units of the reach.
constexpr double kSlack = 0x1p-40;
/// The sum of a matrix' squares and its determinant are this close to 3 and to 1: then, since of numbers with a given
/// product equal ones have the least sum of squares, no singular value is less than 0.9 (0.81 + 2 * 0.999 / 0.9 is
/// above 3.001). An inner ball turned by it holds one of this share of its radius.
constexpr double kNoRotation = 1e-3;
constexpr double kTurnedRadius = 0.9;

constexpr int kVertices = WarmPieces::kMostVertices;
static_assert(kVertices == 2 * kLanes && kVertices == kVertexBlock);

/// The square of how much farther than vertex `base` any other has moved.
PD_INLINE double spread_of(const VertexArrays& now, const double (&then)[3][kVertices], int base) {
  const double* const by_axis[3] = {now.x, now.y, now.z};
  Lanes low_squared = {}, high_squared = {};
  for (int i = 0; i < 3; ++i) {
    const double moved = by_axis[i][base] - then[i][base];
    Lanes low, high, low_then, high_then;
    load(low, by_axis[i]);
    load(high, by_axis[i] + kLanes);
    load(low_then, then[i]);
    load(high_then, then[i] + kLanes);
    low = (low - low_then) - moved;
    high = (high - high_then) - moved;
    low_squared += low * low;
    high_squared += high * high;
  }
  return greatest(high_squared > low_squared ? high_squared : low_squared);
}

struct Spreads {
  double a, b;
};

PD_CLONES Spreads spreads_of(const WarmPieces& then, const VertexArrays& a, const VertexArrays& b) {
  return {spread_of(a, then.posed_a, then.base.a), spread_of(b, then.posed_b, then.base.b)};
}

/// No vertex of P has moved farther, up to rounding.
double movement(const WarmPieces& then, const PolytopeDifference& now) {
  const VertexArrays &a = now.posed_a(), &b = now.posed_b();
  const double* const by_axis_a[3] = {a.x, a.y, a.z};
  const double* const by_axis_b[3] = {b.x, b.y, b.z};
  Vec3 way = now.offset() - then.offset;
  for (int i = 0; i < 3; ++i) {
    way[i] += (by_axis_a[i][then.base.a] - then.posed_a[i][then.base.a]) +
              (by_axis_b[i][then.base.b] - then.posed_b[i][then.base.b]);
  }
  const Spreads spread = spreads_of(then, a, b);
  return way.norm() + std::sqrt(spread.a) + std::sqrt(spread.b);
}

void keep(const VertexArrays& from, double (&to)[3][kVertices]) {
  const double* const by_axis[3] = {from.x, from.y, from.z};
  for (int i = 0; i < 3; ++i) std::memcpy(to[i], by_axis[i], sizeof(to[i]));
}

/// Of a ball round P's centre that it holds, where the poses are rotations.
double inner_radius(const PolytopeDifference& difference) {
  return kTurnedRadius * (small_gauss_map(difference.a()).inner_radius + small_gauss_map(difference.b()).inner_radius);
}

/// A total order: the same pieces are kept by every library.
bool is_nearer(const NearGaussPieces::Measured& x, const NearGaussPieces::Measured& y) {
  const GaussPiece &p = x.piece, &q = y.piece;
  return std::tie(x.key, p.facet_a, p.facet_b, p.a[0], p.a[1], p.b[0], p.b[1]) <
         std::tie(y.key, q.facet_a, q.facet_b, q.a[0], q.a[1], q.b[0], q.b[1]);
}

bool is_rotation(const Mat3& m) {
  return std::abs(m.squaredNorm() - 3) < kNoRotation && std::abs(m.determinant() - 1) < kNoRotation;
}

GaussPiece piece_of(const WarmPiece& p) { return {p.facet_a, p.facet_b, {p.a[0], p.a[1]}, {p.b[0], p.b[1]}}; }

/// A remembered facet at the present poses.
struct PlaneNow {
  Vec3 normal;      ///< unit, outward
  double distance;  ///< of its lowest corner
  double from_inner;
};

/// Distances are NaN where there is no normal.
PlaneNow plane_of(const GaussPiece& piece, const TurnedNormals& turned, const PolytopeDifference& difference,
                  const Vec3& inner) {
  const Vec3 normal = normal_of_piece(piece, turned, difference);
  const Vec3 corner = difference.vertex(piece.a[0], piece.b[0]).x;
  const double share = 1 / normal.norm();
  double height = normal.dot(corner);
  // The other corners, which rounding moves off the plane.
  if (piece.is_of_edges()) {
    height += std::min(0.0, normal.dot(difference.vertex(piece.a[0], piece.b[1]).x - corner)) +
              std::min(0.0, normal.dot(difference.vertex(piece.a[1], piece.b[0]).x - corner));
  }
  return {share * normal, share * height, share * (height - normal.dot(inner))};
}

}  // namespace

double remembered_band(const PolytopeDifference& difference) {
  // Bodies that have moved by more than the inner ball's radius are looked at anew.
  return std::min(kBand * difference.reach(), 2 * inner_radius(difference));
}

bool remember_pieces(const GaussSatDepth& found, NearGaussPieces& near, const PolytopeDifference& difference,
                     WarmPieces& out) {
  if (!near.complete || near.open || near.count == 0) return false;
  if (!is_rotation(difference.rotation_a()) || !is_rotation(difference.rotation_b())) return false;
  if (!out.a || !out.a->same_storage(difference.a())) out.a = difference.a();
  if (!out.b || !out.b->same_storage(difference.b())) out.b = difference.b();
  keep(difference.posed_a(), out.posed_a);
  keep(difference.posed_b(), out.posed_b);
  out.offset = difference.offset();
  const double reach = difference.reach();
  out.largest = found.largest;
  out.count = std::min(near.count, WarmPieces::kMostPieces);
  double beyond = near.radius;
  if (near.count > out.count) {
    std::sort(near.pieces, near.pieces + near.count, is_nearer);
    beyond = std::sqrt(near.pieces[out.count].key);
  }
  out.beyond = beyond - kSlack * reach;
  out.nearest = 0;
  for (int i = 0; i < out.count; ++i) {
    const auto& [key, from] = near.pieces[i];
    out.pieces[i] = {std::sqrt(key) - kGaussLowerError * reach,
                     from.facet_a,
                     from.facet_b,
                     {from.a[0], from.a[1]},
                     {from.b[0], from.b[1]}};
    if (out.pieces[i].distance < out.pieces[out.nearest].distance) out.nearest = i;
  }
  const WarmPiece& nearest = out.pieces[out.nearest];
  out.base = {nearest.a[0], nearest.b[0]};
  // Deep inside, or else the origin itself.
  const double clearance = inner_radius(difference);
  out.inner = clearance > nearest.distance ? difference.centre() : Vec3::Zero();
  out.clearance = std::max(clearance, nearest.distance) - kSlack * reach;
  return out.clearance > 0;
}

NearFacets certify_remembered_pieces(const WarmPieces& then, const Pose& pose_a, const Pose& pose_b,
                                     const PolytopeDifference& difference, const BracketWidth& width, int& looked_at) {
  NearFacets out;
  const double reach = difference.reach();
  const double slack = kSlack * reach;
  const double moved = movement(then, difference) + slack;
  if (!(moved < then.clearance)) return out;

  const TurnedNormals turned(pose_a, pose_b);
  int winner = then.nearest;
  PlaneNow best = plane_of(piece_of(then.pieces[winner]), turned, difference, then.inner);
  ++looked_at;
  if (!(then.beyond - moved >= best.distance && best.distance > slack && best.from_inner > slack)) return out;
  for (int i = 0; i < then.count; ++i) {
    if (i == then.nearest || then.pieces[i].distance - moved >= best.distance) continue;
    const PlaneNow next = plane_of(piece_of(then.pieces[i]), turned, difference, then.inner);
    ++looked_at;
    if (!(next.distance > slack && next.from_inner > slack)) return out;
    if (next.distance >= best.distance) continue;
    best = next;
    winner = i;
  }

  const DifferenceVertex s = difference.support(best.normal, nullptr);
  const double height = s.x.dot(best.normal);
  out.normal = best.normal;
  out.upper = height + kGaussUpperError * reach;
  out.lower = best.distance - kGaussLowerError * reach;
  if (!(out.lower > 0 && out.upper - out.lower <= width.limit(then.largest - moved))) return out;
  name_piece(piece_of(then.pieces[winner]), s, out);
  out.certified = foot_inside(difference, s, height, out).has_value();
  return out;
}

}  // namespace pd::detail

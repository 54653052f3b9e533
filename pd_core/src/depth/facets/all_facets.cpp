#include "depth/facets/all_facets.hpp"

#include <algorithm>
#include <cmath>

#include "depth/facets/all_facets_kernels.hpp"
#include "depth/facets/foot_in_piece.hpp"
#include "depth/facets/small_piece.hpp"
#include "numeric/unit_roundoff.hpp"
#include "shape/normal_matrix.hpp"
#include "shape/small_gauss_map.hpp"

namespace pd::detail {

namespace {

/// Of a body's radius: a height in single precision errs by 2^-24 of it for a coordinate of the vertex, one of the
/// normal, a product and two sums; the rise of an edge by twice that and its own rounding.
constexpr double kRiseError = 0x1p-20;
/// Of the reach, with the normal's length.
constexpr double kHeightError = 0x1p-19;

/// Of the reach: between two hulls of 32 vertices both ways take as long.
constexpr double kCloseCentres = 0.25;

AllFacetsBody body_of(const ConvexPolytope& polytope, const VertexArrays& posed, const Mat3& turn) {
  AllFacetsBody body{polytope.storage(), posed, {}};
  for (int i = 0; i < 9; ++i) body.turn[i] = turn(i / 3, i % 3);
  return body;
}

bool is_compact(const ConvexPolytope& p) {
  return p.affine_dimension() == 3 && p.num_vertices() <= AllFacetsBody::kMostVertices &&
         p.num_facets() <= AllFacetsBody::kMostFacets;
}

/// Of the product of a body's squared semi-axes to that of a ball of their sum: an ellipsoid of semi-axes 1, 1/2 and
/// 1/4 has .19, a box of these extents, too, one of 1, 1 and 1/8 .05.
constexpr double kLeastRoundness = 0.1;

/// Neither long or flat, nor so far from its frame's origin that its size is lost in the reach.
bool is_round(const ConvexPolytope& p) {
  const Mat3& moments = p.storage().second_moments;
  const double mean = moments.trace() / 3;
  return moments.determinant() > kLeastRoundness * mean * mean * mean && 2 * p.centre().norm() < p.radius();
}

/// Outward, of any length.
Vec3 normal_of(const NearestOfAllFacets& found, const PolytopeDifference& difference, const Mat3& turn_a,
               const Mat3& turn_b) {
  if (found.facet_a >= 0) return turn_a * difference.a().facet_normal(found.facet_a);
  if (found.facet_b >= 0) return turn_b * difference.b().facet_normal(found.facet_b);
  const auto edge = [](const VertexArrays& v, int from, int to) {
    return Vec3(v.x[to] - v.x[from], v.y[to] - v.y[from], v.z[to] - v.z[from]);
  };
  return found.sign * edge(difference.posed_b(), found.edge_b[0], found.edge_b[1])
                          .cross(edge(difference.posed_a(), found.edge_a[1], found.edge_a[0]));
}

void name(const NearestOfAllFacets& found, const DifferenceVertex& s, NearFacets& out) {
  if (found.edge_a[0] >= 0) {
    out.kind = NearFacetsBuffers::Kind::edges;
    std::copy_n(found.edge_a, 2, out.edge_a);
    std::copy_n(found.edge_b, 2, out.edge_b);
    return;
  }
  const bool of_a = found.facet_a >= 0;
  out.kind = of_a ? NearFacetsBuffers::Kind::facet_of_a : NearFacetsBuffers::Kind::facet_of_b;
  out.facet = of_a ? found.facet_a : found.facet_b;
  out.vertex = of_a ? s.b : s.a;
}

}  // namespace

bool all_facets_apply(const ConvexPolytope& a, const ConvexPolytope& b) {
  return is_compact(a) && is_compact(b) && !(has_small_gauss_map(a) && has_small_gauss_map(b));
}

bool all_facets_pay(const PolytopeDifference& difference) {
  if (!is_round(difference.a()) || !is_round(difference.b())) return false;
  const double close = kCloseCentres * difference.reach();
  return difference.centre().squaredNorm() < close * close;
}

NearFacets nearest_of_all_facets(const Pose& pose_a, const Pose& pose_b, const PolytopeDifference& difference,
                                 const BracketWidth& width) {
  NearFacets out;
  const Mat3 turn_a = -normal_matrix(pose_a), turn_b = normal_matrix(pose_b);
  const Vec3& t = difference.offset();
  const double reach = difference.reach();
  const NearestOfAllFacets found =
      nearest_of_all_facets(body_of(difference.a(), difference.posed_a(), turn_a),
                            body_of(difference.b(), difference.posed_b(), turn_b), {t.x(), t.y(), t.z()},
                            {kHeightError * reach, static_cast<float>(kRiseError * difference.a().radius()),
                             static_cast<float>(kRiseError * difference.b().radius())});
  out.facets = found.pieces;
  if (found.outcome != NearestOfAllFacets::Outcome::found || !(found.key > 0)) return out;
  const Vec3 normal = normal_of(found, difference, turn_a, turn_b);
  const double squared = normal.squaredNorm();
  if (!(squared > 0)) return out;
  out.normal = normal / std::sqrt(squared);
  const DifferenceVertex s = difference.support(out.normal, nullptr);
  ++out.support_calls;
  const double height = s.x.dot(out.normal);
  out.upper = height + kSmallPieceUpperError * reach;
  out.lower = std::sqrt(found.key) - kSmallPieceLowerError * reach;
  name(found, s, out);
  if (!(out.lower > 0 && out.upper - out.lower <= width.limit(found.largest))) return out;
  if (!holds_foot(difference, s, height, out)) return out;
  if (found.others_key > 0) out.beyond = std::sqrt(found.others_key) - kSmallPieceLowerError * reach;
  out.certified = true;
  return out;
}

}  // namespace pd::detail

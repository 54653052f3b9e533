#include "depth/facets/gauss_sat.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "depth/facets/gauss_foot.hpp"
#include "numeric/unit_roundoff.hpp"
#include "shape/normal_matrix.hpp"
#include "shape/small_gauss_map.hpp"

namespace pd::detail {

namespace {

/// Of a body's radius: a height in single precision errs by 2^-24 of it for a coordinate of the vertex, one of the
/// normal, a product and two sums; the rise of an edge by twice that and its own rounding.
constexpr double kRiseError = 0x1p-20;
/// Of a body's radius, in double precision: an edge of twice its length along a normal that errs by 33u, vertices that
/// err by 7u each, products and sums by 6u.
constexpr double kFineRiseError = 0x1p-46;
/// Of the reach, with the normal's length.
constexpr double kHeightError = 0x1p-19;
/// Of the reach: the rounding of a sliver's bound.
constexpr double kRoom = 4 * kUnitRoundoff;

/// A share of the reach. Facets of P and supports err by less.
constexpr double kBoundError = 0x1p-45;

/// A surface takes the longer the closer the bodies' centres are, the kernel the longer the more vertices they have.
/// Measured: both take as long where the squared distance times the number of vertices is so often the sum of the
/// bodies' second moments.
constexpr double kCloseCentres = 75;
/// Of the product of a body's squared semi-axes to that of a ball of their sum: an ellipsoid of semi-axes 1, 1/2 and
/// 1/4 has .19, a box of these extents, too, one of 1, 1 and 1/8 .05.
constexpr double kLeastRoundness = 0.08;

bool has_few_facets(const ConvexPolytope& p) {
  return p.affine_dimension() == 3 && p.num_vertices() <= kMostGaussVertices && p.num_facets() <= kMostGaussFacets;
}

/// Neither long nor flat.
bool is_round(const ConvexPolytope& p) {
  const Mat3& moments = p.storage().second_moments;
  const double mean = moments.trace() / 3;
  return moments.determinant() > kLeastRoundness * mean * mean * mean;
}

GaussSatBody body_of(const ConvexPolytope& polytope, const VertexArrays& posed, const Mat3& turn, double growth) {
  GaussSatBody body{polytope.storage(), posed, {}, growth};
  for (int i = 0; i < 9; ++i) body.turn[i] = turn(i / 3, i % 3);
  return body;
}

/// The depth is no more than how far P reaches away from its centre. Small bodies keep few edges without that.
double upper_bound(const PolytopeDifference& difference) {
  if (has_small_gauss_map(difference.a()) && has_small_gauss_map(difference.b())) {
    return std::numeric_limits<double>::infinity();
  }
  const Vec3 back = -difference.centre();
  const double length = back.norm();
  if (!(length > 0)) return std::numeric_limits<double>::infinity();
  return difference.support(back, nullptr).x.dot(back) / length + kBoundError * difference.reach();
}

/// A query once its kernel has answered.
class Certificate {
 public:
  Certificate(const TurnedNormals& turned, const PolytopeDifference& difference, NearFacets& winner, double inside)
      : turned_(turned), difference_(difference), winner_(winner), inside_(inside) {}

  /// True if a sliver lies no nearer than the winner whose foot lies inside of it.
  /// @param height  of the winner
  [[nodiscard]] bool is_no_nearer(const ThinPair& pair, double height) const {
    const double sine = std::min({sine_of_arc(difference_.a(), turned_.of_a, pair.facets_a),
                                  sine_of_arc(difference_.b(), turned_.of_b, pair.facets_b), sine_of_own(pair)});
    // tan(t / 2) <= sin t, up to t = 60 degrees.
    return sine <= 0.5 && sine * height <= inside_ - foot_rounding(difference_);
  }

 private:
  static constexpr double kFar = 1;

  /// At least the sine of the angle between the winner's normal and any direction of an edge's arc.
  [[nodiscard]] double sine_of_arc(const ConvexPolytope& body, const Mat3& turn,
                                   const std::uint8_t (&facets)[2]) const {
    double sine = 0;
    for (const int f : facets) {
      const Vec3 n = turn * body.facet_normal(f);
      if (!(n.dot(winner_.normal) > 0)) return kFar;
      sine = std::max(sine, n.cross(winner_.normal).norm() / n.norm());
    }
    return sine + 0x1p-46;
  }
  /// The same of the product of its edges: each errs by 14u of its body's radius, the product by 4u.
  [[nodiscard]] double sine_of_own(const ThinPair& pair) const {
    if (!pair.oriented) return kFar;
    const Vec3 e = -turned_edge(difference_.posed_a(), pair.piece.a),
               f = turned_edge(difference_.posed_b(), pair.piece.b);
    const Vec3 n = f.cross(e);
    const double length = n.norm();
    const double error =
        16 * kUnitRoundoff * (difference_.a().radius() * f.norm() + difference_.b().radius() * e.norm());
    if (!(n.dot(winner_.normal) > 2 * error)) return kFar;
    return (n.cross(winner_.normal).norm() + 2 * error) / (length - error);
  }

  const TurnedNormals& turned_;
  const PolytopeDifference& difference_;
  const NearFacets& winner_;
  double inside_;
};

}  // namespace

TurnedNormals::TurnedNormals(const Pose& pose_a, const Pose& pose_b)
    : of_a(-normal_matrix(pose_a)), of_b(normal_matrix(pose_b)) {}

Vec3 normal_of_piece(const GaussPiece& piece, const TurnedNormals& turned, const PolytopeDifference& difference) {
  if (piece.facet_a >= 0) return turned.of_a * difference.a().facet_normal(piece.facet_a);
  if (piece.facet_b >= 0) return turned.of_b * difference.b().facet_normal(piece.facet_b);
  return turned_edge(difference.posed_b(), piece.b).cross(-turned_edge(difference.posed_a(), piece.a));
}

void name_piece(const GaussPiece& piece, const DifferenceVertex& s, NearFacets& out) {
  if (piece.is_of_edges()) {
    out.kind = NearFacetsBuffers::Kind::edges;
    std::copy_n(piece.a, 2, out.edge_a);
    std::copy_n(piece.b, 2, out.edge_b);
    return;
  }
  const bool of_a = piece.facet_a >= 0;
  out.kind = of_a ? NearFacetsBuffers::Kind::facet_of_a : NearFacetsBuffers::Kind::facet_of_b;
  out.facet = of_a ? piece.facet_a : piece.facet_b;
  out.vertex = of_a ? s.b : s.a;
}

bool gauss_sat_applies(const ConvexPolytope& a, const ConvexPolytope& b) {
  return has_few_facets(a) && has_few_facets(b);
}

bool gauss_sat_pays(const PolytopeDifference& difference) {
  const ConvexPolytope &a = difference.a(), &b = difference.b();
  if (has_small_gauss_map(a) && has_small_gauss_map(b)) return true;
  if (!is_round(a) || !is_round(b)) return false;
  const double moments = a.storage().second_moments.trace() + b.storage().second_moments.trace();
  return difference.centre().squaredNorm() * (a.num_vertices() + b.num_vertices()) < kCloseCentres * moments;
}

GaussSatDepth gauss_sat_depth(const Pose& pose_a, const Pose& pose_b, const PolytopeDifference& difference,
                              const BracketWidth& width, NearGaussPieces* near) {
  GaussSatDepth out;
  const TurnedNormals turned(pose_a, pose_b);
  const double growth_a = -turned.of_a.col(0).dot(difference.rotation_a().col(0));
  const double growth_b = turned.of_b.col(0).dot(difference.rotation_b().col(0));
  // A host's matrix that is no rotation at all.
  if (!(growth_a > 0.5 && growth_b > 0.5)) return out;
  const Vec3& t = difference.offset();
  const double reach = difference.reach(), radius_a = difference.a().radius(), radius_b = difference.b().radius();
  const GaussSatErrors errors{.reach = reach,
                              .height = kHeightError * reach,
                              .side_a = static_cast<float>(kRiseError * radius_a),
                              .side_b = static_cast<float>(kRiseError * radius_b),
                              .fine_side_a = kFineRiseError * radius_a,
                              .fine_side_b = kFineRiseError * radius_b,
                              .upper = upper_bound(difference),
                              .room = std::max(kRoom * reach, 0.5 * width.length)};
  ThinPairs thin;
  const NearestByGaussMaps found = nearest_by_gauss_maps(
      body_of(difference.a(), difference.posed_a(), turned.of_a, growth_a),
      body_of(difference.b(), difference.posed_b(), turned.of_b, growth_b), {t.x(), t.y(), t.z()}, errors, near, thin);
  NearFacets& nearest = out.nearest;
  nearest.facets = found.pieces;
  if (near != nullptr) {
    near->all_told = near->complete;
    near->beyond = near->complete ? near->radius - kGaussLowerError * reach : 0;
  }
  if (found.outcome == NearestByGaussMaps::Outcome::full) return out;
  const Vec3 normal = normal_of_piece(found.piece, turned, difference);
  const double squared = normal.squaredNorm();
  if (!(squared > 0)) return out;
  nearest.normal = normal / std::sqrt(squared);
  const DifferenceVertex s = difference.support(nearest.normal, nullptr);
  ++nearest.support_calls;
  const double height = s.x.dot(nearest.normal);
  nearest.upper = height + kGaussUpperError * reach;
  name_piece(found.piece, s, nearest);
  out.corner = {s.a, s.b};
  if (nearest.upper < 0) {
    out.status = GaussSatStatus::separated;
    return out;
  }
  if (found.outcome != NearestByGaussMaps::Outcome::found || !(found.key > 0 && found.others_key > 0)) return out;
  const auto inside = foot_inside(difference, s, height, nearest);
  double least = std::sqrt(std::min(found.key, found.others_key)), beyond = std::sqrt(found.others_key);
  const Certificate certificate(turned, difference, nearest, inside.value_or(0));
  for (int i = 0; i < thin.count; ++i) {
    const ThinPair& pair = thin.pairs[i];
    beyond = std::min(beyond, pair.bound);
    if (!(inside && certificate.is_no_nearer(pair, height))) least = std::min(least, pair.bound);
  }
  nearest.lower = least - kGaussLowerError * reach;
  if (!(nearest.lower > 0 && nearest.upper - nearest.lower <= width.limit(reach))) return out;
  if (!inside) {
    const double slack = std::max(foot_rounding(difference), 0.125 * width.length);
    const std::optional<Vec3> meeting = meeting_point(difference, nearest.normal, height, slack);
    if (!meeting) return out;
    const Vec3 on_b = *meeting + difference.offset();
    out.foot = FootPoints{on_b - height * nearest.normal, on_b, 0};
  }
  if (beyond > 0) nearest.beyond = beyond - kGaussLowerError * reach;
  nearest.certified = true;
  out.status = GaussSatStatus::certified;
  return out;
}

}  // namespace pd::detail

#include "depth/facets/small_sat.hpp"

#include <algorithm>
#include <cmath>

#include "depth/facets/flush_faces.hpp"
#include "depth/facets/foot_in_piece.hpp"
#include "depth/facets/small_piece.hpp"
#include "depth/facets/small_sat_kernels.hpp"
#include "numeric/unit_roundoff.hpp"

namespace pd::detail {

namespace {

/// Below this share of a body's radius a sign in single precision may be wrong: an edge's two heights along a facet are
/// rounded, then their difference, by 2^-22 together.
constexpr double kSingleSideError = 0x1p-21;

void row_by_row(const Mat3& m, double (&out)[9]) {
  for (int i = 0; i < 9; ++i) out[i] = m(i / 3, i % 3);
}

SmallPiece piece_of(const SmallSatNearest& found) {
  return {found.facet_a, found.facet_b, found.edge_a, found.edge_b, found.sign};
}

SmallSatDepth solve(const SmallPieces& pieces, const PolytopeDifference& difference, const BracketWidth& width,
                    SmallNearPieces* near) {
  SmallSatDepth out;
  const Mat3 &normals_a = pieces.normals_a(), &normals_b = pieces.normals_b();
  SmallSatBody a{pieces.map_a(), difference.posed_a(), {}, -normals_a.col(0).dot(difference.rotation_a().col(0))};
  SmallSatBody b{pieces.map_b(), difference.posed_b(), {}, normals_b.col(0).dot(difference.rotation_b().col(0))};
  // A host's matrix that is no rotation at all.
  if (!(a.growth > 0.5 && b.growth > 0.5)) return out;
  row_by_row(normals_a, a.normals);
  row_by_row(normals_b, b.normals);
  const Vec3& t = difference.offset();
  const double reach = difference.reach();
  const SmallSatErrors errors{0x1p-20 * reach, static_cast<float>(kSingleSideError * difference.a().radius()),
                              static_cast<float>(kSingleSideError * difference.b().radius())};
  const SmallSatNearest found = nearest_of_small(a, b, {t.x(), t.y(), t.z()}, errors, near);
  out.pieces = a.map.facets + b.map.facets + found.crossings + found.possible;
  const SmallPiece piece = piece_of(found);
  const Vec3 normal = pieces.normal(piece);
  const double squared = normal.squaredNorm();
  if (!(squared > 0)) return out;
  const Vec3 unit = normal / std::sqrt(squared);
  const DifferenceVertex s = difference.support(unit, nullptr);
  const double height = s.x.dot(unit);
  NearFacets& nearest = out.nearest;
  nearest.normal = unit;
  nearest.upper = height + kSmallPieceUpperError * reach;
  pieces.name(piece, s, nearest);
  if (nearest.upper < 0) {
    out.status = SmallSatStatus::separated;
    return out;
  }
  if (!(found.key > 0 && found.possible_key > 0)) return out;
  nearest.lower = std::sqrt(std::min(found.key, found.possible_key)) - kSmallPieceLowerError * reach;
  if (!(nearest.lower > 0 && nearest.upper - nearest.lower <= width.limit(found.largest))) return out;
  if (!holds_foot(difference, s, height, nearest)) {
    if (nearest.kind != NearFacetsBuffers::Kind::edges) out.meeting = meeting_point(difference, unit, height);
    if (!out.meeting) return out;
  }
  const double others = std::min(found.others_key, found.possible_key);
  if (others > 0) nearest.beyond = std::sqrt(others) - kSmallPieceLowerError * reach;
  nearest.certified = true;
  out.largest = found.largest;
  out.status = SmallSatStatus::certified;
  return out;
}

}  // namespace

bool small_sat_applies(const ConvexPolytope& a, const ConvexPolytope& b) {
  return has_small_gauss_map(a) && has_small_gauss_map(b);
}

SmallSatDepth small_sat_depth(const Pose& pose_a, const Pose& pose_b, const PolytopeDifference& difference,
                              const BracketWidth& width, SmallNearPieces* near) {
  return solve(SmallPieces(pose_a, pose_b, difference), difference, width, near);
}

}  // namespace pd::detail

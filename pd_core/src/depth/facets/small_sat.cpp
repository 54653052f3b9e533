#include "depth/facets/small_sat.hpp"

#include <algorithm>
#include <cmath>

#include "depth/facets/small_sat_kernels.hpp"
#include "numeric/unit_roundoff.hpp"
#include "shape/normal_matrix.hpp"

namespace pd::detail {

namespace {

/// A facet's distance errs, in units of the reach, by the turn of its normal (16u and 3u as it is stored, 9u for the
/// cofactors and 5u for their product), by the vertices and products of its height (12u) and by a root and a quotient
/// (3u). A parallelogram's lowest corner errs by 22u: its point by 10.5u, products and sums by 8u, root and quotient.
constexpr double kLowerError = 50 * kUnitRoundoff;
/// h_P(n) exceeds <s, n> of the support s by at most this: 10.5u for a point, 6u for scans that compare products,
/// 3u for the product, 2u for the length of n.
constexpr double kUpperError = 24 * kUnitRoundoff;
/// Below this share of a body's radius a sign in single precision may be wrong: an edge's two heights along a facet are
/// rounded, then their difference, by 2^-22 together.
constexpr double kSingleSideError = 0x1p-21;
/// A point beyond a piece's border by no more than this, in units of the reach, is rounding.
constexpr double kInside = 64 * kUnitRoundoff;

class SmallPair {
 public:
  SmallPair(const Pose& pose_a, const Pose& pose_b, const PolytopeDifference& difference)
      : difference_(difference),
        map_a_(small_gauss_map(difference.a())),
        map_b_(small_gauss_map(difference.b())),
        normals_a_(-normal_matrix(pose_a)),
        normals_b_(normal_matrix(pose_b)) {}

  SmallSatDepth solve(const BracketWidth& width) {
    SmallSatDepth out;
    SmallSatBody a{map_a_, difference_.posed_a(), {}, -normals_a_.col(0).dot(difference_.rotation_a().col(0))};
    SmallSatBody b{map_b_, difference_.posed_b(), {}, normals_b_.col(0).dot(difference_.rotation_b().col(0))};
    // A host's matrix that is no rotation at all.
    if (!(a.growth > 0.5 && b.growth > 0.5)) return out;
    row_by_row(normals_a_, a.normals);
    row_by_row(normals_b_, b.normals);
    const Vec3& t = difference_.offset();
    const SmallSatErrors errors{0x1p-20 * difference_.reach(),
                                static_cast<float>(kSingleSideError * difference_.a().radius()),
                                static_cast<float>(kSingleSideError * difference_.b().radius())};
    const SmallSatNearest found = nearest_of_small(a, b, {t.x(), t.y(), t.z()}, errors);
    out.pieces = map_a_.facets + map_b_.facets + found.crossings + found.possible;
    const double reach = difference_.reach();
    const Vec3 normal = normal_of(found);
    const double squared = normal.squaredNorm();
    if (!(squared > 0)) return out;
    const Vec3 unit = normal / std::sqrt(squared);
    const DifferenceVertex s = difference_.support(unit, nullptr);
    const double height = s.x.dot(unit);
    NearFacets& nearest = out.nearest;
    nearest.normal = unit;
    nearest.upper = height + kUpperError * reach;
    name_piece(found, s, nearest);
    if (nearest.upper < 0) {
      out.status = SmallSatStatus::separated;
      return out;
    }
    if (!(found.key > 0 && found.possible_key > 0)) return out;
    nearest.lower = std::sqrt(std::min(found.key, found.possible_key)) - kLowerError * reach;
    if (!(nearest.lower > 0 && nearest.upper - nearest.lower <= width.limit(found.largest))) return out;
    if (!(found.edge_a >= 0 ? below_edges(found, height, nearest) : below_facet(s, height, nearest))) return out;
    const double others = std::min(found.others_key, found.possible_key);
    if (others > 0) nearest.beyond = std::sqrt(others) - kLowerError * reach;
    nearest.certified = true;
    out.status = SmallSatStatus::certified;
    return out;
  }

 private:
  static void row_by_row(const Mat3& m, double (&out)[9]) {
    for (int i = 0; i < 9; ++i) out[i] = m(i / 3, i % 3);
  }

  /// Outward, of any length.
  [[nodiscard]] Vec3 normal_of(const SmallSatNearest& found) const {
    if (found.facet_a >= 0) return normals_a_ * difference_.a().facet_normal(found.facet_a);
    if (found.facet_b >= 0) return normals_b_ * difference_.b().facet_normal(found.facet_b);
    return found.sign * edge_b(found.edge_b).cross(edge_a(found.edge_a));
  }
  /// An edge of A as a vector, and one of B.
  [[nodiscard]] Vec3 edge_a(int edge) const {
    return point(difference_.posed_a(), map_a_.from[edge]) - point(difference_.posed_a(), map_a_.to[edge]);
  }
  [[nodiscard]] Vec3 edge_b(int edge) const {
    return point(difference_.posed_b(), map_b_.to[edge]) - point(difference_.posed_b(), map_b_.from[edge]);
  }
  [[nodiscard]] static Vec3 point(const VertexArrays& v, int i) { return {v.x[i], v.y[i], v.z[i]}; }

  /// The features of the bodies that make the facet of P, s being its support.
  void name_piece(const SmallSatNearest& found, const DifferenceVertex& s, NearFacets& out) const {
    if (found.edge_a >= 0) {
      const int a = found.edge_a, b = found.edge_b;
      out.kind = NearFacetsBuffers::Kind::edges;
      out.edge_a[0] = map_a_.from[a];
      out.edge_a[1] = map_a_.to[a];
      out.edge_b[0] = map_b_.from[b];
      out.edge_b[1] = map_b_.to[b];
      return;
    }
    const bool of_a = found.facet_a >= 0;
    out.kind = of_a ? NearFacetsBuffers::Kind::facet_of_a : NearFacetsBuffers::Kind::facet_of_b;
    out.facet = of_a ? found.facet_a : found.facet_b;
    out.vertex = of_a ? s.b : s.a;
  }

  /// Whether the parallelogram holds the point below the origin, and where.
  bool below_edges(const SmallSatNearest& found, double height, NearFacets& out) const {
    const int a = found.edge_a, b = found.edge_b;
    const Vec3 e = edge_a(a), f = edge_b(b);
    // corner - s e + t f = the projection
    const Vec3 gap = difference_.vertex(map_a_.from[a], map_b_.from[b]).x - height * out.normal;
    const Vec3 m = e.cross(f);
    const double squared = m.squaredNorm();
    const double s = gap.cross(f).dot(m) / squared;
    const double t = gap.cross(e).dot(m) / squared;
    const double slack = kInside * difference_.reach();
    const double beyond_a = std::max(-s, s - 1), beyond_b = std::max(-t, t - 1);
    const bool inside_a = beyond_a <= 0 || beyond_a * beyond_a * e.squaredNorm() <= slack * slack;
    const bool inside_b = beyond_b <= 0 || beyond_b * beyond_b * f.squaredNorm() <= slack * slack;
    if (!(inside_a && inside_b)) return false;
    out.along_a = std::clamp(s, 0.0, 1.0);
    out.along_b = std::clamp(t, 0.0, 1.0);
    return true;
  }

  /// The other body's vertex, moved by the translation, must lie inside the facet.
  bool below_facet(const DifferenceVertex& s, double height, const NearFacets& piece) const {
    const bool of_a = piece.kind == NearFacetsBuffers::Kind::facet_of_a;
    const auto loop = (of_a ? difference_.a() : difference_.b()).facet_vertices(piece.facet);
    const Vec3 projection = height * piece.normal;
    const auto corner = [&](std::int32_t v) {
      return (of_a ? difference_.vertex(v, s.b) : difference_.vertex(s.a, v)).x;
    };
    const double slack = kInside * difference_.reach();
    // Seen from outside P, the corners of -A run clockwise.
    const Vec3 inwards = of_a ? Vec3(-piece.normal) : piece.normal;
    Vec3 last = corner(loop.back());
    for (const std::int32_t v : loop) {
      const Vec3 next = corner(v);
      const Vec3 side = next - last;
      const double left = inwards.dot(side.cross(projection - last));
      if (left < 0 && left * left > slack * slack * side.squaredNorm()) return false;
      last = next;
    }
    return true;
  }

  const PolytopeDifference& difference_;
  const SmallGaussMap& map_a_;
  const SmallGaussMap& map_b_;
  const Mat3 normals_a_;  ///< of -A
  const Mat3 normals_b_;
};

}  // namespace

bool small_sat_applies(const ConvexPolytope& a, const ConvexPolytope& b) {
  return has_small_gauss_map(a) && has_small_gauss_map(b);
}

SmallSatDepth small_sat_depth(const Pose& pose_a, const Pose& pose_b, const PolytopeDifference& difference,
                              const BracketWidth& width) {
  return SmallPair(pose_a, pose_b, difference).solve(width);
}

}  // namespace pd::detail

#include "depth/facets/small_piece.hpp"

#include <algorithm>

#include "shape/normal_matrix.hpp"

namespace pd::detail {

namespace {

/// A point beyond a piece's border by no more than this, in units of the reach, is rounding.
constexpr double kInside = 64 * kUnitRoundoff;

}  // namespace

SmallPieces::SmallPieces(const Pose& pose_a, const Pose& pose_b, const PolytopeDifference& difference)
    : difference_(difference),
      map_a_(small_gauss_map(difference.a())),
      map_b_(small_gauss_map(difference.b())),
      normals_a_(-normal_matrix(pose_a)),
      normals_b_(normal_matrix(pose_b)) {}

void SmallPieces::name(const SmallPiece& piece, const DifferenceVertex& s, NearFacets& out) const {
  if (piece.edge_a >= 0) {
    out.kind = NearFacetsBuffers::Kind::edges;
    out.edge_a[0] = map_a_.from[piece.edge_a];
    out.edge_a[1] = map_a_.to[piece.edge_a];
    out.edge_b[0] = map_b_.from[piece.edge_b];
    out.edge_b[1] = map_b_.to[piece.edge_b];
    return;
  }
  const bool of_a = piece.facet_a >= 0;
  out.kind = of_a ? NearFacetsBuffers::Kind::facet_of_a : NearFacetsBuffers::Kind::facet_of_b;
  out.facet = of_a ? piece.facet_a : piece.facet_b;
  out.vertex = of_a ? s.b : s.a;
}

bool SmallPieces::below_edges(const SmallPiece& piece, double height, NearFacets& out) const {
  const int a = piece.edge_a, b = piece.edge_b;
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
bool SmallPieces::below_facet(const DifferenceVertex& s, double height, const NearFacets& piece) const {
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

}  // namespace pd::detail

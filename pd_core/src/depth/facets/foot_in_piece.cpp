#include "depth/facets/foot_in_piece.hpp"

#include <algorithm>

#include "numeric/unit_roundoff.hpp"

namespace pd::detail {

namespace {

/// A point beyond a piece's border by no more than this, in units of the reach, is rounding.
constexpr double kInside = 64 * kUnitRoundoff;

Vec3 point(const VertexArrays& v, int i) { return {v.x[i], v.y[i], v.z[i]}; }

bool holds_foot_of_edges(const PolytopeDifference& difference, double height, NearFacets& piece) {
  // An edge of -A as a vector, and one of B.
  const Vec3 e = point(difference.posed_a(), piece.edge_a[0]) - point(difference.posed_a(), piece.edge_a[1]);
  const Vec3 f = point(difference.posed_b(), piece.edge_b[1]) - point(difference.posed_b(), piece.edge_b[0]);
  // corner - s e + t f = the projection
  const Vec3 gap = difference.vertex(piece.edge_a[0], piece.edge_b[0]).x - height * piece.normal;
  const Vec3 m = e.cross(f);
  const double squared = m.squaredNorm();
  const double s = gap.cross(f).dot(m) / squared;
  const double t = gap.cross(e).dot(m) / squared;
  const double slack = kInside * difference.reach();
  const double beyond_a = std::max(-s, s - 1), beyond_b = std::max(-t, t - 1);
  const bool inside_a = beyond_a <= 0 || beyond_a * beyond_a * e.squaredNorm() <= slack * slack;
  const bool inside_b = beyond_b <= 0 || beyond_b * beyond_b * f.squaredNorm() <= slack * slack;
  if (!(inside_a && inside_b)) return false;
  piece.along_a = std::clamp(s, 0.0, 1.0);
  piece.along_b = std::clamp(t, 0.0, 1.0);
  return true;
}

/// The other body's vertex, moved by the translation, must lie inside the facet.
bool holds_foot_of_facet(const PolytopeDifference& difference, const DifferenceVertex& s, double height,
                         const NearFacets& piece) {
  const bool of_a = piece.kind == NearFacetsBuffers::Kind::facet_of_a;
  const auto loop = (of_a ? difference.a() : difference.b()).facet_vertices(piece.facet);
  const Vec3 projection = height * piece.normal;
  const auto corner = [&](std::int32_t v) { return (of_a ? difference.vertex(v, s.b) : difference.vertex(s.a, v)).x; };
  const double slack = kInside * difference.reach();
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

}  // namespace

bool holds_foot(const PolytopeDifference& difference, const DifferenceVertex& s, double height, NearFacets& piece) {
  return piece.kind == NearFacetsBuffers::Kind::edges ? holds_foot_of_edges(difference, height, piece)
                                                      : holds_foot_of_facet(difference, s, height, piece);
}

}  // namespace pd::detail

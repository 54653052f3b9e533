#include "depth/facets/gauss_foot.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "depth/facets/gauss_sat_kernels.hpp"

namespace pd::detail {

namespace {

std::optional<double> foot_inside_edges(const PolytopeDifference& difference, double height, NearFacets& piece) {
  // An edge of -A as a vector, and one of B.
  const Vec3 e = -turned_edge(difference.posed_a(), piece.edge_a), f = turned_edge(difference.posed_b(), piece.edge_b);
  // corner - s e + t f = the projection
  const Vec3 gap = difference.vertex(piece.edge_a[0], piece.edge_b[0]).x - height * piece.normal;
  const Vec3 m = e.cross(f);
  const double squared = m.squaredNorm();
  const double s = gap.cross(f).dot(m) / squared;
  const double t = gap.cross(e).dot(m) / squared;
  const double slack = foot_rounding(difference);
  const double of_e = e.squaredNorm(), of_f = f.squaredNorm();
  const double beyond_a = std::max(-s, s - 1), beyond_b = std::max(-t, t - 1);
  const bool inside_a = beyond_a <= 0 || beyond_a * beyond_a * of_e <= slack * slack;
  const bool inside_b = beyond_b <= 0 || beyond_b * beyond_b * of_f <= slack * slack;
  if (!(inside_a && inside_b)) return std::nullopt;
  piece.along_a = std::clamp(s, 0.0, 1.0);
  piece.along_b = std::clamp(t, 0.0, 1.0);
  if (beyond_a >= 0 || beyond_b >= 0) return 0;
  return std::sqrt(squared * std::min(beyond_a * beyond_a / of_f, beyond_b * beyond_b / of_e));
}

/// The other body's vertex, moved by the translation, must lie inside the facet.
std::optional<double> foot_inside_facet(const PolytopeDifference& difference, const DifferenceVertex& s, double height,
                                        const NearFacets& piece) {
  const bool of_a = piece.kind == NearFacetsBuffers::Kind::facet_of_a;
  const auto loop = (of_a ? difference.a() : difference.b()).facet_vertices(piece.facet);
  const Vec3 projection = height * piece.normal;
  const auto corner = [&](std::int32_t v) { return (of_a ? difference.vertex(v, s.b) : difference.vertex(s.a, v)).x; };
  const double slack = foot_rounding(difference);
  // Seen from outside P, the corners of -A run clockwise.
  const Vec3 inwards = of_a ? Vec3(-piece.normal) : piece.normal;
  Vec3 last = corner(loop.back());
  double least = std::numeric_limits<double>::infinity();  // squared, with its sign
  for (const std::int32_t v : loop) {
    const Vec3 next = corner(v);
    const Vec3 side = next - last;
    const double left = inwards.dot(side.cross(projection - last));
    const double squared = side.squaredNorm();
    // Corners that round to one point have no side between them: nothing is known.
    if (!(squared > 0)) return std::nullopt;
    least = std::min(least, left * std::abs(left) / squared);
    last = next;
  }
  if (least < -slack * slack) return std::nullopt;
  return std::sqrt(std::max(0.0, least));
}

/// A convex polygon, a segment or a point.
struct FlatFace {
  /// Each side that clips a convex polygon adds a corner. Where rounding adds more, the last ones are left out: any
  /// corner is a point that the faces have in common.
  static constexpr int kMost = 2 * kMostGaussVertices;
  Vec3 corners[kMost];
  int count = 0;

  void add(const Vec3& corner) {
    corners[count] = corner;
    count += static_cast<int>(count + 1 < kMost);
  }
};

/// Adds the corners of the convex hull of points in a plane, counter-clockwise about its normal (Jarvis 1973): where
/// rounding splits a face into several facets, none of them has all corners.
void add_hull(FlatFace& face, const Vec3* points, int count, const Vec3& about) {
  // The point farthest from any other is a corner.
  int first = 0;
  for (int i = 1; i < count; ++i) {
    if ((points[i] - points[0]).squaredNorm() > (points[first] - points[0]).squaredNorm()) first = i;
  }
  int last = first;
  for (int corner = 0; corner < count; ++corner) {
    face.add(points[last]);
    int next = last == 0 ? 1 : 0;
    for (int i = 0; i < count; ++i) {
      if (i == last || i == next) continue;
      if (about.dot((points[next] - points[last]).cross(points[i] - points[last])) < 0) next = i;
    }
    if (next == first) return;
    last = next;
  }
}

/// The corners of -A or B, turned, that are farthest along the normal, counter-clockwise about `about`.
void take_face_along(FlatFace& face, const VertexArrays& posed, const Vec3& normal, double level, const Vec3& about) {
  double height[kMostGaussVertices];
  double most = -std::numeric_limits<double>::infinity();
  for (int v = 0; v < posed.count; ++v) {
    height[v] = posed.x[v] * normal.x() + posed.y[v] * normal.y() + posed.z[v] * normal.z();
    most = std::max(most, height[v]);
  }
  const auto is_level = [&](int v) { return height[v] >= most - level; };
  Vec3 points[kMostGaussVertices];
  int count = 0;
  for (int v = 0; v < posed.count; ++v) {
    if (is_level(v)) points[count++] = turned_vertex(posed, v);
  }
  if (count >= 3) return add_hull(face, points, count, about);
  for (int k = 0; k < count; ++k) face.add(points[k]);
}

/// Leaves of `face` what lies in `polygon`, whose corners run counter-clockwise about `normal`, within the slack.
void clip(FlatFace& face, const FlatFace& polygon, const Vec3& normal, double slack) {
  FlatFace before;
  for (int k = 0; k < polygon.count && face.count > 0; ++k) {
    const Vec3& from = polygon.corners[k];
    const Vec3 side = polygon.corners[k + 1 < polygon.count ? k + 1 : 0] - from;
    const Vec3 inwards = normal.cross(side);
    const double level = -slack * inwards.norm();
    const auto above = [&](const Vec3& x) { return inwards.dot(x - from) - level; };
    before.count = face.count;
    std::copy_n(face.corners, face.count, before.corners);
    face.count = 0;
    Vec3 last = before.corners[before.count - 1];
    double last_above = above(last);
    for (int i = 0; i < before.count; ++i) {
      const Vec3& next = before.corners[i];
      const double next_above = above(next);
      if ((next_above >= 0) != (last_above >= 0)) {
        face.add(last + last_above / (last_above - next_above) * (next - last));
      }
      if (next_above >= 0) face.add(next);
      last = next;
      last_above = next_above;
    }
  }
}

}  // namespace

std::optional<double> foot_inside(const PolytopeDifference& difference, const DifferenceVertex& s, double height,
                                  NearFacets& piece) {
  return piece.kind == NearFacetsBuffers::Kind::edges ? foot_inside_edges(difference, height, piece)
                                                      : foot_inside_facet(difference, s, height, piece);
}

std::optional<Vec3> meeting_point(const PolytopeDifference& difference, const Vec3& normal, double height,
                                  double slack) {
  FlatFace of_a, of_b;
  take_face_along(of_a, difference.posed_a(), normal, slack, -normal);
  take_face_along(of_b, difference.posed_b(), normal, slack, normal);
  // b - a + offset = height normal: where A's face comes to lie, whose corners then run clockwise about the normal.
  const Vec3 way = height * normal - difference.offset();
  for (int k = 0; k < of_a.count; ++k) of_a.corners[k] = way - of_a.corners[k];
  if (of_a.count < 3 && of_b.count < 3) return std::nullopt;
  FlatFace& common = of_a.count >= 3 ? of_b : of_a;
  clip(common, of_a.count >= 3 ? of_a : of_b, of_a.count >= 3 ? Vec3(-normal) : normal, slack);
  if (common.count == 0) return std::nullopt;
  Vec3 sum = Vec3::Zero();
  for (int k = 0; k < common.count; ++k) sum += common.corners[k];
  return sum / common.count;
}

}  // namespace pd::detail

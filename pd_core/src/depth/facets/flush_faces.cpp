#include "depth/facets/flush_faces.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "numeric/unit_roundoff.hpp"
#include "shape/small_gauss_map.hpp"

namespace pd::detail {

namespace {

/// Of the reach: what rounding may move a corner off its facet's plane, or a point beyond a face's border.
constexpr double kFlush = 64 * kUnitRoundoff;

/// A convex polygon, a segment or a point.
struct FlatFace {
  /// A facet has seven corners, and each side that clips a convex polygon adds one. Where rounding adds more, the last
  /// ones are left out: any corner is a point that the faces have in common.
  static constexpr int kMost = 2 * SmallGaussMap::kMostVertices;
  Vec3 corners[kMost];
  int count = 0;

  void add(const Vec3& corner) {
    corners[count] = corner;
    count += static_cast<int>(count + 1 < kMost);
  }
};

/// The corners of -A or B, turned, that are farthest along the normal: in the order of the body's facet where they are
/// one, else at most two.
FlatFace face_along(const ConvexPolytope& body, const VertexArrays& posed, const Vec3& normal, double level) {
  double height[SmallGaussMap::kMostVertices];
  double most = -std::numeric_limits<double>::infinity();
  for (int v = 0; v < posed.count; ++v) {
    height[v] = posed.x[v] * normal.x() + posed.y[v] * normal.y() + posed.z[v] * normal.z();
    most = std::max(most, height[v]);
  }
  const auto is_level = [&](int v) { return height[v] >= most - level; };
  FlatFace face;
  const auto add = [&](int v) { face.add({posed.x[v], posed.y[v], posed.z[v]}); };
  for (int f = 0; f < body.num_facets(); ++f) {
    const auto loop = body.facet_vertices(f);
    if (!std::all_of(loop.begin(), loop.end(), is_level)) continue;
    for (const std::int32_t v : loop) add(v);
    return face;
  }
  for (int v = 0; v < posed.count && face.count < 2; ++v) {
    if (is_level(v)) add(v);
  }
  return face;
}

/// What of `face` lies in `polygon`, whose corners run counter-clockwise about `normal`, within the slack.
FlatFace clipped(const FlatFace& face, const FlatFace& polygon, const Vec3& normal, double slack) {
  FlatFace left = face;
  for (int k = 0; k < polygon.count && left.count > 0; ++k) {
    const Vec3& from = polygon.corners[k];
    const Vec3 side = polygon.corners[k + 1 < polygon.count ? k + 1 : 0] - from;
    const Vec3 inwards = normal.cross(side);
    const double level = -slack * inwards.norm();
    const auto above = [&](const Vec3& x) { return inwards.dot(x - from) - level; };
    const FlatFace before = left;
    left.count = 0;
    Vec3 last = before.corners[before.count - 1];
    double last_above = above(last);
    for (int i = 0; i < before.count; ++i) {
      const Vec3& next = before.corners[i];
      const double next_above = above(next);
      if ((next_above >= 0) != (last_above >= 0)) {
        left.add(last + last_above / (last_above - next_above) * (next - last));
      }
      if (next_above >= 0) left.add(next);
      last = next;
      last_above = next_above;
    }
  }
  return left;
}

}  // namespace

std::optional<Vec3> meeting_point(const PolytopeDifference& difference, const Vec3& normal, double height) {
  const double slack = kFlush * difference.reach();
  FlatFace of_a = face_along(difference.a(), difference.posed_a(), normal, slack);
  const FlatFace of_b = face_along(difference.b(), difference.posed_b(), normal, slack);
  // b - a + offset = height normal: where A's face comes to lie, whose corners then run clockwise about the normal.
  const Vec3 way = height * normal - difference.offset();
  for (int k = 0; k < of_a.count; ++k) of_a.corners[k] = way - of_a.corners[k];
  if (of_a.count < 3 && of_b.count < 3) return std::nullopt;
  const FlatFace common = of_a.count >= 3 ? clipped(of_b, of_a, -normal, slack) : clipped(of_a, of_b, normal, slack);
  if (common.count == 0) return std::nullopt;
  Vec3 sum = Vec3::Zero();
  for (int k = 0; k < common.count; ++k) sum += common.corners[k];
  return sum / common.count;
}

}  // namespace pd::detail

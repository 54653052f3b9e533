#include "depth/difference/support_double_double.hpp"

#include <algorithm>
#include <limits>

#include "numeric/unit_roundoff.hpp"
#include "numeric/vector_double_double.hpp"
#include "shape/support/polytope_support.hpp"
#include "structure/exact_climb.hpp"

namespace pd::detail {

namespace {

/// A vertex of the body among the farthest in a direction of its own frame, as far as double-double tells.
/// @param local  about a unit vector.
int farthest_in_double_double(const ConvexPolytope& body, const Vec3DD& local, double scale) {
  const Vec3 rounded = high(local);
  const auto height = [&](int v) {
    const Vec3DD x{{body.x()[v] * scale, 0}, {body.y()[v] * scale, 0}, {body.z()[v] * scale, 0}};
    return dot(local, x);
  };
  if (body.num_vertices() > kScannedVertices && body.affine_dimension() == 3) {
    return climb_exactly(body, support_vertex(body, rounded, -1), [&](int from, int to) {
      const double rise = to_double(height(to) - height(from));
      return (rise > 0) - (rise < 0);
    });
  }
  const int n = body.num_vertices();
  double most = -std::numeric_limits<double>::infinity();
  for (int v = 0; v < n; ++v) most = std::max(most, body.vertex(v).dot(rounded));
  const double slack = 16 * kUnitRoundoff * body.radius() + 0x1p-1070;
  int best = -1;
  DoubleDouble highest;
  for (int v = 0; v < n; ++v) {
    if (body.vertex(v).dot(rounded) < most - slack) continue;
    const DoubleDouble h = height(v);
    if (best >= 0 && !(to_double(h - highest) > 0)) continue;
    best = v;
    highest = h;
  }
  return best;
}

}  // namespace

VertexPair support_double_double(const PosedPair& pair, const Vec3DD& direction) {
  const double scale = pair.inwards();
  return {farthest_in_double_double(pair.a(), pair.in_frame_of_a(scaled(direction, {-1, 0})), scale),
          farthest_in_double_double(pair.b(), pair.in_frame_of_b(direction), scale)};
}

}  // namespace pd::detail

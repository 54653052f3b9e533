#include "union_contact/column.hpp"

#include <algorithm>
#include <limits>

namespace pd::detail {

namespace {

/// Sine: from a farthest vertex no facet leads outward but by rounding, and a facet that is this steep does not within
/// the accuracy that matters here.
constexpr double kSteep = 1e-3;

/// Returns the length of the way along n from a point in a solid polytope until it leaves the polytope.
double way_inside(const ConvexPolytope& polytope, const Vec3& from, const Vec3& n) {
  double length = std::numeric_limits<double>::infinity();
  for (int f = 0; f < polytope.num_facets(); ++f) {
    const Vec3& normal = polytope.facet_normal(f);
    const double rate = normal.dot(n);
    if (rate <= 0 || rate * rate <= kSteep * kSteep * normal.squaredNorm()) continue;
    length = std::min(length, normal.dot(polytope.vertex(polytope.facet_vertices(f)[0]) - from) / rate);
  }
  return std::max(length, 0.0);
}

}  // namespace

bool reaches_back(const PosedShape& body, const Vec3& from, const Vec3& n, double length) {
  const ConvexPolytope* const polytope = body.shape->polytope();
  if (polytope == nullptr) return false;
  const double margin = body.shape->margin();
  if (polytope->affine_dimension() < 3) return length <= 2 * margin;
  const Mat3 turn = body.pose.rotation().transpose();
  const Vec3 core = turn * (from + margin * n - body.pose.translation());
  return length <= way_inside(*polytope, core, turn * n) + 2 * margin;
}

Vec3 middle_of(const PosedShape& body) {
  const ConvexPolytope* const polytope = body.shape->polytope();
  if (polytope == nullptr) return body.pose.translation();
  Vec3 sum = Vec3::Zero();
  for (int v = 0; v < polytope->num_vertices(); ++v) sum += polytope->vertex(v) / polytope->num_vertices();
  return body.pose.apply(sum);
}

}  // namespace pd::detail

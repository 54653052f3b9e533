#include "shape/hull_builder.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "numeric/number_text.hpp"
#include "pd/shape/pose.hpp"
#include "shape/affine_frame.hpp"
#include "shape/facet_loops.hpp"
#include "shape/planar_hull.hpp"
#include "shape/polytope_storage.hpp"
#include "shape/quickhull.hpp"

namespace pd::detail {
namespace {

// Below this size the order of points in memory does not matter (everything is in the cache).
constexpr int kSortedSize = 4096;

FacetLoops solid_loops(HullPoints& points, const AffineFrame& frame) {
  Quickhull hull(points, frame);
  hull.insert(0, points.size());
  hull.compact();
  return merge_facets(hull, points.size());
}

/// Both sides of a polygon in space.
FacetLoops doubly_covered(const std::vector<int>& polygon) {
  FacetLoops loops;
  loops.vertices.assign(polygon.begin(), polygon.end());
  loops.end_facet();
  loops.vertices.insert(loops.vertices.end(), polygon.rbegin(), polygon.rend());
  loops.end_facet();
  return loops;
}

}  // namespace

std::optional<Error> refuse_points(std::span<const Vec3> points) {
  if (points.empty()) return Error{ErrorCode::too_few_points, "no points; one at least is needed", "vertices"};
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3& p = points[i];
    for (int k = 0; k < 3; ++k) {
      if (std::abs(p[k]) <= kMaxCoordinate) continue;
      const std::string where = indexed("vertices", static_cast<long long>(i));
      if (!std::isfinite(p[k])) return Error{ErrorCode::non_finite, "a coordinate must be finite", where};
      return Error{ErrorCode::out_of_range,
                   number_text(p[k]) + " is beyond the largest coordinate " + number_text(kMaxCoordinate), where};
    }
  }
  return std::nullopt;
}

ConvexPolytope build_hull(std::span<const Vec3> source, std::span<const std::int32_t> caller_ids) {
  double max_abs = 0;
  for (const Vec3& p : source) max_abs = std::max(max_abs, p.cwiseAbs().maxCoeff());
  HullPoints points(source, max_abs);
  points.reserve(source.size());
  for (std::size_t i = 0; i < source.size(); ++i) points.append(static_cast<std::int32_t>(i));
  if (points.size() > kSortedSize) points.sort_spatially(0);

  const AffineFrame frame = find_affine_frame(points);
  FacetLoops loops;
  if (frame.dimension == 3) loops = solid_loops(points, frame);
  if (frame.dimension == 2) loops = doubly_covered(planar_hull(points, frame));

  // Positions of the vertices that are left, in place of point indices.
  std::vector<HullVertex> vertices;
  std::vector<std::int32_t> position(static_cast<std::size_t>(points.size()), -1);
  const auto add_vertex = [&](int p) {
    std::int32_t& place = position[static_cast<std::size_t>(p)];
    if (place < 0) {
      place = static_cast<std::int32_t>(vertices.size());
      const Vec3 v = points.original(p);
      const std::int32_t id = points[p].id;
      vertices.push_back({v.x(), v.y(), v.z(), caller_ids.empty() ? id : caller_ids[static_cast<std::size_t>(id)]});
    }
    return place;
  };
  for (std::int32_t& v : loops.vertices) v = add_vertex(v);
  if (frame.dimension < 2) {
    for (int i = 0; i <= frame.dimension; ++i) add_vertex(frame.points[static_cast<std::size_t>(i)]);
  }
  return ConvexPolytope(lay_out(vertices, loops, frame.dimension));
}

}  // namespace pd::detail

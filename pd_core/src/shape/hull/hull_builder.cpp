#include "shape/hull/hull_builder.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "numeric/number_text.hpp"
#include "pd/shape/pose.hpp"
#include "shape/hull/affine_frame.hpp"
#include "shape/hull/facet_loops.hpp"
#include "shape/hull/planar_hull.hpp"
#include "shape/hull/point_survey.hpp"
#include "shape/hull/polytope_storage.hpp"
#include "shape/hull/quickhull.hpp"

namespace pd::detail {
namespace {

// From this size on most points are sorted out before the hull is built. Measured at 10^4 points: saves a third of the
// time in a ball and half of it in a box, costs 5 % on a sphere, where nothing can be sorted out.
constexpr std::size_t kSurveyedSize = 2000;
// Below this size the order of points in memory does not matter: they stay in the cache.
constexpr int kSortedSize = 4096;
// A hull of n vertices has fewer than 6n half-edges, whose indices are 32 bits wide.
constexpr std::size_t kMaxPoints = 300'000'000;

/// Both sides of a polygon in space.
FacetLoops doubly_covered(const std::vector<int>& polygon) {
  FacetLoops loops;
  loops.vertices.assign(polygon.begin(), polygon.end());
  loops.end_facet();
  loops.vertices.insert(loops.vertices.end(), polygon.rbegin(), polygon.rend());
  loops.end_facet();
  return loops;
}

/// Of three points that are not on a line, what the search would end with. A mesh brings its triangles one by one.
std::optional<ConvexPolytope> build_triangle(std::span<const Vec3> source, std::span<const std::int32_t> caller_ids,
                                             double max_abs) {
  HullPoints points(source, max_abs);
  points.reserve(3);
  for (std::int32_t i = 0; i < 3; ++i) points.append(i);
  if (points.collinear(0, 1, 2)) return std::nullopt;
  HullVertex vertices[3];
  for (std::int32_t i = 0; i < 3; ++i) {
    const Vec3 v = points.original(i);
    vertices[i] = {v.x(), v.y(), v.z(), caller_ids.empty() ? i : caller_ids[static_cast<std::size_t>(i)]};
  }
  static const FacetLoops loops = doubly_covered({0, 1, 2});
  return ConvexPolytope(lay_out(vertices, loops, 2));
}

/// Of the eight corners of a box along the axes, in any order, what the search would end with: most worlds are full of
/// them.
std::optional<ConvexPolytope> build_aligned_box(std::span<const Vec3> source,
                                                std::span<const std::int32_t> caller_ids) {
  Vec3 low = source.front(), high = source.front();
  for (const Vec3& p : source) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  HullVertex vertices[8];
  unsigned found = 0;
  for (std::int32_t i = 0; i < 8; ++i) {
    const Vec3& p = source[static_cast<std::size_t>(i)];
    unsigned corner = 0;
    for (int k = 0; k < 3; ++k) {
      if (!(low[k] < high[k]) || (p[k] != low[k] && p[k] != high[k])) return std::nullopt;
      corner |= static_cast<unsigned>(p[k] == high[k]) << k;
    }
    found |= 1U << corner;
    // Of two zeros the positive one.
    vertices[corner] = {p.x() + 0.0, p.y() + 0.0, p.z() + 0.0,
                        caller_ids.empty() ? i : caller_ids[static_cast<std::size_t>(i)]};
  }
  if (found != 0xFF) return std::nullopt;
  return ConvexPolytope(lay_out_box(vertices));
}

}  // namespace

std::optional<Error> refuse_points(std::span<const Vec3> points) {
  if (points.empty()) return Error{ErrorCode::too_few_points, "no points; one at least is needed", "vertices"};
  if (points.size() > kMaxPoints) {
    return Error{ErrorCode::limit_exceeded,
                 std::to_string(points.size()) + " points; at most " + std::to_string(kMaxPoints) + " are taken",
                 "vertices"};
  }
  // One plain loop over all numbers first: nearly always nothing is wrong.
  static_assert(sizeof(Vec3) == 3 * sizeof(double));
  const double* numbers = points.front().data();
  int wrong = 0;
  for (std::size_t i = 0; i < 3 * points.size(); ++i) wrong |= std::abs(numbers[i]) <= kMaxCoordinate ? 0 : 1;
  if (wrong == 0) return std::nullopt;
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
  if (source.size() == 3) {
    if (std::optional<ConvexPolytope> triangle = build_triangle(source, caller_ids, max_abs)) return *triangle;
  }
  if (source.size() == 8) {
    if (std::optional<ConvexPolytope> box = build_aligned_box(source, caller_ids)) return *box;
  }
  HullPoints points(source, max_abs);

  // The hull of a few extreme points leaves few points outside, where there are many and they are not flat.
  std::optional<Quickhull> hull;
  if (source.size() >= kSurveyedSize) {
    for (const std::int32_t id : extreme_points(source)) points.append(id);
    const AffineFrame frame = find_affine_frame(points);
    if (frame.dimension == 3) {
      hull.emplace(points, frame);
      hull->insert(0, points.size());
      hull->compact();
    }
  }
  const int first = points.size();
  if (hull) {
    for (const std::int32_t id : points_not_inside(source, points.scale(), hull->triangles())) points.append(id);
  } else {
    points.reserve(points.size() + source.size());
    for (std::size_t i = 0; i < source.size(); ++i) points.append(static_cast<std::int32_t>(i));
  }
  if (points.size() - first > kSortedSize) points.sort_spatially(first);

  AffineFrame frame;
  frame.dimension = 3;
  if (!hull) {
    frame = find_affine_frame(points);
    if (frame.dimension == 3) hull.emplace(points, frame);
  }
  FacetLoops loops;
  if (hull) {
    hull->insert(first, points.size());
    hull->compact();
    loops = merge_facets(*hull, points.size());
  } else if (frame.dimension == 2) {
    loops = doubly_covered(planar_hull(points, frame));
  }

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

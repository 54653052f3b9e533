#include "planar/boundary/triangulation.hpp"

#include <algorithm>
#include <cassert>
#include <numeric>
#include <utility>

#include "numeric/at.hpp"
#include "numeric/estimate.hpp"
#include "pd/numeric/predicates.hpp"
#include "planar/boundary/monotone_pieces.hpp"

namespace pd::detail {

namespace {

/// The boundary as closed walks round the interior.
std::vector<std::vector<std::int32_t>> walks_of(const Polygon& polygon) {
  std::vector<std::vector<std::int32_t>> walks;
  std::vector<bool> walked(at(polygon.num_vertices()), false);
  for (std::int32_t first = 0; first < polygon.num_vertices(); ++first) {
    if (walked[at(first)]) continue;
    walks.emplace_back();
    for (std::int32_t v = first; !walked[at(v)]; v = polygon.next(v)) {
      walked[at(v)] = true;
      walks.back().push_back(v);
    }
  }
  return walks;
}

/// A ring as it was given, turned round for what lies beyond it, each point by its first vertex.
std::vector<std::int32_t> beyond_ring(const Polygon& polygon, int ring) {
  std::vector<std::int32_t> ids;
  for (int v = polygon.ring_end(ring) - 1; v >= polygon.ring_begin(ring); --v) ids.push_back(polygon.first_here(v));
  return ids;
}

/// Corners of a box with air round the points.
std::array<Point2, 4> enclosing_box(std::span<const Point2> points) {
  Point2 low = points[0], high = points[0];
  for (const Point2& p : points) {
    for (std::size_t k = 0; k < 2; ++k) {
      low[k] = std::min(low[k], p[k]);
      high[k] = std::max(high[k], p[k]);
    }
  }
  const double air = std::max(high[0] - low[0], high[1] - low[1]) +
                     0x1p-40 * std::max({-low[0], -low[1], high[0], high[1]});  // more than an ulp of any coordinate
  for (std::size_t k = 0; k < 2; ++k) {
    low[k] -= air;
    high[k] += air;
  }
  return {low, Point2{high[0], low[1]}, high, Point2{low[0], high[1]}};
}

/// Triangles on both sides of an edge may have its ends as different vertices, at the same points.
void link_neighbours(const Polygon& polygon, std::vector<Triangle>& triangles) {
  struct Side {
    std::int32_t low, high, triangle, edge;
  };
  std::vector<Side> sides;
  for (std::int32_t t = 0; t < static_cast<std::int32_t>(triangles.size()); ++t) {
    for (std::int32_t k = 0; k < 3; ++k) {
      const auto end = [&](std::int32_t corner) {
        const std::int32_t v = triangles[at(t)].vertex[at(corner)];
        return v < polygon.num_vertices() ? polygon.first_here(v) : v;
      };
      const std::int32_t a = end(k), b = end((k + 1) % 3);
      sides.push_back({std::min(a, b), std::max(a, b), t, k});
    }
  }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return std::tie(a.low, a.high, a.triangle) < std::tie(b.low, b.high, b.triangle);
  });
  for (std::size_t i = 0; i + 1 < sides.size(); ++i) {
    const Side &a = sides[i], &b = sides[i + 1];
    if (a.low != b.low || a.high != b.high) continue;
    triangles[at(a.triangle)].neighbour[at(a.edge)] = b.triangle;
    triangles[at(b.triangle)].neighbour[at(b.edge)] = a.triangle;
  }
}

class Flips {
 public:
  Flips(std::span<const Point2> points, std::vector<Triangle>& triangles) : points_(points), triangles_(triangles) {}

  void run() {
    std::vector<std::pair<std::int32_t, std::int32_t>> open;
    for (std::int32_t t = 0; t < static_cast<std::int32_t>(triangles_.size()); ++t) {
      for (std::int32_t k = 0; k < 3; ++k) open.emplace_back(t, k);
    }
    // A mixed order, the same in every run: in order, a fan would be turned over spoke by spoke into another fan.
    std::uint64_t state = 0x9E3779B97F4A7C15u;
    for (std::size_t i = open.size(); i > 1; --i) {
      state = state * 6364136223846793005u + 1442695040888963407u;
      std::swap(open[i - 1], open[(state >> 33) % i]);
    }
    while (!open.empty()) {
      std::vector<std::pair<std::int32_t, std::int32_t>> later;
      for (const auto& [t, k] : open) flip_if_better(t, k, later);
      open.swap(later);
    }
  }

 private:
  [[nodiscard]] const Point2& point(int v) const { return points_[at(v)]; }
  [[nodiscard]] int side(int a, int b, int c) const { return orient2d(point(a), point(b), point(c)); }

  /// Does d lie certainly inside the circle round a, b, c? Where rounding leaves it open the answer is no: any
  /// triangulation serves.
  [[nodiscard]] bool in_circle(int a, int b, int c, int d) const {
    std::array<Estimate, 3> x, y, square;
    const std::array<int, 3> corner = {a, b, c};
    for (std::size_t i = 0; i < 3; ++i) {
      x[i] = Estimate(point(corner[i])[0]) - Estimate(point(d)[0]);
      y[i] = Estimate(point(corner[i])[1]) - Estimate(point(d)[1]);
      square[i] = x[i] * x[i] + y[i] * y[i];
    }
    const Estimate determinant = square[0] * (x[1] * y[2] - x[2] * y[1]) - square[1] * (x[0] * y[2] - x[2] * y[0]) +
                                 square[2] * (x[0] * y[1] - x[1] * y[0]);
    return determinant.certain_sign() > 0;
  }

  void flip_if_better(std::int32_t t, std::int32_t k, std::vector<std::pair<std::int32_t, std::int32_t>>& later) {
    Triangle& near = triangles_[at(t)];
    const std::int32_t u = near.neighbour[at(k)];
    if (u < 0 || triangles_[at(u)].inside != near.inside) return;
    Triangle& far = triangles_[at(u)];
    const int a = near.vertex[at(k)], b = near.vertex[at((k + 1) % 3)], c = near.vertex[at((k + 2) % 3)];
    std::size_t j = 0;
    while (far.vertex[j] != b || far.vertex[(j + 1) % 3] != a) ++j;
    const int d = far.vertex[(j + 2) % 3];
    if (side(a, d, c) <= 0 || side(d, b, c) <= 0) return;  // the other diagonal leaves the two triangles
    const bool flat = side(a, b, c) == 0 || side(b, a, d) == 0;
    if (!flat && !in_circle(a, b, c, d)) return;
    const std::int32_t past_bc = near.neighbour[at((k + 1) % 3)], past_ca = near.neighbour[at((k + 2) % 3)];
    const std::int32_t past_ad = far.neighbour[(j + 1) % 3], past_db = far.neighbour[(j + 2) % 3];
    near.vertex = {a, d, c};
    near.neighbour = {past_ad, u, past_ca};
    far.vertex = {d, b, c};
    far.neighbour = {past_db, past_bc, t};
    relink(past_ad, u, t);
    relink(past_bc, t, u);
    for (const std::int32_t e : {0, 1, 2}) {
      later.emplace_back(t, e);
      later.emplace_back(u, e);
    }
  }

  void relink(std::int32_t triangle, std::int32_t from, std::int32_t to) {
    if (triangle < 0) return;
    // Two triangles share one edge at most, so the entry is unique.
    for (std::int32_t& n : triangles_[at(triangle)].neighbour) {
      if (n == from) {
        n = to;
        return;
      }
    }
  }

  std::span<const Point2> points_;
  std::vector<Triangle>& triangles_;
};

}  // namespace

Triangulation triangulate(const Polygon& polygon, bool with_outside) {
  Triangulation r;
  r.points.assign(polygon.points().begin(), polygon.points().end());
  for (const Point2& corner : enclosing_box(polygon.points())) r.points.push_back(corner);

  std::vector<std::array<std::int32_t, 3>> corners;
  triangulate_region(r.points, walks_of(polygon), corners);
  r.num_inside = static_cast<int>(corners.size());
  if (with_outside) {
    const std::int32_t box = polygon.num_vertices();
    const std::vector<std::vector<std::int32_t>> around = {{box, box + 1, box + 2, box + 3}, beyond_ring(polygon, 0)};
    triangulate_region(r.points, around, corners);
    for (int ring = 1; ring < polygon.num_rings(); ++ring) {
      const std::vector<std::vector<std::int32_t>> hole = {beyond_ring(polygon, ring)};
      triangulate_region(r.points, hole, corners);
    }
  }
  for (std::size_t t = 0; t < corners.size(); ++t) {
    r.triangles.push_back({corners[t], {-1, -1, -1}, static_cast<int>(t) < r.num_inside});
  }
  link_neighbours(polygon, r.triangles);
  Flips(r.points, r.triangles).run();

  r.owner.assign(at(polygon.num_vertices()), -1);
  for (std::int32_t t = 0; t < r.num_inside; ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::int32_t v = r.triangles[at(t)].vertex[k];
      if (polygon.next(v) == r.triangles[at(t)].vertex[(k + 1) % 3]) r.owner[at(v)] = t;
    }
  }
  return r;
}

}  // namespace pd::detail

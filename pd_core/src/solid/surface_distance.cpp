#include "solid/surface_distance.hpp"

#include <algorithm>
#include <cmath>

#include "numeric/unit_roundoff.hpp"

namespace pd::detail {

namespace {

class NearestPoint {
 public:
  NearestPoint(const PosedSolids& solids, Body body, const Vec3& x, double enough)
      : solids_(solids), body_(body), x_(x), enough_(enough) {}

  void search() { visit(0, gap(0)); }
  [[nodiscard]] std::int32_t triangle() const { return triangle_; }
  /// At most the distance.
  [[nodiscard]] double distance() const {
    return std::max(0.0, std::sqrt(squared_) * (1 - 0x1p-48) - 8 * solids_.error());
  }

 private:
  [[nodiscard]] const TriangleNode& node(std::int32_t at) const {
    return solids_.solid(body_).nodes()[static_cast<std::size_t>(at)];
  }
  [[nodiscard]] double gap(std::int32_t at) const {
    const TriangleBox box = solids_.box(body_, node(at));
    return (box.low - x_).cwiseMax(x_ - box.high).cwiseMax(Vec3::Zero()).squaredNorm();
  }

  void visit(std::int32_t at, double least) {
    if (least >= squared_ || squared_ < enough_ * enough_) return;
    const TriangleNode& here = node(at);
    if (here.is_leaf()) {
      for (std::int32_t t = here.first; t < here.last; ++t) {
        const double before = squared_;
        test(t);
        if (squared_ < before) triangle_ = t;
      }
      return;
    }
    const double left = gap(here.left), right = gap(here.right);
    if (left <= right) {
      visit(here.left, left);
      visit(here.right, right);
    } else {
      visit(here.right, right);
      visit(here.left, left);
    }
  }

  void test(std::int32_t triangle) {
    const PosedTriangle t = solids_.corners(body_, triangle);
    const Vec3 u = t[1].x - t[0].x, v = t[2].x - t[0].x, w = x_ - t[0].x;
    const Vec3 n = u.cross(v);
    const double area = n.squaredNorm();
    const double r = w.cross(v).dot(n), s = u.cross(w).dot(n);
    double squared = HUGE_VAL;
    if (area > 0 && r > 0 && s > 0 && r + s < area) {
      const double height = n.dot(w);
      squared = height * height / area;
    }
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 edge = t[(k + 1) % 3].x - t[k].x, from = x_ - t[k].x;
      const double along = std::clamp(from.dot(edge) / edge.squaredNorm(), 0.0, 1.0);
      squared = std::min(squared, (from - along * edge).squaredNorm());
    }
    // The normal of a sliver, and with it the foot, is as uncertain as its area.
    const double off =
        area > 0 ? 128 * kUnitRoundoff * std::sqrt(u.squaredNorm() * v.squaredNorm() / area) * w.norm() : HUGE_VAL;
    const double distance = std::max(0.0, std::sqrt(squared) - off);
    squared_ = std::min(squared_, distance * distance);
  }

  const PosedSolids& solids_;
  Body body_;
  const Vec3& x_;
  double enough_;
  double squared_ = HUGE_VAL;
  std::int32_t triangle_ = 0;
};

}  // namespace

double distance_to_surface(const PosedSolids& solids, Body body, const Vec3& x, double enough) {
  NearestPoint nearest(solids, body, x, enough);
  nearest.search();
  return nearest.distance();
}

NearestTriangle nearest_triangle(const PosedSolids& solids, Body body, const Vec3& x) {
  NearestPoint nearest(solids, body, x, 0);
  nearest.search();
  return {nearest.triangle(), nearest.distance()};
}

double reach_to_triangle(const PosedTriangle& triangle, const Vec3& x) {
  // Any point of the triangle bounds the distance from above, so that it does no harm where rounding picks another.
  const Vec3 &p = triangle[0].x, u = triangle[1].x - p, v = triangle[2].x - p, w = x - p;
  const Vec3 n = u.cross(v);
  const double area = n.squaredNorm();
  double squared = HUGE_VAL;
  if (area > 0) {
    const double r = w.cross(v).dot(n) / area, s = u.cross(w).dot(n) / area;
    if (r >= 0 && s >= 0 && r + s <= 1) squared = (w - r * u - s * v).squaredNorm();
  }
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 edge = triangle[(k + 1) % 3].x - triangle[k].x, from = x - triangle[k].x;
    const double length = edge.squaredNorm();
    const double along = length > 0 ? std::clamp(from.dot(edge) / length, 0.0, 1.0) : 0;
    squared = std::min(squared, (from - along * edge).squaredNorm());
  }
  return std::sqrt(squared) * (1 + 0x1p-48) + 0x1p-46;
}

}  // namespace pd::detail

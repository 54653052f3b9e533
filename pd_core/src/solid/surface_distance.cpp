#include "solid/surface_distance.hpp"

#include <algorithm>
#include <cmath>

#include "numeric/unit_roundoff.hpp"

namespace pd::detail {

namespace {

class NearestPoint {
 public:
  NearestPoint(const PosedSolids& solids, Body body, const Vec3& x, double at_most)
      : solids_(solids), body_(body), x_(x), squared_(at_most * at_most) {}

  NearestTriangle search() {
    visit(0, gap(0));
    nearest_.distance = std::max(0.0, std::sqrt(squared_) * (1 - 0x1p-48) - 8 * solids_.error());
    return nearest_;
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
    if (least >= squared_) return;
    const TriangleNode& here = node(at);
    if (here.is_leaf()) {
      for (std::int32_t t = here.first; t < here.last; ++t) test(t);
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
    double squared = HUGE_VAL, of_edges = HUGE_VAL;
    Vec3 to_foot = Vec3::Zero();
    const auto take = [&](const Vec3& there, double length) {
      if (!(length < squared)) return;
      squared = length;
      to_foot = there;
    };
    if (area > 0 && r > 0 && s > 0 && r + s < area) {
      const double height = n.dot(w);
      take((-height / area) * n, height * height / area);
    }
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 edge = t[(k + 1) % 3].x - t[k].x, from = x_ - t[k].x;
      const double along = std::clamp(from.dot(edge) / edge.squaredNorm(), 0.0, 1.0);
      const Vec3 there = along * edge - from;
      of_edges = std::min(of_edges, there.squaredNorm());
      take(there, there.squaredNorm());
    }
    // The normal of a sliver, and with it the foot, is as uncertain as its area; but its points are near its edges.
    const double off =
        area > 0 ? 128 * kUnitRoundoff * std::sqrt(u.squaredNorm() * v.squaredNorm() / area) * w.norm() : HUGE_VAL;
    const double height = std::sqrt(area / std::max({u.squaredNorm(), v.squaredNorm(), (u - v).squaredNorm()}));
    const double distance = std::max({0.0, std::sqrt(squared) - off, std::sqrt(of_edges) - height});
    if (!(distance * distance < squared_)) return;
    squared_ = distance * distance;
    nearest_.triangle = triangle;
    nearest_.foot = x_ + to_foot;
  }

  const PosedSolids& solids_;
  Body body_;
  const Vec3& x_;
  double squared_;
  NearestTriangle nearest_;
};

}  // namespace

NearestTriangle nearest_triangle(const PosedSolids& solids, Body body, const Vec3& x, double at_most) {
  return NearestPoint(solids, body, x, at_most).search();
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

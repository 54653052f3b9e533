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

  double run() {
    visit(0, gap(0));
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
};

}  // namespace

double distance_to_surface(const PosedSolids& solids, Body body, const Vec3& x, double enough) {
  return NearestPoint(solids, body, x, enough).run();
}

}  // namespace pd::detail

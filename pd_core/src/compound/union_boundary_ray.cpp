/// @file
/// The first uncovered point along a ray: `UnionBoundary::along`.
#include <algorithm>
#include <cmath>
#include <queue>
#include <utility>

#include "compound/union_boundary.hpp"
#include "numeric/quotient.hpp"

namespace pd::detail {

namespace {

/// Where a polygon meets the ray t d, t >= 0: the least t.
class RayMeeting {
 public:
  /// @param exact, unit  one direction.
  RayMeeting(const PlaneSet& planes, const Dyadic3& exact, const Vec3& unit)
      : planes_(planes), exact_(exact), unit_(unit) {}

  [[nodiscard]] const Dyadic3& exact() const { return exact_; }

  [[nodiscard]] std::optional<RayParameter> least(const PlanePolygon& polygon) const {
    if (!near(polygon.corners, 4 * polygon.error)) return std::nullopt;
    const Dyadic slope = dot(planes_.exact_normal(polygon.plane), exact_);
    const Dyadic offset = planes_.exact_offset(polygon.plane);
    if (slope.sign() != 0) {
      const RayParameter t = slope.sign() > 0 ? RayParameter{offset, slope} : RayParameter{-offset, -slope};
      if (t.numerator.sign() < 0) return std::nullopt;
      for (const Side s : polygon.sides) {
        if (planes_.sign_on_ray(s, exact_, t) > 0) return std::nullopt;
      }
      return t;
    }
    if (offset.sign() != 0) return std::nullopt;
    // The ray runs in the plane: clipped by the sides.
    RayParameter from{Dyadic(0.0), Dyadic(1.0)};
    std::optional<RayParameter> to;
    for (const Side s : polygon.sides) {
      const Dyadic rise = dot(planes_.exact_normal(s), exact_);
      const Dyadic level = planes_.exact_offset(s);
      if (rise.sign() == 0) {
        if (level.sign() < 0) return std::nullopt;
      } else if (rise.sign() > 0) {
        const RayParameter t{level, rise};
        if (!to || t.compare(*to) < 0) to = t;
      } else {
        const RayParameter t{-level, -rise};
        if (t.compare(from) > 0) from = t;
      }
    }
    if (to && to->compare(from) < 0) return std::nullopt;
    return from;
  }

  /// False only when the ray misses the polygon for certain.
  /// @param error  of a coordinate of a corner
  [[nodiscard]] bool near(const std::vector<Vec3>& corners, double error) const {
    Vec3 low = corners[0], high = low;
    for (const Vec3& x : corners) {
      low = low.cwiseMin(x);
      high = high.cwiseMax(x);
    }
    const double slack = error + 0x1p-44 * std::max(low.cwiseAbs().maxCoeff(), high.cwiseAbs().maxCoeff());
    double from = 0, to = HUGE_VAL;
    for (int i = 0; i < 3; ++i) {
      const double a = low[i] - slack, b = high[i] + slack;
      if (std::abs(unit_[i]) < 0x1p-40) {
        const double drift = to < HUGE_VAL ? 0x1p-40 * to : HUGE_VAL;
        if (drift < HUGE_VAL && (a > drift || b < -drift)) return false;
        continue;
      }
      double enter = a / unit_[i], leave = b / unit_[i];
      if (enter > leave) std::swap(enter, leave);
      from = std::max(from, enter - 0x1p-44 * std::abs(enter));
      to = std::min(to, leave + 0x1p-44 * std::abs(leave));
    }
    return from <= to;
  }

 private:
  const PlaneSet& planes_;
  Dyadic3 exact_;
  Vec3 unit_;
};

}  // namespace

std::optional<UnionBoundary::Hit> UnionBoundary::along(const Vec3& direction, const Dyadic3& exact) {
  struct Waiting {
    RayParameter t;
    std::int64_t order;
    Cell cell;
  };
  const auto later = [](const Waiting& x, const Waiting& y) {
    const int sign = x.t.compare(y.t);
    return sign != 0 ? sign > 0 : x.order > y.order;
  };
  std::priority_queue<Waiting, std::vector<Waiting>, decltype(later)> queue(later);
  const RayMeeting ray(planes_, exact, direction.normalized());
  std::int64_t order = 0;
  const auto wait = [&](Cell cell) {
    if (auto t = ray.least(cell.where.polygon)) queue.push({*std::move(t), order++, std::move(cell)});
  };
  // Most facets lie aside of the ray, and need no exact polygon.
  std::vector<Vec3> corners;
  for (std::size_t k = 0; k < boxes_.size() && !differences_.limit_exceeded(); ++k) {
    const std::size_t num_facets = differences_.roughly(k).planes.size();
    for (std::size_t f = 0; f < num_facets; ++f) {
      rough_corners(k, f, corners);
      if (!ray.near(corners, 0x1p-43 * differences_.extent())) continue;
      wait({{k, f, differences_.polygon(k, f), Vec3::Zero()}, own(k)});
    }
  }
  if (differences_.limit_exceeded()) return std::nullopt;
  const auto holds = [&](std::size_t k, const RayParameter& t, const Vec3& x) {
    const double rounding = 0x1p-40 * (differences_.extent() + x.cwiseAbs().maxCoeff());
    const auto& planes = differences_.roughly(k).planes;
    for (std::size_t f = 0; f < planes.size(); ++f) {
      const double height = planes[f].normal.dot(x) - planes[f].offset;
      if (height > planes[f].slack + rounding) return false;
      if (height < -planes[f].slack - rounding) continue;
      if (planes_.sign_on_ray(differences_.side(k, f), ray.exact(), t) > 0) return false;
    }
    return !planes.empty();
  };
  while (!queue.empty()) {
    Waiting top = queue.top();
    queue.pop();
    ++counts_.polygons;
    const double t = quotient(top.t.numerator, top.t.denominator);
    const Vec3 x = t * direction;
    bool again = false;
    for (std::size_t k = 0; k < boxes_.size() && !again; ++k) {
      if (has(top.cell.clipped, k) || !holds(k, top.t, x)) continue;
      mark(top.cell.clipped, k);
      if (!subtract(top.cell.where.polygon, top.cell.where.piece, k, false)) continue;
      again = true;
      std::vector<PlanePolygon> rest = std::move(rest_);
      for (PlanePolygon& part : rest) {
        wait({{top.cell.where.piece, top.cell.where.facet, std::move(part), Vec3::Zero()}, top.cell.clipped});
      }
    }
    if (again) continue;
    top.cell.where.x = x;
    return Hit{std::move(top.cell.where), std::move(top.t)};
  }
  return std::nullopt;
}

}  // namespace pd::detail

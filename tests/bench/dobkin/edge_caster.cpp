#include "bench/dobkin/edge_caster.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace pd::bench {

EdgeCaster::EdgeCaster(const Polygon& p) : p_(p) {
  std::vector<detail::Box2> boxes;
  for (int v = 0; v < p.num_vertices(); ++v) {
    detail::Box2 box;
    box.add(p.point(v));
    box.add(p.point(p.next(v)));
    boxes.push_back(box);
  }
  tree_ = detail::BoxTree(std::move(boxes));
}

double EdgeCaster::cast(const Point2& y, const Point2& d) const {
  double best = std::numeric_limits<double>::infinity();
  const auto entry = [&](const detail::Box2& box) {
    double low = 0, high = best;
    for (std::size_t k = 0; k < 2; ++k) {
      const double a = (box.low[k] - y[k]) / d[k], b = (box.high[k] - y[k]) / d[k];
      low = std::max(low, std::min(a, b));
      high = std::min(high, std::max(a, b));
    }
    return low <= high ? low : std::numeric_limits<double>::infinity();
  };
  tree_.visit([&](const detail::Box2& box) { return std::isfinite(entry(box)); }, entry,
              [&](std::int32_t v) {
                const Point2 &a = p_.point(v), &b = p_.point(p_.next(v));
                const double ex = b[0] - a[0], ey = b[1] - a[1], ax = a[0] - y[0], ay = a[1] - y[1];
                const double w = d[0] * ey - d[1] * ex;
                const double t = (ax * ey - ay * ex) / w, s = (ax * d[1] - ay * d[0]) / w;
                if (t >= 0 && s >= 0 && s <= 1) best = std::min(best, t);
              });
  return best;
}

std::vector<Ray> rays_in(const Polygon& p, const PolygonDifference& r, int count, scenes::Random& random) {
  detail::Box2 box;
  for (const Point2& x : p.points()) box.add(x);
  std::vector<Ray> rays;
  for (int tries = 0; static_cast<int>(rays.size()) < count && tries < 100 * count; ++tries) {
    const Point2 y = {random.uniform(box.low[0], box.high[0]), random.uniform(box.low[1], box.high[1])};
    if (r.contact(y) != PlanarContact::overlapping) continue;
    const scenes::Turn t = scenes::turn(random.uniform());
    rays.push_back({y, {t.cosine, t.sine}});
  }
  return rays;
}

}  // namespace pd::bench

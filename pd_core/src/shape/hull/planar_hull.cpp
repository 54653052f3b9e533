#include "shape/hull/planar_hull.hpp"

#include <algorithm>
#include <numeric>

namespace pd::detail {

std::vector<int> planar_hull(const HullPoints& points, const AffineFrame& frame) {
  // The last axis that works: seen along z or y, lexicographic order in space is monotone in the projection.
  int axis = 2;
  while (points.orient2d(frame.points[0], frame.points[1], frame.points[2], axis) == 0) --axis;

  // Lexicographic order in space sorts the projection along z by (x, y), along y by (x, z). Along x it sorts by (y, z):
  // that axis is only reached when the plane is x = constant, since otherwise one of the other two projections is
  // proper.
  std::vector<int> order(static_cast<std::size_t>(points.size()));
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](int i, int j) { return points.less(i, j); });
  order.erase(std::unique(order.begin(), order.end(), [&](int i, int j) { return points.equal(i, j); }), order.end());

  std::vector<int> hull;
  const auto extend = [&](std::size_t base, int p) {
    while (hull.size() >= base + 2 && points.orient2d(hull[hull.size() - 2], hull.back(), p, axis) <= 0) {
      hull.pop_back();
    }
    hull.push_back(p);
  };
  for (const int p : order) extend(0, p);
  const std::size_t base = hull.size() - 1;
  for (auto p = order.rbegin() + 1; p != order.rend(); ++p) extend(base, *p);
  hull.pop_back();
  return hull;
}

}  // namespace pd::detail

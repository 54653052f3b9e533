#include "scenes/polygon_families.hpp"

#include <utility>
#include <vector>

namespace pd::scenes {

Polygon star_polygon(int n, Random& random) {
  std::vector<Point2> points;
  for (int i = 0; i < n; ++i) {
    const Turn t = turn((i + random.uniform(0, 0.3)) / n);
    const double radius = (i % 2 == 0 ? 1.0 : 0.5) * random.uniform(0.9, 1);
    points.push_back({radius * t.cosine, radius * t.sine});
  }
  return Polygon::from_rings(points).value();
}

Polygon comb_polygon(int n) {
  const int teeth = n / 4;
  std::vector<Point2> points = {{0, 0}, {2.0 * teeth - 1, 0}};
  for (int i = teeth - 1; i >= 0; --i) {
    const double x = 2.0 * i;
    points.push_back({x + 1, 11});
    points.push_back({x, 11});
    if (i == 0) break;
    points.push_back({x, 1});
    points.push_back({x - 1, 1});
  }
  return Polygon::from_rings(points).value();
}

Polygon spiral_polygon(int n) {
  constexpr int kTurn = 64;
  std::vector<Point2> outside, inside;
  for (int i = 0; i < n / 2; ++i) {
    const double turns = static_cast<double>(i) / kTurn;
    const Turn t = turn(turns);
    const double radius = 1 + 1.5 * turns;
    outside.push_back({radius * t.cosine, radius * t.sine});
    inside.push_back({(radius - 0.5) * t.cosine, (radius - 0.5) * t.sine});
  }
  outside.insert(outside.end(), inside.rbegin(), inside.rend());
  return Polygon::from_rings(outside).value();
}

Polygon plate_with_holes(int k) {
  const double side = 2.0 * k + 1;
  const std::vector<Point2> outer = {{0, 0}, {side, 0}, {side, side}, {0, side}};
  std::vector<std::vector<Point2>> holes;
  for (int i = 0; i < k; ++i) {
    for (int j = 0; j < k; ++j) {
      const double x = 2.0 * i + 1, y = 2.0 * j + 1;
      holes.push_back({{x, y}, {x, y + 1}, {x + 1, y + 1}, {x + 1, y}});
    }
  }
  return Polygon::from_rings(outer, holes).value();
}

Polygon round_polygon(int n, double radius) {
  std::vector<Point2> points;
  for (int i = 0; i < n; ++i) {
    const Turn t = turn((i + 0.25) / n);
    points.push_back({radius * t.cosine, 0.7 * radius * t.sine});
  }
  return Polygon::from_rings(points).value();
}

}  // namespace pd::scenes

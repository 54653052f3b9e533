/// @file
/// Random polygons with small whole coordinates: collinear, parallel and touching pieces come up all the time.
#pragma once

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "oracle/wanted_cases.hpp"
#include "pd/planar/polygon.hpp"
#include "planar/polygon_oracle.hpp"

namespace pd::test {

/// How many cases a test takes: PD_PLANAR_CASES asks for more (the million-case runs).
inline int planar_cases(int usual) { return wanted_cases("PD_PLANAR_CASES", usual); }

inline Polygon made(const oracle::Rings& rings) {
  return Polygon::from_rings(rings[0], std::vector<std::vector<Point2>>(rings.begin() + 1, rings.end())).value();
}

inline std::string text(const oracle::Rings& rings) {
  std::string s;
  for (const auto& ring : rings) {
    s += "[";
    for (const auto& x : ring) s += "[" + std::to_string(int(x[0])) + "," + std::to_string(int(x[1])) + "],";
    s += "] ";
  }
  return s;
}

class SmallPolygons {
 public:
  explicit SmallPolygons(unsigned seed) : bits_(static_cast<unsigned>(wanted_seed(seed))) {}
  int whole(int low, int high) { return low + static_cast<int>(bits_() % static_cast<unsigned>(high - low + 1)); }
  double eighths(int low, int high) { return whole(8 * low, 8 * high) / 8.0; }

  oracle::Rings simple(int most, int grid, bool holes) {
    for (;;) {
      oracle::Rings rings = {ring(whole(3, most), grid)};
      if (!Polygon::from_rings(rings[0])) continue;
      for (int tries = 0; holes && tries < 20; ++tries) {
        oracle::Rings with = rings;
        with.push_back(ring(whole(3, 4), grid));
        if (Polygon::from_rings(with[0], std::vector<std::vector<Point2>>(with.begin() + 1, with.end()))) rings = with;
      }
      return rings;
    }
  }
  /// A polygon with holes that touch the outer ring or each other.
  oracle::Rings touching(int grid) {
    for (;;) {
      const double side = grid;
      oracle::Rings rings = {{{0, 0}, {side, 0}, {side, side}, {0, side}}};
      if (whole(0, 1) == 0) rings = simple(7, grid, false);
      for (int tries = 0; tries < 20; ++tries) {
        oracle::Rings with = rings;
        with.push_back(hole_at(rings, grid));
        if (Polygon::from_rings(with[0], std::vector<std::vector<Point2>>(with.begin() + 1, with.end()))) rings = with;
      }
      const Polygon polygon = made(rings);
      for (int v = 0; v < polygon.num_vertices(); ++v) {
        if (polygon.next_here(v) != v) return rings;
      }
    }
  }
  /// A triangle or a quadrangle, some of whose corners are vertices of the rings or middles of their edges.
  std::vector<oracle::Vec> hole_at(const oracle::Rings& rings, int grid) {
    std::vector<oracle::Vec> points = ring(whole(3, 4), grid);
    const bool small = whole(0, 1) == 0;
    const int column = whole(0, grid), row = whole(0, grid);
    for (oracle::Vec& x : points) {
      if (small) x = {double(column + whole(-1, 1)), double(row + whole(-1, 1))};
      const auto& other = rings[static_cast<std::size_t>(whole(0, static_cast<int>(rings.size()) - 1))];
      const auto k = static_cast<std::size_t>(whole(0, static_cast<int>(other.size()) - 1));
      const oracle::Vec &a = other[k], &b = other[(k + 1) % other.size()];
      const int way = whole(0, 3);
      if (way == 0) x = a;
      if (way == 1) x = {std::floor((a[0] + b[0]) / 2), std::floor((a[1] + b[1]) / 2)};
    }
    return points;
  }
  oracle::Rings convex(int most, int grid) {
    for (;;) {
      oracle::Rings rings = {ring(whole(3, most), grid)};
      const auto polygon = Polygon::from_rings(rings[0]);
      if (polygon && polygon->convex()) return rings;
    }
  }

 private:
  std::vector<oracle::Vec> ring(int size, int grid) {
    std::vector<oracle::Vec> points;
    for (int i = 0; i < size; ++i) points.push_back({double(whole(0, grid)), double(whole(0, grid))});
    return points;
  }
  std::mt19937 bits_;
};

}  // namespace pd::test

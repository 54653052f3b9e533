/// @file
/// Random polygons with small whole coordinates: collinear, parallel and touching pieces come up all the time.
#pragma once

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

/// @file
/// A closed triangulated surface as plain data: what is checked (surface_check.hpp) and what observers are shown
/// (search_report.hpp).
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "pd/numeric/vector.hpp"

namespace pd::detail {

struct SurfaceSnapshot {
  struct Face {
    std::int32_t v[3];    ///< counter-clockwise from outside
    std::int32_t adj[3];  ///< across the edge v[i] -> v[i + 1]: 4 * face + its edge
    Vec3 normal;          ///< outward, any length
    double distance;      ///< signed, of the plane from the origin: a lower bound up to rounding
  };
  std::vector<Vec3> points;
  std::vector<Face> faces;
  int nearest = -1;                   ///< the face with the least distance
  std::vector<std::int32_t> numbers;  ///< buffer of those who fill it

  /// Room for a surface of so many faces.
  void reserve(std::size_t count) {
    points.reserve(count);
    faces.reserve(count);
    numbers.reserve(count);
  }

  void clear() {
    points.clear();
    faces.clear();
    nearest = -1;
  }
};

}  // namespace pd::detail

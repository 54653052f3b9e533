/// @file
/// Directional depth of many placements for a fixed set of directions, in logarithmic time each.
///
/// For every direction d the forbidden placements R = P + (-Q) are cut into trapezoids by lines along d, in which a
/// placement is located. The ray from it along d meets the side ahead. Conventions as in polygon_depth.hpp.
/// [D] Dobkin, Hershberger, Kirkpatrick, Suri, "Computing the intersection-depth of polyhedra", 1993, section 6.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "pd/planar/polygon_depth.hpp"

namespace pd {

class DirectionSet {
 public:
  /// @param directions  of any length; vectors of the plane, in P's frame.
  /// @return ErrorCode::non_finite, out_of_range (above 1e300) or zero_direction for a direction, `where`
  ///         "directions[k]".
  /// For each direction time O(s log s), space O(s log s), s the stretches of the boundary (statistics()).
  static Expected<DirectionSet> of(const PolygonDifference& difference, std::span<const Point2> directions);

  [[nodiscard]] int num_directions() const;
  [[nodiscard]] const Point2& direction(int k) const;

  /// sigma_d for direction k: the answer of PolygonDifference::depth_along, with the same exact class, bracket and
  /// translation (of several features that meet in the answer, another one may be named). Requires a finite placement
  /// and 0 <= k < num_directions(). Time O(log s + log m): `probes` counts the signs taken, the final rounding aside.
  [[nodiscard]] PolygonDepth depth(const Point2& placement, int k, std::int64_t* probes = nullptr) const;

  struct Statistics {
    std::int64_t pieces;  ///< of the boundary that go one way across a direction, over all directions
    std::int64_t events;  ///< lines along a direction through ends of them, over all directions
    std::int64_t memory_bytes;
  };
  [[nodiscard]] Statistics statistics() const;

 private:
  struct State;
  std::shared_ptr<const State> state_;
};

}  // namespace pd

/// @file
/// A ray cast on a polygon's own edges, beside which the directional queries of [D] are measured, and such rays.
#pragma once

#include <vector>

#include "pd/planar/polygon_depth.hpp"
#include "planar/boundary/box_tree.hpp"
#include "scenes/shape_families.hpp"

namespace pd::bench {

/// First hit of a ray with P's edges down a tree of boxes, all in doubles: what a robot planner has at hand.
class EdgeCaster {
 public:
  explicit EdgeCaster(const Polygon& p);
  [[nodiscard]] double cast(const Point2& y, const Point2& d) const;

 private:
  const Polygon& p_;
  detail::BoxTree tree_;
};

struct Ray {
  Point2 from, direction;
};

/// Rays from inside R, in random directions.
[[nodiscard]] std::vector<Ray> rays_in(const Polygon& p, const PolygonDifference& r, int count, scenes::Random& random);

}  // namespace pd::bench
